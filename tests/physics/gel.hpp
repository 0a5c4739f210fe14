// A block of gel in physical units, as the tissue of composed scenes.
#pragma once

#include <cmath>
#include <vector>

#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>

namespace test {

using namespace mpmpbd;

struct Gel : Mpm<NeoHookean> {};

inline constexpr double gel_modulus = 10e3, gel_poisson = 0.4;  // [Pa], [1]
inline constexpr double gel_density = 1050.0, gel_cell = 2e-3;  // [kg/m^3], [m]
inline double gel_shear_speed() {
  return std::sqrt(lame(gel_modulus, gel_poisson).mu / gel_density);
}
inline double gel_time() {
  return gel_cell / gel_shear_speed();
}  // of a shear wave over a cell [s]

// Where the gel is, in whole cells, with eight particles in each. A scene with walls holds it at and beyond
// the `held` planes.
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
  SimulationOptions options(std::vector<Capacity> capacity) const {
    capacity.push_back({Particles::name.view(), particles()});
    return {.environments = environments,
            .cell_size = gel_cell,
            .nodes = {high[0] + 4, high[1] + 4, high[2] + 4},
            .capacity = std::move(capacity),
            .substeps = substeps};
  }
  template <class Sim> void fill(Sim& run) const {
    using Fields_ = typename Sim::Store::List;
    run.template set<NeoHookean>(lame(gel_modulus, gel_poisson));
    if constexpr (contains<Fields_, ParametersField<Damping>>) run.template set<Damping>({damping});
    if constexpr (contains<Fields_, ParametersField<Walls<Sticky>>>) {
      Walls<Sticky>::Parameters<double> walls{};
      for (int a = 0; a < 3; ++a) {
        walls.low[a] = gel_cell * held_low[a];
        walls.high[a] = gel_cell * held_high[a];
      }
      run.template set<Walls<Sticky>>(walls);
    }
    for (int e = 0; e < environments; ++e)
      run.add_particles(e, positions(), gel_density, gel_cell * gel_cell * gel_cell / 8);
  }
};

// Kinetic and elastic energy of an environment's gel [J].
template <class Sim> double gel_energy(Sim const& run, std::int64_t e) {
  auto const& s = run.state();
  auto const k = lame(gel_modulus, gel_poisson);
  double sum = 0;
  for (std::int64_t i = 0; i < s.template table<Particles>().live(e); ++i) {
    auto const F = cast<double>(s.template get<particle::Deformation>(e, i));
    auto const v = cast<double>(s.template get<particle::Velocity>(e, i));
    auto const C = cast<double>(s.template get<particle::Affine>(e, i));
    double const log_J = std::log(determinant(F));
    sum += double(s.template get<particle::Volume>(e, i)) *
           (0.5 * k.mu * (dot(F, F) - 3) - k.mu * log_J + 0.5 * k.lambda * log_J * log_J);
    sum += 0.5 * double(s.template get<particle::Mass>(e, i)) *
           (dot(v, v) + 0.25 * gel_cell * gel_cell * dot(C, C));
  }
  return sum;
}

}  // namespace test
