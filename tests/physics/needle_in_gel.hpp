// A needle in a block of gel, as a composed scene in physical units. Without a surface: every point with
// gel around it is coupled, and the tip cuts for nothing.
#pragma once

#include <vector>

#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>

namespace test {

using namespace mpmpbd;

struct Gel : Mpm<NeoHookean> {};
template <class... Laws>
struct NeedleInGel : Scene<Gel, ArcNeedle, Coupling<Embedded, Laws...>, Damping, Walls<Sticky>> {};

inline constexpr double gel_modulus = 10e3, gel_poisson = 0.4,
                        gel_density = 1050.0;  // [Pa], [kg/m^3]
inline constexpr double gel_cell = 2e-3;       // [m]
inline double gel_shear_speed() {
  return std::sqrt(lame(gel_modulus, gel_poisson).mu / gel_density);
}
inline double gel_time() {
  return gel_cell / gel_shear_speed();
}  // of a shear wave over a cell [s]

// Where the gel is, in whole cells, with eight particles in each; walls hold it on the sides that are `held`.
struct GelBlock {
  int low[3] = {3, 3, 3}, high[3] = {15, 15, 15};
  double held_low[3] = {3, 3, 3}, held_high[3] = {15, 15, 15};  // [cells]
  double damping = 0;                                           // [1/s]
  int substeps = 0;
  int environments = 1;

  std::int64_t particles() const {
    return 8LL * (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
  }
  std::vector<Vec3<double>> positions() const {
    std::vector<Vec3<double>> all;
    for (int k = 2 * low[2]; k < 2 * high[2]; ++k)
      for (int j = 2 * low[1]; j < 2 * high[1]; ++j)
        for (int i = 2 * low[0]; i < 2 * high[0]; ++i)
          all.push_back(0.5 * gel_cell * vec(i + 0.5, j + 0.5, k + 0.5));
    return all;
  }
};

template <class S, class T>
Simulation<S, Serial, T> gel_scene(GelBlock const& b, Arc<double> const& arc) {
  int const contacts = contact_points(ArcPoints<double>::over(arc, gel_cell));
  Simulation<S, Serial, T> run({.environments = b.environments,
                                .cell_size = gel_cell,
                                .nodes = {b.high[0] + 4, b.high[1] + 4, b.high[2] + 4},
                                .capacity = {{Particles::name.view(), b.particles()},
                                             {Needles::name.view(), 1},
                                             {ContactPoints::name.view(), contacts}},
                                .substeps = b.substeps});
  run.template set<NeoHookean>(lame(gel_modulus, gel_poisson));
  if constexpr (contains<typename S::StateFields, ParametersField<Damping>>)
    run.template set<Damping>({b.damping});
  Walls<Sticky>::Parameters<double> walls{};
  for (int a = 0; a < 3; ++a) {
    walls.low[a] = gel_cell * b.held_low[a];
    walls.high[a] = gel_cell * b.held_high[a];
  }
  run.template set<Walls<Sticky>>(walls);
  if constexpr (!S::Needle::is_dynamic)
    run.template set<ArcNeedle>({arc.radius, arc.angle, arc.wire_radius, arc.taper, 0.0, 0.0});
  auto const points = b.positions();
  for (int e = 0; e < b.environments; ++e) {
    run.add_particles(e, points, gel_density, gel_cell * gel_cell * gel_cell / 8);
    run.state().template table<ContactPoints>().set_live(e, contacts);
    run.state().template table<Needles>().set_live(e, 1);
  }
  return run;
}

// Environment `e` has one needle; its pose and twist are set from outside.
template <class Sim> void place_needle(Sim& run, std::int64_t e, Pose<double> const& pose) {
  needle::set_pose(run.state().template view<Needles>(), e, cast_pose<typename Sim::Scalar>(pose));
}
template <class Sim>
void drive_needle(Sim& run, std::int64_t e, Vec3<double> const& velocity,
                  Vec3<double> const& spin) {
  using T = typename Sim::Scalar;
  needle::set_twist(run.state().template view<Needles>(), e,
                    Twist<T>{cast<T>(velocity), cast<T>(spin)});
}

}  // namespace test
