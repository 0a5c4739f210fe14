// Scenes of threads without tissue for tests of a device, one for each solver, and arcs that fall.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include <mpmpbd/catalog/scenes.hpp>
#include <mpmpbd/pbd/constraints/bend_twist.hpp>
#include <mpmpbd/pbd/constraints/stretch_shear.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/pbd/solvers/direct_frames.hpp>
#include <mpmpbd/pbd/solvers/jacobi.hpp>

namespace test {

using namespace mpmpbd;

struct Swept : Scene<Pbd<Constraints<Distance, Bend>, Xpbd<6>>, Gravity, Damping> {};
struct Averaged : Scene<Pbd<Constraints<Distance, Bend>, Jacobi<7>>, Gravity, Damping> {};
struct Framed : Scene<Pbd<Constraints<StretchShear, BendTwist>, DirectFrames<2>>, Gravity> {};

inline constexpr int beads = 150, substeps = 2;
inline constexpr double step = 2e-3, length = 0.3;
inline constexpr RodMaterial nylon{2e9, 1.15e-4, 1140.0};

template <class Scene> SimulationOptions thread_options(std::int64_t environments) {
  SimulationOptions o;
  o.environments = environments;
  o.capacity = {{"bead", beads + 3},  {"Distance", beads},     {"Bend", beads},
                {"frame", beads + 3}, {"StretchShear", beads}, {"BendTwist", beads}};
  o.substeps = substeps;
  return o;
}

// An arc that falls, its first bead held; of another environment another arc.
template <class Run> void add_arc(Run& run, std::int64_t env) {
  using Rods = typename Run::Scene::Rods;
  std::vector<Vec3<double>> line;
  double const turn = 1.0 + 0.3 * double(env);
  for (int k = 0; k < beads; ++k) {
    double const s = double(k) / (beads - 1), angle = turn * s;
    line.push_back(
        length * vec(std::sin(angle) / turn, 0.02 * std::sin(9 * s), (1 - std::cos(angle)) / turn));
  }
  RodAssembly<Rods> rod;
  auto const points = std::span<Vec3<double> const>(line);
  if constexpr (Rods::has_frames) {
    add_framed_thread(rod, points, nylon);
    rod.prescribe(1);
  } else {
    add_thread(rod, points, nylon);
  }
  rod.prescribe(0);
  rod.write(run.state(), env);
  run.template set<Gravity>(env, {{0.3, 0.0, -9.81}});
}
template <class Run> Run with_arcs(std::int64_t environments, auto... where) {
  Run run(thread_options<typename Run::Scene>(environments), where...);
  for (std::int64_t env = 0; env < environments; ++env) add_arc(run, env);
  run.remember();
  return run;
}

// How far apart threads may be after some steps where arithmetic differs: positions are rounded once a substep, and what they
// are off by turns into velocity [m].
inline double arc_rounding(int steps) {
  double const v = steps * substeps * 0x1p-24 * length / (step / substeps);
  return v * steps * step;
}

}  // namespace test
