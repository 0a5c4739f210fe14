// The skeleton: tissue, coupling and a thread from the library's own headers in the fused, resident form.
//
// One block per environment runs all substeps of a step in one launch: scatter, (n - 1) x fused gather and
// scatter, gather; the exchange with the thread stands between two barriers. The stages are the very types
// that the serial back end runs, and this program compares the two. Figures: docs/results/skeleton.md.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <span>
#include <vector>

#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>

#include "on_device.cuh"

namespace {

using namespace mpmpbd;

struct Tissue : Mpm<NeoHookean> {};
struct Thread : Pbd<Constraints<Distance, Bend>> {};
using Floor = Wall<Sticky, 2, Side::low>;
struct Skeleton : Scene<Tissue, Thread, Coupling<Embedded, Friction>, Gravity, Floor> {};
struct TissueAlone : Scene<Tissue, Gravity, Floor> {};

constexpr int beads = 20;
constexpr int substeps = 4;
constexpr float dt = 1e-3f;

SimulationOptions options(std::int64_t environments) {
  SimulationOptions o;
  o.environments = environments;
  o.cell_size = 0.1;
  o.nodes[0] = 26;
  o.nodes[1] = o.nodes[2] = 16;
  o.capacity = {{"particle", 20000},
                {"bead", beads},
                {"Distance", beads - 1},
                {"Bend", beads - 2},
                {"contact point", beads}};
  o.substeps = substeps;
  return o;
}

template <class Run> void add_tissue(Run& run, std::int64_t env) {
  std::vector<Vec3<double>> x;
  for (int k = 0; k < 22; ++k)
    for (int j = 0; j < 21; ++j)
      for (int i = 0; i < 43; ++i)
        x.push_back({{0.3 + 2.0 * (i + 0.5) / 43, 0.3 + (j + 0.5) / 21, 0.3 + (k + 0.5) / 22}});
  run.template set<NeoHookean>(env, lame(5e5, 0.4));
  run.template set<Gravity>(env, {{0.0, 0.0, -9.81}});
  run.template set<Floor>(env, {0.3});
  run.add_particles(env, std::span<Vec3<double> const>(x), 1000.0, 2.0 / double(x.size()));
}

// A thread drawn through the block in a shallow arc; its free ends stand out at both sides.
template <class Run> void add_thread_through(Run& run, std::int64_t env) {
  std::vector<Vec3<double>> line;
  for (int k = 0; k < beads; ++k) {
    double const s = double(k) / (beads - 1) - 0.5;
    line.push_back({{1.31 + 1.6 * s, 0.82 + 0.07 * s, 1.22 - 0.32 * std::cos(2.4 * s)}});
  }
  RodAssembly<Thread> rod;
  add_thread(rod, std::span<Vec3<double> const>(line), RodMaterial{2e6, 0.006, 1140.0},
             RestShape::as_placed);
  rod.write(run.state(), env);
  run.state().template table<ContactPoints>().set_live(env, beads);
  run.template set<Embedded>(env, {0.006});
  run.template set<Friction>(env, {0.2, 100.0});
  for (int k = 0; k < beads; ++k)  // pulled along itself, and sideways
    run.state().template set<bead::Velocity>(env, k,
                                             {{0.6f, 0.1f * float(env % 3), 0.05f * float(k % 4)}});
}

test::OnDevice<Skeleton>::Run make_run(std::int64_t environments) {
  test::OnDevice<Skeleton>::Run run(options(environments));
  for (std::int64_t e = 0; e < environments; ++e) {
    add_tissue(run, e);
    add_thread_through(run, e);
  }
  return run;
}

// Largest difference of a field from the serial run's [unit of the field].
template <class F, class Run> double difference(test::OnDevice<Skeleton> const& device, Run& run) {
  auto const on_device = device.read<F>();
  auto const& on_host = run.state().template table<typename F::Domain>().template planes<F>();
  double worst = 0;
  for (std::size_t i = 0; i < on_device.size(); ++i)
    worst = std::fmax(worst, std::fabs(double(on_device[i]) - double(on_host[i])));
  return worst;
}

template <class S, class Fill>
double ns_per_particle_substep(std::int64_t environments, Fill const& fill) {
  typename test::OnDevice<S>::Run one(options(1)), many(options(environments));
  fill(one);
  for (std::int64_t e = 0; e < environments; ++e) many.state().copy_environment(e, one.state(), 0);
  test::OnDevice<S> device(many, dt, substeps);
  return 1e6 * device.template time<512>(15) / substeps / double(environments) / 19866.0;
}

}  // namespace

int main() {
  int passed = 0, failed = 0;
  auto check = [&](bool ok, char const* what, double value) {
    std::printf("%s: %s (%.3g)\n", ok ? "pass" : "FAIL", what, value);
    (ok ? passed : failed) += 1;
  };
  auto serial = make_run(3);
  test::OnDevice<Skeleton> device(serial, dt, substeps), narrow(serial, dt, substeps);
  device.step<512>();
  narrow.step<256>();
  serial.step(double(dt) * substeps);

  double const x = difference<particle::Position>(device, serial),
               v = difference<particle::Velocity>(device, serial);
  double const bead_x = difference<bead::Position>(device, serial),
               bead_v = difference<bead::Velocity>(device, serial);
  // Node sums are fixed point (2^-22 cells per substep) and the order of float sums differs.
  check(x < 1e-5, "tissue positions equal the serial back end's [m]", x);
  check(v < 3e-3, "tissue velocities equal the serial back end's [m/s]", v);
  check(bead_x < 1e-5, "thread positions equal the serial back end's [m]", bead_x);
  check(bead_v < 1e-2, "thread velocities equal the serial back end's [m/s]", bead_v);
  check(serial.state().get<contact::Impulse>(0, 20)[0] != 0.0f,
        "the thread in tissue exchanges impulses [N s]",
        serial.state().get<contact::Impulse>(0, 20)[0]);
  unsigned met = 0;
  for (unsigned f : device.faults()) met |= f;
  check(met == serial.status(0), "the status is the serial back end's", met);
  auto const wide = device.read<bead::Position>(), thin = narrow.read<bead::Position>();
  check(std::memcmp(wide.data(), thin.data(), wide.size() * sizeof(float)) == 0,
        "512 and 256 threads give the same bits", 0);

  auto alone = make_run(1);
  test::OnDevice<Skeleton> single(alone, dt, substeps);
  single.step<512>();
  auto const first = single.read<particle::Position>(), all = device.read<particle::Position>();
  check(std::memcmp(first.data(), all.data(), 19866 * sizeof(float)) == 0,
        "an environment alone equals slot 0 of three, bit for bit", 0);

  auto const coupled = [](auto& run) { add_tissue(run, 0), add_thread_through(run, 0); };
  auto const uncoupled = [](auto& run) { add_tissue(run, 0); };
  for (int environments : {1, 132, 1056})
    std::printf(
        "%d environments of 19866 particles, %d beads, %d substeps: %.4f ns per particle-substep; tissue alone %.4f\n",
        environments, beads, substeps, ns_per_particle_substep<Skeleton>(environments, coupled),
        ns_per_particle_substep<TissueAlone>(environments, uncoupled));
  std::printf("%d passed, %d failed\n", passed, failed);
  return failed == 0 ? 0 : 1;
}
