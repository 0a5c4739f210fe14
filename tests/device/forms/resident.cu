// Both forms of execution on a GPU: tissue alone, and tissue with a thread drawn through it, give what the serial back end
// gives, and the same bits for any number of environments and threads of a block, resident or tiled. In double, too, tiled.
//
// tests/cuda has the same on an emulated device, and more of it.
#include <cmath>
#include <span>
#include <vector>

#include <mpmpbd/backend/cuda/simulation.cuh>
#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include "cuda/compare.hpp"
#include "cuda/fixed_point_noise.hpp"
#include "device/report.hpp"

namespace {

using namespace mpmpbd;
using test::check;
using test::difference;
using test::read;
using test::same_bits;

struct Tissue : Mpm<NeoHookean> {};
struct Thread : Pbd<Constraints<Distance, Bend>> {};
using Floor = Wall<Sticky, 2, Side::low>;
struct Threaded : Scene<Tissue, Thread, Coupling<Embedded, Friction>, Gravity, Floor> {};
struct TissueAlone : Scene<Tissue, Gravity, Floor> {};

constexpr int beads = 20, substeps = 4, particles = 43 * 21 * 22;
constexpr double dx = 0.1, step = 0.004;

template <class Scene> SimulationOptions options(std::int64_t environments) {
  SimulationOptions o;
  o.environments = environments;
  o.cell_size = dx;
  o.nodes[0] = 26;
  o.nodes[1] = o.nodes[2] = 16;
  o.capacity = {{"particle", particles}};
  if constexpr (Scene::has_rods)
    for (Capacity const& more : {Capacity{"bead", beads}, Capacity{"Distance", beads - 1},
                                 Capacity{"Bend", beads - 2}, Capacity{"contact point", beads}})
      o.capacity.push_back(more);
  o.substeps = substeps;
  return o;
}

template <class Run> void add_tissue(Run& run, std::int64_t env) {
  using S = typename Run::Scalar;
  std::vector<Vec3<double>> x;
  for (int k = 0; k < 22; ++k)
    for (int j = 0; j < 21; ++j)
      for (int i = 0; i < 43; ++i)
        x.push_back({{0.3 + 2.0 * (i + 0.5) / 43, 0.3 + (j + 0.5) / 21, 0.3 + (k + 0.5) / 22}});
  run.template set<NeoHookean>(env, lame(5e5, 0.4));
  run.template set<Gravity>(env, {{0.0, 0.0, -9.81}});
  run.template set<Floor>(env, {0.3});
  run.add_particles(env, std::span<Vec3<double> const>(x.data(), x.size()), 1000.0,
                    2.0 / particles);
  for (int p = 0; p < particles; ++p)
    run.state().template set<particle::Velocity>(
        env, p, {{S(0.1 * double(env % 3) * std::sin(3.0 * x[std::size_t(p)][1])), S(0), S(0)}});
}

// A thread drawn through the block in a shallow arc; its free ends stand out at both sides.
template <class Run> void add_thread_through(Run& run, std::int64_t env) {
  using S = typename Run::Scalar;
  std::vector<Vec3<double>> line;
  for (int k = 0; k < beads; ++k) {
    double const s = double(k) / (beads - 1) - 0.5;
    line.push_back({{1.31 + 1.6 * s, 0.82 + 0.07 * s, 1.22 - 0.32 * std::cos(2.4 * s)}});
  }
  RodAssembly<Thread> rod;
  add_thread(rod, std::span<Vec3<double> const>(line.data(), line.size()),
             RodMaterial{2e6, 0.006, 1140.0}, RestShape::as_placed);
  rod.write(run.state(), env);
  run.state().template table<ContactPoints>().set_live(env, beads);
  run.template set<Embedded>(env, {0.006});
  run.template set<Friction>(env, {0.2, 100.0});
  for (int k = 0; k < beads; ++k)  // pulled along itself, and sideways
    run.state().template set<bead::Velocity>(env, k,
                                             {{S(0.6), S(0.1) * S(env % 3), S(0.05) * S(k % 4)}});
}

template <class Scene, class Backend, class S = float>
auto make_run(std::int64_t environments, Backend where = {}) {
  Simulation<Scene, Backend, S> run(options<Scene>(environments), where);
  for (std::int64_t e = 0; e < environments; ++e) {
    add_tissue(run, e);
    if constexpr (Scene::has_rods) add_thread_through(run, e);
  }
  return run;
}

constexpr Cuda resident{.execution = Cuda::Execution::resident};

template <class Scene> void compare(char const* name) {
  auto serial = make_run<Scene, Serial>(3);
  auto device = make_run<Scene, Cuda>(3, resident);
  auto narrow = make_run<Scene, Cuda>(3, Cuda{.threads = 256, .execution = resident.execution});
  auto alone = make_run<Scene, Cuda>(1, resident);
  auto tiled = make_run<Scene, Cuda>(3, Cuda{.execution = Cuda::Execution::tiled});
  serial.step(step), device.step(step), narrow.step(step), alone.step(step), tiled.step(step);
  auto const &d = read(device), &s = read(serial);
  double const v = test::fixed_point_noise(dx, step / substeps, substeps);  // [m/s]
  auto within = [&](char const* what, double got, double allowed) {
    check(got < allowed, name, what, got);
  };
  within("positions equal the serial back end's [m]", difference<particle::Position>(d, s),
         v * step);
  within("velocities equal the serial back end's [m/s]", difference<particle::Velocity>(d, s), v);
  if constexpr (Scene::has_rods) {
    within("thread positions equal them [m]", difference<bead::Position>(d, s), v * step);
    within("thread velocities equal them [m/s]", difference<bead::Velocity>(d, s), v);
    check(s.template get<contact::Impulse>(0, 10)[0] != 0.0f, name,
          "the thread exchanges impulses");
  }
  check(device.status(0) == serial.status(0), name, "the status is that of the serial back end");
  check(same_bits(d, 2, read(narrow), 2), name, "256 threads give the same bits");
  check(same_bits(d, 0, read(alone), 0), name, "alone it has the same bits");
  for (std::int64_t env : {0, 1, 2})
    check(same_bits(d, env, read(tiled), env), name, "tiled execution gives the same bits");
  device.step(step), alone.step(step), tiled.step(step);
  check(same_bits(read(device), 0, read(alone), 0), name, "after a second step, too, alone");
  check(same_bits(read(device), 0, read(tiled), 0), name, "and tiled");
}

void compare_in_double() {
  auto serial = make_run<Threaded, Serial, double>(3);
  auto device = make_run<Threaded, Cuda, double>(3);
  auto narrow = make_run<Threaded, Cuda, double>(3, Cuda{.threads = 128});
  auto alone = make_run<Threaded, Cuda, double>(1);
  serial.step(step), device.step(step), narrow.step(step), alone.step(step);
  auto const &d = read(device), &s = read(serial);
  char const* name = "tissue and thread in double";
  // The units of its sums are 2^22 times finer than those of float.
  double const v = test::fixed_point_noise(dx, step / substeps, substeps, 27,
                                           test::quantum_of_sums<double>);  // [m/s]
  auto within = [&](char const* what, double got, double allowed) {
    check(got < allowed, name, what, got);
  };
  within("positions equal the serial back end's [m]", difference<particle::Position>(d, s),
         v * step);
  within("velocities equal them [m/s]", difference<particle::Velocity>(d, s), v);
  within("thread velocities equal them [m/s]", difference<bead::Velocity>(d, s), v);
  check(same_bits(d, 2, read(narrow), 2), name, "128 threads give the same bits");
  check(same_bits(d, 0, read(alone), 0), name, "alone it has the same bits");
}

}  // namespace

int main() {
  compare<TissueAlone>("tissue alone");
  compare<Threaded>("tissue and thread");
  compare_in_double();
  return test::report.end();
}
