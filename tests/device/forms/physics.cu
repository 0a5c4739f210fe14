// Physics with exact answers on a GPU: a disc that spins in free flight, a thread drawn round half a turn, a needle pushed into
// gel and drawn out. They keep what tests/physics asks of the host, and give what the host gives in float.
#include <cmath>
#include <cstdio>

#include <mpmpbd/backend/cuda/simulation.cuh>
#include <mpmpbd/backend/serial.hpp>

#include "cuda/fixed_point_noise.hpp"
#include "device/report.hpp"
#include "physics/pushed_needle.hpp"
#include "physics/spinning_disc.hpp"
#include "physics/wound_thread.hpp"

namespace {

using namespace test;

void within(char const* what, double got, double wanted, double allowed) {
  bool const ok = std::abs(got - wanted) <= allowed;
  std::printf("%s: %s: %.7g, wanted %.7g +- %.2g\n", word(ok), what, got, wanted, allowed);
  report.count(ok);
}

// Part of a revolution, within the noise of fixed point.
template <class Gradient> void disc(char const* name, double revolutions = 0.1) {
  using Body = Mpm<FixedCorotated, Apic, Gradient>;
  using Host = Disc<Body, 8, Serial, float>;
  std::printf("%s\n", name);
  Host const still;
  auto const host = spin(Host(), revolutions);
  auto const device = spin(Disc<Body, 8, Cuda, float>(), revolutions);
  double const noise = fixed_point_noise_of_mean(Host::dx, Host::dt(), revolutions / Host::dt(),
                                                 double(still.particles())) /
                       Host::speed_of_gyration();
  within("spin that is left", device.spin, 1.0, noise);
  within("spin, against the host's", device.spin, host.spin, noise);
  within("kinetic energy, against the host's", device.kinetic, host.kinetic, 2 * noise);
  within("status", device.status, host.status, 0.0);
}

void capstan() {
  constexpr double friction = 0.2;
  std::printf("a thread drawn round half a turn\n");
  auto const host = draw_round<float>(half_turn(friction), 0.02, Serial{});
  // Alone it would be tiled, as the needle is.
  Cuda const resident{.execution = Cuda::Execution::resident};
  auto const device = draw_round<float>(half_turn(friction), 0.02, resident);
  double const exact = std::exp(friction * device.track);
  within("ratio of the tensions", device.ratio, exact, 0.02 * exact);
  within("ratio, against the host's", device.ratio, host.ratio, 2e-3 * exact);
  within("angle of the thread", device.angle, host.angle, 2e-3 * host.angle);
  within("status", device.status, host.status, 0.0);
}

// In, and out again; `deepest` [cells].
template <class Backend> Stroke<Backend, float> stroke(double deepest) {
  Stroke<Backend, float> s({.deepest = deepest});
  s.move_to(s.way.deepest, 1, s.in);
  s.move_to(-s.clear, -1, s.out);
  return s;
}
void pushed_needle() {
  std::printf("a needle pushed into gel and drawn out\n");
  auto const host = stroke<Serial>(5);
  auto const device = stroke<Cuda>(5);
  double const slope = device.slope(), work = device.cycle();
  within("work of the cycle", device.work / work, 1.0, 0.03);
  within("force inwards, against the host's", device.in.slope() / slope, host.in.slope() / slope,
         1e-3);
  within("force outwards, against the host's", device.out.slope() / slope, host.out.slope() / slope,
         1e-3);
  within("work, against the host's", device.work / work, host.work / work, 1e-3);
  within("depth of the first touch", device.touched, host.touched, 1e-9);
  within("status", device.run.status(0), host.run.status(0), 0.0);
}

// The discs and the needle, too briefly to show a law.
void brief() {
  disc<Mls>("a disc in free flight, MLS", 0.04);
  disc<WeightGradient>("a disc in free flight, weight gradients", 0.04);
  auto const host = stroke<Serial>(1);
  auto const device = stroke<Cuda>(1);
  within("a needle that pricks gel: work, against the host's", device.work / host.work, 1.0, 1e-3);
  within("depth of the first touch", device.touched, host.touched, 1e-9);
  within("status", device.run.status(0), host.run.status(0), 0.0);
}

}  // namespace

// With any argument it is brief: for compute-sanitizer.
int main(int argc, char**) {
  if (argc > 1) {
    brief();
    return report.end();
  }
  disc<Mls>("a disc in free flight, MLS");
  disc<WeightGradient>("a disc in free flight, weight gradients");
  capstan();
  pushed_needle();
  return report.end();
}
