// The scenes of the covering array (written by covering_array.py), and what each of them has to hold: the laws of a batch, momentum,
// energy, everything finite and inside the domain.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/pinned_region.hpp>
#include <mpmpbd/effects/prony.hpp>
#include <mpmpbd/effects/viscosity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/fibre_reinforced.hpp>
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/st_venant_kirchhoff.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>
#include <mpmpbd/mpm/materials/weakly_compressible_fluid.hpp>
#include <mpmpbd/mpm/transfer/flip.hpp>
#include <mpmpbd/mpm/transfer/pic.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>
#include <mpmpbd/testing/batch_laws.hpp>

#include "catch.hpp"

namespace covering {

using namespace mpmpbd;

inline constexpr double dx = 3.7e-3, density = 1050.0;
template <class Condition> using Floor = Wall<Condition, 2, Side::low>;

// Sets of effects.
struct Free {
  static constexpr FixedString name = "free";
  template <class Body> struct With : Scene<Body> {};
};
struct Falls {
  static constexpr FixedString name = "gravity, viscosity, sticky floor";
  template <class Body> struct With : Scene<Body, Gravity, Viscosity, Floor<Sticky>> {};
};
struct Hangs {
  static constexpr FixedString name = "gravity, damping, pinned region, slip floor";
  template <class Body> struct With : Scene<Body, Gravity, Damping, PinnedRegion, Floor<Slip>> {};
};
struct Relaxes {
  static constexpr FixedString name = "gravity, Prony, separating floor";
  template <class Body> struct With : Scene<Gravity, Prony<2>, Floor<Separating>, Body> {};
};

template <class Material_, class Effects_, class Transfer_, class Shape_, class Form_,
          class Scalar_, class Backend_>
struct Row {
  using Material = Material_;
  using Transfer = Transfer_;
  using Scalar = Scalar_;
  using Backend = Backend_;
  using Tissue = Mpm<Material, Transfer_, Shape_, Form_>;
  using Scene = typename Effects_::template With<Tissue>;

