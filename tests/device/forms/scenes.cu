// Scenes that name what the ready-made ones do not, on a GPU: cubic splines, TPIC and weight gradients; PIC; FLIP; Prony; tissue
// that squeezes a thread; GridProjection. They give what the serial back end gives, and resident and tiled the same bits.
//
// tests/cuda has the same on an emulated device, and more of it; what nvcc makes of these policies is seen here alone.
#include <cmath>
#include <cstdio>

#include <mpmpbd/mpm/transfer/pic.hpp>

#include "cuda/scenes.hpp"
#include "device/report.hpp"

namespace {

using namespace test;

struct Damped : Scene<Mpm<NeoHookean, Pic>, Gravity, Floor> {};

// Fixed point, and eight roundings of a velocity of up to 1 m/s and of a position of up to 1 m per substep for other
// arithmetic.
template <class Scene> void compare(char const* name, double loudness = 1.0) {
  constexpr int steps = 3;
  auto host = made<Simulation<Scene, Serial, float>>(3);
  auto device = made<Simulation<Scene, Cuda, float>>(3);
  auto tiled = made<Simulation<Scene, Cuda, float>>(
      3, Cuda{.threads = 128, .execution = Cuda::Execution::tiled});
  for (int s = 0; s < steps; ++s) host.step(step), device.step(step), tiled.step(step);
  double const rounded = 8 * steps * substeps * 0x1p-24;
  double const v = loudness * (rounding<Scene>(steps) + rounded);
  auto const &d = read(device), &h = host.state();
  auto const within = [&](char const* what, double got, double allowed) {
    check(got < allowed, name, what, got / allowed);
  };
  within("velocities are the host's, of what is allowed", difference<particle::Velocity>(d, h), v);
  within("positions", difference<particle::Position>(d, h), v * steps * step + rounded);
  if constexpr (Scene::has_rods)
    within("velocities of the thread", difference<bead::Velocity>(d, h), v);
  bool same = true;
  for (std::int64_t env : {0, 1, 2}) {
    same = same && same_bits(d, env, read(tiled), env);
    check(device.status(env) == host.status(env), name, "the status is the host's",
          device.status(env));
  }
  check(same, name, "tiled execution with 128 threads gives the same bits");
}

}  // namespace

int main() {
  compare<Alone>("cubic splines, TPIC, weight gradients");
  compare<Damped>("PIC");
  compare<Splashing>("FLIP", std::sqrt(2.0));  // two grids' roundings
  compare<Relaxing>("Prony");
  compare<Squeezed>("tissue that squeezes a thread");
  compare<Projected>("GridProjection");
  return report.end();
}
