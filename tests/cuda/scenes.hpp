// Small scenes that go through all forms of a coupling: tissue alone, a material whose stress is state, a coupling that
// reads particles, one that works on the grid.
#pragma once

#include <mpmpbd/backend/cuda/simulation.cuh>
#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/coupling/grid_projection.hpp>
#include <mpmpbd/coupling/tissue_pressure.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/prony.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/flip.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include "cuda/compare.hpp"
#include "cuda/fixed_point_noise.hpp"

namespace test {

using namespace mpmpbd;

using Floor = Wall<Sticky, 2, Side::low>;
struct Tissue : Mpm<NeoHookean> {};
struct Smooth : Mpm<StableNeoHookean, CubicBSpline, Tpic, WeightGradient> {};
struct Thread : Pbd<Constraints<Distance, Bend>> {};
struct LooseThread : Pbd<Constraints<Distance>> {};
struct Alone : Scene<Smooth, Gravity, Floor> {};
struct Splashing : Scene<Mpm<NeoHookean, Flip>, Gravity, Floor> {};
struct Relaxing : Scene<Tissue, Prony<2>, Gravity, Floor> {};
struct Squeezed : Scene<Tissue, Thread, Coupling<Embedded, Friction, TissuePressure>, Floor> {};
struct Projected : Scene<Tissue, LooseThread, Coupling<GridProjection, Friction>, Floor> {};

inline constexpr double dx = 0.04, step = 0.002;
inline constexpr int beads = 9, substeps = 4;

template <class Scene> SimulationOptions options(std::int64_t environments) {
  SimulationOptions o;
  o.environments = environments;
  o.cell_size = dx;
  o.nodes[0] = 17;
  o.nodes[1] = 12;
  o.nodes[2] = 11;
  o.substeps = substeps;
  o.capacity = {{"particle", 20 * 12 * 10}};
  if constexpr (Scene::has_rods)
    for (Capacity const& more : {Capacity{"bead", beads}, Capacity{"Distance", beads - 1},
                                 Capacity{"Bend", beads - 2}, Capacity{"contact point", beads}})
      o.capacity.push_back(more);
  return o;
}

template <class Run> void add_tissue(Run& run, std::int64_t env) {
  std::vector<Vec3<double>> x;
  for (int k = 0; k < 10; ++k)
    for (int j = 0; j < 12; ++j)
      for (int i = 0; i < 20; ++i)
        x.push_back({{0.12 + 0.02 * (i + 0.5), 0.1 + 0.02 * (j + 0.5), 0.09 + 0.02 * (k + 0.5)}});
  run.add_particles(env, x, 1000.0, 8e-6);
  for (std::int64_t p = 0; p < static_cast<std::int64_t>(x.size()); ++p) {
    auto const& at = x[static_cast<std::size_t>(p)];
    run.state().template set<particle::Velocity>(
        env, p, {{0.2f * float(std::sin(9.0 * at[1])), 0.0f, 0.1f * float(std::cos(7.0 * at[0]))}});
  }
  run.template set<Floor>(env, {0.1});
}
template <class Run> void add_thread_through(Run& run, std::int64_t env) {
  using Rods = typename Run::Scene::Rods;
  std::vector<Vec3<double>> line;
  for (int k = 0; k < beads; ++k)
    line.push_back({{0.1 + 0.05 * k, 0.22, 0.2 + 0.02 * std::sin(0.8 * k)}});
  RodAssembly<Rods> rod;
  // With GridProjection a thread lighter than the nodes it moves explodes, and shows every rounding.
  double const density = std::is_same_v<typename Run::Scene, Projected> ? 4e5 : 1140.0;
  add_thread(rod, std::span<Vec3<double> const>(line), RodMaterial{2e6, 0.004, density},
             RestShape::as_placed);
  rod.write(run.state(), env);
  if constexpr (Run::Store::template has<ContactPoints>)
    run.state().template table<ContactPoints>().set_live(env, beads);
  for (int k = 0; k < beads; ++k)
    run.state().template set<bead::Velocity>(env, k, {{0.8f, 0.1f * float(env), 0.1f}});
}
template <class Run> void set_up(Run& run, std::int64_t env) {
  using Scene = typename Run::Scene;
  add_tissue(run, env);
  if constexpr (std::is_same_v<Scene, Alone>)
    run.template set<StableNeoHookean>(env, lame(4e5, 0.4));
  else
    run.template set<NeoHookean>(env, lame(4e5, 0.4));
  if constexpr (!Scene::has_rods) run.template set<Gravity>(env, {{0.0, 0.0, -9.81}});
  if constexpr (std::is_same_v<Scene, Splashing>) run.template set<Flip>(env, {0.95});
  if constexpr (std::is_same_v<Scene, Relaxing>)
    run.template set<Prony<2>>(env, {{0.2, 0.1}, {0.01, 0.1}});
  if constexpr (Scene::has_rods) {
    add_thread_through(run, env);
    run.template set<Friction>(env, {0.3, 500.0});
    if constexpr (std::is_same_v<Scene, Squeezed>)
      run.template set<Embedded>(env, {0.004});
    else
      run.template set<GridProjection>(env, {0.8 * dx, 0.01});
  }
}
template <class Run> Run made(std::int64_t environments, auto... where) {
  Run run(options<typename Run::Scene>(environments), where...);
  for (std::int64_t env = 0; env < environments; ++env) set_up(run, env);
  return run;
}

static_assert(quantum_of_sums<float> * cuda::FixedPoint<float>::scale == 1);
static_assert(quantum_of_sums<double> * cuda::FixedPoint<double>::scale == 1);
// Of velocities after some steps [m/s].
template <class Scene> double rounding(int steps) {
  return fixed_point_noise(dx, step / substeps, substeps * steps,
                           nodes_per_point<typename Scene::Body::Shape>);
}

}  // namespace test