  static std::vector<std::string> names() {
    return {std::string(Material::name.view()), std::string(Effects_::name.view()),
            std::string(Transfer::name.view()), std::string(Shape_::name.view()),
            std::string(Form_::name.view()),    sizeof(Scalar) == 8 ? "double" : "float",
            std::string(Backend::name.view())};
  }
  static std::string text() {
    std::string all;
    for (auto const& n : names()) all += (all.empty() ? "" : " | ") + n;
    return all;
  }
};

#include "covering_array_rows.hpp"

template <class Material> parameters_t<Material, double> numbers(double young) {
  if constexpr (std::is_same_v<Material, WeaklyCompressibleFluid>)
    return {young, 7.0};
  else if constexpr (std::is_same_v<Material, FibreReinforced<>>)
    return {numbers<StableNeoHookean>(young), 0.3 * young, 1.5};
  else
    return lame(young, 0.3);
}

// A block of 6 x 6 x 6 particles that turns and stretches while it moves; variants differ in all numbers.
template <class Row> struct Fill {
  using Scene = typename Row::Scene;
  template <class P>
  static constexpr bool has = contains<typename Scene::StateFields, ParametersField<P>>;

  template <class R> void operator()(R& run, std::int64_t env, int which) const {
    using T = typename R::Scalar;
    double const v = 1.0 + which;
    run.template set<typename Row::Material>(env, numbers<typename Row::Material>(1.5e4 * v));
    if constexpr (has<Flip>) run.template set<Flip>(env, {0.99 - 0.01 * v});
    if constexpr (has<Gravity>) run.template set<Gravity>(env, {{0.0, 0.1 * v, -9.81}});
    if constexpr (has<Viscosity>) run.template set<Viscosity>(env, {0.05 * v});
    if constexpr (has<Damping>) run.template set<Damping>(env, {2.0 * v});
    if constexpr (has<Prony<2>>)
      run.template set<Prony<2>>(env, {{0.3, 0.1 * v}, {2e-3 * v, 3e-2}});
    if constexpr (has<PinnedRegion>)
      run.template set<PinnedRegion>(env, {{0.0, 0.0, 6.5 * dx}, {11 * dx, 11 * dx, 11 * dx}});
    floor<Sticky>(run, env);
    floor<Slip>(run, env);
    floor<Separating>(run, env);

    std::vector<Vec3<double>> at;
    for (int p = 0; p < 216; ++p)
      at.push_back(dx * vec(4.13 + 0.5 * (p % 6), 4.27 + 0.5 * (p / 6 % 6), 3.9 + 0.5 * (p / 36)));
    run.add_particles(env, at, density, dx * dx * dx / 8);
    Mat3<double> const L{{3.0, -9.0, 4.0, 7.0, -2.0, 5.0, -6.0, 1.0, -4.0}};  // [1/s]
    auto const centre = dx * vec(5.5, 5.5, 5.5);
    for (std::int64_t p = 0; p < 216; ++p) {
      auto const u = vec(0.05, -0.03 * v, -0.1) + L * (at[static_cast<std::size_t>(p)] - centre);
      run.state().template set<particle::Velocity>(env, p, cast<T>(u));
      if constexpr (Row::Transfer::carries_affine)
        run.state().template set<particle::Affine>(env, p, cast<T>(L));
      if constexpr (contains<typename Scene::StateFields, particle::Fibre>)
        run.state().template set<particle::Fibre>(env, p, {{T(0.36), T(0.48), T(0.8)}});
    }
  }

 private:
  template <class Condition, class R> static void floor(R& run, std::int64_t env) {
    if constexpr (has<Floor<Condition>>) run.template set<Floor<Condition>>(env, {3.6 * dx});
  }
};

struct Totals {
  Vec3<double> momentum{};
  double speeds = 0.0;   // sum m |v| [kg m/s]
  double kinetic = 0.0;  // [J]
  double energy = 0.0;   // kinetic, strain and gravity's [J]
  bool finite = true, inside = true;
};

template <class Row, class R> Totals totals(R const& run, std::int64_t env) {
  using Scene = typename Row::Scene;
  using T = typename Row::Scalar;
  using Shape = typename Row::Tissue::Shape;
  Totals t;
  auto const& s = run.state();
  for (std::int64_t p = 0; p < s.template table<Particles>().live(env); ++p) {
    double const m = double(s.template get<particle::Mass>(env, p));
    auto const x = cast<double>(s.template get<particle::Position>(env, p));
    auto const v = cast<double>(s.template get<particle::Velocity>(env, p));
    t.momentum += m * v;
    t.speeds += m * norm(v);
    t.kinetic += 0.5 * m * dot(v, v);
    if constexpr (Row::Transfer::carries_affine && Shape::inverse_inertia > 0.0) {
      auto const C = cast<double>(s.template get<particle::Affine>(env, p));
      t.kinetic += 0.5 * m * dx * dx / Shape::inverse_inertia * dot(C, C);
    }
    mpmpbd::detail::Archetype<typename Row::Material, double> item{};
    item[particle::Deformation{}] = cast<double>(s.template get<particle::Deformation>(env, p));
    if constexpr (contains<typename Scene::StateFields, particle::Fibre>)
      item[particle::Fibre{}] = cast<double>(s.template get<particle::Fibre>(env, p));
    t.energy +=
        m / density *
        Row::Material::energy(item, cast_parameters<typename Row::Material, double, T>(
                                        s.template parameters<typename Row::Material>(env)));
    if constexpr (Fill<Row>::template has<Gravity>) {
      auto const g = s.template parameters<Gravity>(env);
      for (int a = 0; a < 3; ++a) t.energy -= m * double(g.g[a]) * x[a];
    }
    for (int a = 0; a < 3; ++a) t.inside = t.inside && x[a] >= 0.0 && x[a] <= 11.0 * dx;
    t.finite = t.finite && is_finite(x) && is_finite(v) && is_finite(item[particle::Deformation{}]);
  }
  t.energy += t.kinetic;
  return t;
}

template <class Row> void check_row() {
  using T = typename Row::Scalar;
  std::printf("%s\n", Row::text().c_str());
  INFO(Row::text());
  SimulationOptions const options{
      .environments = 1, .cell_size = dx, .nodes = {12, 12, 12}, .capacity = {{"particle", 220}}};
  for (auto const& law : batch_laws<typename Row::Scene, T>(
           testing::BatchCase<Fill<Row>>{options, Fill<Row>{}, 4e-4, 3})) {
    INFO(law.text());
    CHECK(law.holds());
  }

  Simulation<typename Row::Scene, typename Row::Backend, T> run(options);
  Fill<Row>{}(run, 0, 1);
  auto const start = totals<Row>(run, 0);
  // Symplectic Euler keeps an energy that differs from the sum of kinetic and strain energy by half the
  // power over a substep: at most half of what the kinetic energy changes in a step.
  double gained = 0.0, exchanged = 0.0, kinetic = start.kinetic;
  for (int s = 0; s < 50; ++s) {
    run.step(4e-4);
    auto const now = totals<Row>(run, 0);
    gained = max(gained, now.energy - start.energy);
    exchanged = max(exchanged, mpmpbd::abs(now.kinetic - kinetic));
    kinetic = now.kinetic;
  }
  auto const end = totals<Row>(run, 0);
  CHECK(run.status(0) == 0);
  CHECK(end.finite);
  CHECK(end.inside);
  if constexpr (std::is_same_v<typename Row::Scene, typename Free::With<typename Row::Tissue>>)
    CHECK(norm(end.momentum - start.momentum) <= (sizeof(T) == 8 ? 1e-12 : 2e-5) * start.speeds);
  // A linear shape pumps energy when particles cross cells (table A2.7): no claim.
  if constexpr (Row::Tissue::Shape::inverse_inertia > 0.0)
    CHECK(gained <= 1e-3 * start.kinetic + 0.5 * exchanged);
}

template <class... Rows> void check_rows(TypeList<Rows...>) { (check_row<Rows>(), ...); }

}  // namespace covering
