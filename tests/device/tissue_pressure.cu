// The tissue's own pressure in the resident form: a squeezed block grips a thread on the GPU as on the host,
// with the same bits for any number of threads of a block.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <span>
#include <vector>

#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/coupling/tissue_pressure.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>

#include "on_device.cuh"

namespace {

using namespace mpmpbd;

struct Tissue : Mpm<NeoHookean> {};
struct Thread : Pbd<Constraints<Distance>> {};
struct Squeezed : Scene<Tissue, Thread, Coupling<Embedded, Friction, TissuePressure>> {};

constexpr int beads = 14, substeps = 6;
constexpr float dt = 5e-5f;
constexpr double dx = 2e-3;

test::OnDevice<Squeezed>::Run make_run(double stretch) {
  SimulationOptions o;
  o.cell_size = dx;
  o.nodes[0] = 20;
  o.nodes[1] = o.nodes[2] = 14;
  o.capacity = {
      {"particle", 5000}, {"bead", beads}, {"Distance", beads - 1}, {"contact point", beads}};
  o.substeps = substeps;
  test::OnDevice<Squeezed>::Run run(o);
  std::vector<Vec3<double>> x, line;
  for (int k = 0; k < 14; ++k)
    for (int j = 0; j < 14; ++j)
      for (int i = 0; i < 24; ++i)
        x.push_back(dx * (vec(3.2, 3.2, 3.2) + 0.5 * vec(double(i), double(j), double(k))));
  for (int k = 0; k < beads; ++k) line.push_back(dx * vec(2.6 + 0.95 * k, 6.6 + 0.02 * k, 6.8));
  run.set<NeoHookean>(lame(2e4, 0.4));
  run.set<Embedded>({2e-4});
  run.set<Friction>({0.3, 50.0});
  run.add_particles(0, x, 1050.0, dx * dx * dx / 8);
  Mat3<float> F = Mat3<float>::identity();
  F(1, 1) = F(2, 2) = float(stretch);
  for (std::int64_t p = 0; p < run.state().table<Particles>().live(0); ++p)
    run.state().set<particle::Deformation>(0, p, F);
  RodAssembly<Thread> rod;
  add_thread(rod, std::span<Vec3<double> const>(line), RodMaterial{1e8, 2e-4, 8800.0});
  rod.write(run.state(), 0);
  run.state().table<ContactPoints>().set_live(0, beads);
  for (int k = 0; k < beads; ++k) run.state().set<bead::Velocity>(0, k, {{0.3f, 0, 0}});
  return run;
}

}  // namespace

int main() {
  int passed = 0, failed = 0;
  auto check = [&](bool ok, char const* what, double value) {
    std::printf("%s: %s (%.3g)\n", ok ? "pass" : "FAIL", what, value);
    (ok ? passed : failed) += 1;
  };
  auto serial = make_run(0.975), loose = make_run(1.0);
  test::OnDevice<Squeezed> device(serial, dt, substeps), narrow(serial, dt, substeps);
  device.step<512>();
  narrow.step<128>();
  serial.step(double(dt) * substeps);
  loose.step(double(dt) * substeps);

  auto const v = device.read<bead::Velocity>(), thin = narrow.read<bead::Velocity>();
  double worst = 0, slowed = 0;
  for (int k = 0; k < beads; ++k) {
    float const here = serial.state().get<bead::Velocity>(0, k)[0];
    worst = std::fmax(worst, std::fabs(double(v[std::size_t(k)] - here)));
    slowed = std::fmax(slowed, double(loose.state().get<bead::Velocity>(0, k)[0] - here));
  }
  check(slowed > 0.03 && slowed < 0.25, "the squeeze slows the sliding thread on the host [m/s]",
        slowed);
  check(worst < 0.02 * slowed, "and on the device as much [m/s]", worst);
  check(std::memcmp(v.data(), thin.data(), v.size() * sizeof(float)) == 0,
        "512 and 128 threads give the same bits", 0);
  std::printf("%d passed, %d failed\n", passed, failed);
  return failed == 0 ? 0 : 1;
}
