// What an environment has in all: mass, momentum, angular momentum and energy of its tissue and of its threads.
//
// Added up on demand, in double and in the order of the slots: the same bits on every back end, and nothing is
// spent on it in a substep.
#pragma once

#include <mpmpbd/effects/strain_work.hpp>
#include <mpmpbd/mpm/body.hpp>
#include <mpmpbd/pbd/fields.hpp>

namespace mpmpbd {

struct Totals {
  double mass = 0.0;                // [kg]
  Vec3<double> momentum{};          // [kg m/s]
  Vec3<double> angular_momentum{};  // about the origin [kg m^2/s]; affine particles spin, too
  double kinetic = 0.0;             // energy [J], with the affine motion within particles
  double strain = 0.0;              // energy stored in the material [J]
  double strain_work = 0.0;  // done on it until the last substep began [J]; 0 without StrainWork

  double energy() const { return kinetic + strain; }
  // What the material has turned into heat, where StrainWork counts. With Prony only when it is at rest: its
  // material reports the energy of the instantaneous modulus.
  double dissipated() const { return strain_work - strain; }

  void add(double m, Vec3<double> const& x, Vec3<double> const& v) {
    mass += m;
    momentum += m * v;
    angular_momentum += cross(x, m * v);
    kinetic += 0.5 * m * dot(v, v);
  }
};

namespace detail {
template <class T> double in_double(T a) { return static_cast<double>(a); }
template <class T, int R, int C> Mat<double, R, C> in_double(Mat<T, R, C> const& a) {
  return cast<double>(a);
}
// A particle's affine velocity C moves its parts, of inertia m D, D = dx^2 / inverse_inertia (Jiang et al. 2015).
inline void add_affine(Totals& sum, double m, double D, Mat3<double> const& C) {
  sum.kinetic += 0.5 * m * D * dot(C, C);
  sum.angular_momentum += (m * D) * vec(C(2, 1) - C(1, 2), C(0, 2) - C(2, 0), C(1, 0) - C(0, 1));
}
}  // namespace detail

// Of the material points of environment `env`. Linear shape functions have no constant D: their affine motion is
// left out.
template <class Sim> Totals tissue_totals(Sim const& sim, std::int64_t env) {
  using Body = typename Sim::Scene::Body;
  using Material = typename Body::Material;
  auto const& state = sim.state();
  auto const k = cast_parameters<Material, double, typename Sim::Scalar>(
      state.template parameters<Material>(env));
  double const dx = sim.options().cell_size;
  Totals sum;
  auto const live = state.template table<Particles>().live(env);
  for (std::int64_t i = 0; i < live; ++i) {
    auto const get = [&]<class F>(F) { return detail::in_double(state.template get<F>(env, i)); };
    double const m = get(particle::Mass{});
    sum.add(m, get(particle::Position{}), get(particle::Velocity{}));
    if constexpr (Body::Transfer::carries_affine && Body::Shape::inverse_inertia > 0.0)
      detail::add_affine(sum, m, dx * dx / Body::Shape::inverse_inertia, get(particle::Affine{}));
    Local<double, typename Material::Reads> p{};
    for_each_field(stored_t<typename Material::Reads>{}, [&](auto f) { p[f] = get(f); });
    sum.strain += get(particle::Volume{}) * Material::energy(p, k);
    if constexpr (contains<typename Sim::Store::List, particle::StrainWork>)
      sum.strain_work += get(particle::StrainWork{});
  }
  return sum;
}

// Of the beads of environment `env`; those of prescribed motion (no inverse mass) are left out, and so is the
// energy in constraints.
template <class Sim> Totals thread_totals(Sim const& sim, std::int64_t env) {
  auto const& state = sim.state();
  Totals sum;
  for (std::int64_t b = 0; b < state.template table<Beads>().live(env); ++b)
    if (double const w = double(state.template get<bead::InverseMass>(env, b)); w > 0.0)
      sum.add(1.0 / w, cast<double>(state.template get<bead::Position>(env, b)),
              cast<double>(state.template get<bead::Velocity>(env, b)));
  return sum;
}

}  // namespace mpmpbd
