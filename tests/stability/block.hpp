// A block of tissue alone in a simulation, and what every hard case asks of it: finite numbers inside the
// domain, momentum, energy. One substep per step unless a case says otherwise.
#pragma once

#include <vector>

#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/mpm/transfer/flip.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/scene/totals.hpp>
#include <mpmpbd/testing/samples.hpp>

namespace test {

using namespace mpmpbd;

// Where a block is and what it weighs.
struct BlockCase {
  Vec3<double> low = vec(4.13, 4.27, 4.41);  // its corner [cells]
  Vec3<int> cells{{3, 3, 3}}, nodes{{12, 12, 12}};
  int per_axis = 2;                        // particles per cell and axis
  double cell = 3.7e-3, density = 1050.0;  // [m], [kg/m^3]
  int substeps = 1;

  double spacing() const { return cell / per_axis; }
  double volume() const { return spacing() * spacing() * spacing(); }  // of a particle [m^3]
  Vec3<double> middle() const {
    return cell * (low + 0.5 * vec(1.0 * cells[0], 1.0 * cells[1], 1.0 * cells[2]));
  }
  std::vector<Vec3<double>> positions() const {
    std::vector<Vec3<double>> all;
    for (int k = 0; k < per_axis * cells[2]; ++k)
      for (int j = 0; j < per_axis * cells[1]; ++j)
        for (int i = 0; i < per_axis * cells[0]; ++i)
          all.push_back(cell * low + spacing() * vec(i + 0.5, j + 0.5, k + 0.5));
    return all;
  }
  SimulationOptions options(std::int64_t particles) const {
    return {.environments = 1,
            .cell_size = cell,
            .nodes = {nodes[0], nodes[1], nodes[2]},
            .capacity = {{Particles::name.view(), particles}},
            .substeps = substeps};
  }
};

// Sums over all particles.
struct Sums : Totals {
  double momentum_size = 0;     // sum of m |v| [kg m/s]
  double potential = 0;         // of gravity [J]
  double least_volume = 1e300;  // det F
  bool finite = true, inside = true;

  double energy() const { return Totals::energy() + potential; }
};

template <class Scene_, class T = double, class Backend = Serial> struct Block {
  using Body = typename Scene_::Body;
  using Material = typename Body::Material;
  template <class F> static constexpr bool stores = contains<typename Scene_::StateFields, F>;
  static constexpr bool turns = Body::Transfer::carries_affine && Body::Shape::inverse_inertia > 0;

  BlockCase c;
  Simulation<Scene_, Backend, T> run;

  Block(BlockCase const& c_, parameters_t<Material, double> const& k, Backend backend = {})
      : Block(c_, k, c_.positions(), backend) {}
  Block(BlockCase const& c_, parameters_t<Material, double> const& k,
        std::vector<Vec3<double>> const& at, Backend backend = {})
      : c(c_), run(c_.options(static_cast<std::int64_t>(at.size())), backend) {
    if constexpr (parameter_count < Material >> 0) run.template set<Material>(k);
    if constexpr (std::is_same_v<typename Body::Transfer, Flip>) run.template set<Flip>({1.0});
    run.add_particles(0, at, c.density, c.volume());
  }

  std::int64_t size() const { return run.state().template table<Particles>().live(0); }
  template <class F> auto get(std::int64_t p) const {
    return mpmpbd::detail::in_double(run.state().template get<F>(0, p));
  }
  template <class F> void set(std::int64_t p, value_t<F, double> const& a) {
    if constexpr (F::components == 1)
      run.state().template set<F>(0, p, static_cast<T>(a));
    else
      run.state().template set<F>(0, p, cast<T>(a));
  }
  Mat3<double> affine(std::int64_t p) const {
    if constexpr (stores<particle::Affine>)
      return get<particle::Affine>(p);
    else
      return {};
  }
  // The limit of the step in the present state, without the safety factor [s].
  double limit() { return run.suggest_dt(0) / time_step_safety; }

  // Gives all particles the motion v + L (x - middle).
  void stir(Vec3<double> const& v, Mat3<double> const& L) {
    for (std::int64_t p = 0; p < size(); ++p) {
      set<particle::Velocity>(p, v + L * (get<particle::Position>(p) - c.middle()));
      if constexpr (stores<particle::Affine>) set<particle::Affine>(p, L);
    }
  }

  // Takes away the motion of the middle of mass, so that the block stays where it is.
  void stay() {
    auto const all = sums();
    auto const mean = 1 / all.mass * all.momentum;
    for (std::int64_t p = 0; p < size(); ++p)
      set<particle::Velocity>(p, get<particle::Velocity>(p) - mean);
  }

  Sums sums() const {
    Sums s{tissue_totals(run, 0)};
    for (std::int64_t p = 0; p < size(); ++p) add(s, p);
    return s;
  }

  // One step of h [s]. Returns the energy that symplectic Euler keeps of a linear system [J]: strain and
  // potential before the step, and the kinetic energy between the velocities before and after its
  // forces. For PIC and APIC the latter is the grid's own: sum m (v.v' + D C:C') = sum m_i v_i.v_i'.
  double step(double h) {
    auto const before = sums();
    auto const v = motions();
    run.step(h);
    auto const w = motions();
    double kinetic = 0;
    for (std::size_t p = 0; p < v.size(); ++p)
      kinetic += 0.5 * get<particle::Mass>(static_cast<std::int64_t>(p)) *
                 (dot(v[p].velocity, w[p].velocity) + inertia() * dot(v[p].affine, w[p].affine));
    return before.strain + before.potential + kinetic;
  }

 private:
  struct Motion {
    Vec3<double> velocity;
    Mat3<double> affine;
  };
  double inertia() const { return turns ? c.cell * c.cell / Body::Shape::inverse_inertia : 0.0; }
  std::vector<Motion> motions() const {
    std::vector<Motion> all;
    for (std::int64_t p = 0; p < size(); ++p)
      all.push_back({get<particle::Velocity>(p), affine(p)});
    return all;
  }
  void add(Sums& s, std::int64_t p) const {
    auto const x = get<particle::Position>(p), v = get<particle::Velocity>(p);
    auto const F = get<particle::Deformation>(p), C = affine(p);
    double const m = get<particle::Mass>(p);
    s.momentum_size += m * norm(v);
    if constexpr (stores<ParametersField<Gravity>>) {
      auto const k = run.state().template parameters<Gravity>(0);
      for (int a = 0; a < 3; ++a) s.potential -= m * static_cast<double>(k.g[a]) * x[a];
    }
    s.least_volume = mpmpbd::min(s.least_volume, determinant(F));
    s.finite = s.finite && is_finite(x) && is_finite(v) && is_finite(F) && is_finite(C);
    for (int a = 0; a < 3; ++a)
      s.inside = s.inside && x[a] >= 0.0 && x[a] <= c.cell * (c.nodes[a] - 1);
  }
};

}  // namespace test
