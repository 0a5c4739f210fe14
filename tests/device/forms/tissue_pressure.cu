// The tissue's own pressure in the resident form: a squeezed block grips a thread on the GPU as on the host,
// with the same bits for any number of threads of a block.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <span>
#include <vector>

#include <mpmpbd/backend/cuda/simulation.cuh>
#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/coupling/tissue_pressure.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include "device/report.hpp"

namespace {

using namespace mpmpbd;
using test::check;

struct Tissue : Mpm<NeoHookean> {};
struct Thread : Pbd<Constraints<Distance>> {};
struct Squeezed : Scene<Tissue, Thread, Coupling<Embedded, Friction, TissuePressure>> {};

constexpr int beads = 14, substeps = 6;
constexpr double step = substeps * 5e-5;
constexpr double dx = 2e-3;

template <class Backend> auto make_run(double stretch, Backend where = {}) {
  SimulationOptions o;
  o.cell_size = dx;
  o.nodes[0] = 20;
  o.nodes[1] = o.nodes[2] = 14;
  o.capacity = {
      {"particle", 5000}, {"bead", beads}, {"Distance", beads - 1}, {"contact point", beads}};
  o.substeps = substeps;
  Simulation<Squeezed, Backend, float> run(o, where);
  std::vector<Vec3<double>> x, line;
  for (int k = 0; k < 14; ++k)
    for (int j = 0; j < 14; ++j)
      for (int i = 0; i < 24; ++i)
        x.push_back(dx * (vec(3.2, 3.2, 3.2) + 0.5 * vec(double(i), double(j), double(k))));
  for (int k = 0; k < beads; ++k) line.push_back(dx * vec(2.6 + 0.95 * k, 6.6 + 0.02 * k, 6.8));
  run.template set<NeoHookean>(lame(2e4, 0.4));
  run.template set<Embedded>({2e-4});
  run.template set<Friction>({0.3, 50.0});
  run.add_particles(0, std::span<Vec3<double> const>(x.data(), x.size()), 1050.0, dx * dx * dx / 8);
  Mat3<float> F = Mat3<float>::identity();
  F(1, 1) = F(2, 2) = float(stretch);
  for (std::int64_t p = 0; p < run.state().template table<Particles>().live(0); ++p)
    run.state().template set<particle::Deformation>(0, p, F);
  RodAssembly<Thread> rod;
  add_thread(rod, std::span<Vec3<double> const>(line.data(), line.size()),
             RodMaterial{1e8, 2e-4, 8800.0});
  rod.write(run.state(), 0);
  run.state().template table<ContactPoints>().set_live(0, beads);
  for (int k = 0; k < beads; ++k) run.state().template set<bead::Velocity>(0, k, {{0.3f, 0, 0}});
  return run;
}

}  // namespace

int main() {
  auto serial = make_run<Serial>(0.975), loose = make_run<Serial>(1.0);
  constexpr auto resident = Cuda::Execution::resident;
  auto device = make_run<Cuda>(0.975, Cuda{.execution = resident}),
       narrow = make_run<Cuda>(0.975, Cuda{.threads = 128, .execution = resident});
  serial.step(step), loose.step(step), device.step(step), narrow.step(step);

  double worst = 0, slowed = 0;
  bool same = true;
  for (int k = 0; k < beads; ++k) {
    auto const velocity = [k](auto const& run) {
      return run.state().template get<bead::Velocity>(0, k);
    };
    auto const v = velocity(device), thin = velocity(narrow), here = velocity(serial);
    worst = std::fmax(worst, std::fabs(double(v[0] - here[0])));
    slowed = std::fmax(slowed, double(velocity(loose)[0] - here[0]));
    same = same && std::memcmp(&v, &thin, sizeof v) == 0;
  }
  check(slowed > 0.03 && slowed < 0.25, "the squeeze slows the sliding thread on the host [m/s]",
        slowed);
  check(worst < 0.02 * slowed, "and on the device as much [m/s]", worst);
  check(same, "512 and 128 threads give the same bits");
  return test::report.end();
}
