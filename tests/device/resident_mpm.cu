// Tissue alone in the resident form: a block of the GPU gives what the serial back end gives, and the
// same bits for any number of environments and threads of a block.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include <mpmpbd/mpm/materials/neo_hookean.hpp>

#include "on_device.cuh"

namespace {

using namespace mpmpbd;

struct Tissue : Mpm<NeoHookean> {};
struct Block : Scene<Tissue> {};
using Run = Simulation<Block, Serial, float>;

constexpr int substeps = 4;
constexpr float dt = 1e-3f;

std::vector<Vec3<double>> lattice_points() {
  std::vector<Vec3<double>> x;
  for (int k = 0; k < 22; ++k)
    for (int j = 0; j < 21; ++j)
      for (int i = 0; i < 43; ++i)
        x.push_back({{0.3 + 2.0 * (i + 0.5) / 43, 0.3 + (j + 0.5) / 21, 0.3 + (k + 0.5) / 22}});
  return x;
}

Run make_run(int environments, int capacity) {
  SimulationOptions options;
  options.environments = environments;
  options.cell_size = 0.1;
  options.nodes[0] = 26;
  options.nodes[1] = options.nodes[2] = 16;
  options.capacity = {{"particle", capacity}};
  options.substeps = substeps;
  Run run(options);
  run.set<NeoHookean>(lame(5e5, 0.4));
  auto const x = lattice_points();
  for (int e = 0; e < environments; ++e) {
    run.add_particles(e, x, 1000.0, 2.0 / double(x.size()));
    for (std::int64_t p = 0; p < run.state().table<Particles>().live(e); ++p) {
      auto const at = run.state().get<particle::Position>(e, p);
      float const a = 0.4f + 0.1f * float(e % 3);
      run.state().set<particle::Velocity>(e, p,
                                          {{a * sinf(3 * at[1]), -a * at[0], a * cosf(2 * at[2])}});
    }
  }
  return run;
}

double time_per_particle_substep(int environments, int count) {
  Run run = make_run(1, 19866);
  SimulationOptions options = run.options();
  options.environments = environments;
  Run many(options);
  for (int e = 0; e < environments; ++e) many.state().copy_environment(e, run.state(), 0);
  test::OnDevice<Block> device(many, dt, count);
  return 1e6 * device.time<512>(15) / count / environments / 19866.0;
}

}  // namespace

int main() {
  int passed = 0, failed = 0;
  auto check = [&](bool ok, char const* what, double value) {
    std::printf("%s: %s (%.3g)\n", ok ? "pass" : "FAIL", what, value);
    ok ? ++passed : ++failed;
  };

  Run serial = make_run(3, 20000);
  test::OnDevice<Block> device(serial, dt, substeps), narrow(serial, dt, substeps);
  device.step<512>();
  narrow.step<256>();
  serial.step(double(dt) * substeps);

  auto const x = device.read<particle::Position>(), v = device.read<particle::Velocity>();
  auto const& xs = serial.state().table<Particles>().planes<particle::Position>();
  auto const& vs = serial.state().table<Particles>().planes<particle::Velocity>();
  double worst_x = 0, worst_v = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    worst_x = std::max(worst_x, std::abs(double(x[i]) - xs[i]));
    worst_v = std::max(worst_v, std::abs(double(v[i]) - vs[i]));
  }
  // Fixed point at 2^-22 of a cell per substep at each of 27 nodes, some rounding of float beside it.
  check(worst_x < 4e-6, "positions equal the serial back end's [m]", worst_x);
  check(worst_v < 1e-3, "velocities equal the serial back end's [m/s]", worst_v);
  check(std::memcmp(x.data(), narrow.read<particle::Position>().data(), x.size() * sizeof(float)) ==
            0,
        "512 and 256 threads give the same bits", 0);

  Run alone = make_run(1, 20000);
  test::OnDevice<Block> single(alone, dt, substeps);
  single.step<512>();
  auto const x1 = single.read<particle::Position>();
  bool same = true;
  for (int c = 0; c < 3; ++c)
    same = same && std::memcmp(&x1[std::size_t(c) * 20000], &x[std::size_t(c) * 60000],
                               19866 * sizeof(float)) == 0;
  check(same, "an environment alone equals slot 0 of three, bit for bit", 0);

  for (int environments : {1, 132, 1056})
    std::printf("%d environments of 19866 particles, %d substeps: %.4f ns per particle-substep\n",
                environments, substeps, time_per_particle_substep(environments, substeps));
  std::printf("%d passed, %d failed\n", passed, failed);
  return failed == 0 ? 0 : 1;
}
