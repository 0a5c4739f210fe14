// What an MPM policy has to give: materials, shape functions, transfer schemes, force forms.
//
// Checked at one door, where a body is composed: one requirement, one sentence.
#pragma once

#include <mpmpbd/core/local.hpp>
#include <mpmpbd/core/pack.hpp>
#include <mpmpbd/core/parameters.hpp>
#include <mpmpbd/core/role.hpp>
#include <mpmpbd/core/tick.hpp>

namespace mpmpbd {

// Bounds of the tangent at the current deformation [Pa]: what the time step limit needs. Either may be
// the larger one: in strong compression waves stiffen more than a single particle does.
template <class T> struct Stiffness {
  // Largest a.(dtau[a x n] - tau n x a) n over unit vectors: rho0 c^2 of the fastest wave.
  T longitudinal;  // lambda + 2 mu at rest
  // Largest eigenvalue of the symmetric part of dtau/dL (9x9): omega^2 = bulk3 / (rho0 D) of the
  // fastest mode of a single particle.
  T bulk3;  // 3 K = 3 lambda + 2 mu at rest
};

template <class P> concept HasName = requires {
  { P::name.view() } -> std::convertible_to<std::string_view>;
};
template <class P> concept DeclaresFields = requires {
  { P::Reads::count } -> std::convertible_to<int>;
  { P::Writes::count } -> std::convertible_to<int>;
};

namespace detail {
// Whether M has any member called after_update, callable or not: a derived class with a second one of
// that name makes it ambiguous.
struct HasAfterUpdate {
  int after_update;
};
template <class M> struct BothUpdates : M, HasAfterUpdate {};
template <class M>
inline constexpr bool names_after_update = [] {
  if constexpr (std::is_final_v<M>)
    return false;
  else
    return !requires { &BothUpdates<M>::after_update; };
}();

// An item with exactly the fields that policy P declares.
template <class P, class T = float>
using Archetype = Local<T, union_t<typename P::Reads, typename P::Writes>>;
}  // namespace detail

template <class M>
concept ComputesStress = requires(detail::Archetype<M> const& p, parameters_t<M, float> const& k) {
  { M::kirchhoff(p, k) } -> std::same_as<Mat3<float>>;
};
template <class M>
concept ComputesEnergy = requires(detail::Archetype<M> const& p, parameters_t<M, float> const& k) {
  { M::energy(p, k) } -> std::same_as<float>;
};
template <class M>
concept UpdatesHistory = requires(detail::Archetype<M>& p, parameters_t<M, float> const& k,
                                  Tick<float> const& tick) {
  M::after_update(p, k, tick);
};
template <class M>
concept BoundsStiffness = requires(detail::Archetype<M> const& p, parameters_t<M, float> const& k) {
  { M::stiffness(p, k) } -> std::same_as<Stiffness<float>>;
};

// A hyperelastic (or fluid) constitutive law. `kirchhoff(p, k)` -> tau = P F^T = J sigma [Pa];
// `energy(p, k)` [J/m^3 at rest]; `stiffness(p, k)` [Pa]; optional `after_update(p, k, tick)`, called
// when F is new, for a law with history (it may write the fields that it declares in Writes), and
// `static constexpr bool needs_positive_volume` when det F <= 0 is a fault.
template <class M>
concept MaterialModel = HasRole<M, role::Material> && HasName<M> && DeclaresFields<M> &&
    ComputesStress<M> && ComputesEnergy<M> && BoundsStiffness<M>;

// Whether det F <= 0 is a fault for a material.
template <class M>
inline constexpr bool needs_positive_volume = [] {
  if constexpr (requires { M::needs_positive_volume; })
    return bool(M::needs_positive_volume);
  else
    return false;
}();

// A tensor-product B-spline. For a particle at f cells from the first of its `width` nodes (per axis):
// weight(i, f), slope(i, f) = dw/dx * dx, moment(i, f) = D^-1 w (x_i - x_p) * dx, offset: the first
// node is floor(x/dx - offset); inverse_inertia = D^-1 dx^2 (0: depends on the position).
template <class S>
concept ShapeFunction = HasRole<S, role::Shape> && HasName<S> && requires(float f) {
  { S::width } -> std::convertible_to<int>;
  { S::offset } -> std::convertible_to<double>;
  { S::inverse_inertia } -> std::convertible_to<double>;
  { S::weight(0, f) } -> std::same_as<float>;
  { S::slope(0, f) } -> std::same_as<float>;
  { S::moment(0, f) } -> std::same_as<float>;
};

// What a particle is given back by the grid. Only what the composition needs is computed.
template <class T> struct Gathered {
  Vec3<T> velocity;           // sum w v                                 [m/s]
  Vec3<T> previous_velocity;  // sum w v before forces (FLIP)            [m/s]
  Mat3<T> moment;             // D^-1 sum w v d^T                        [1/s]
  Mat3<T> slope;              // sum v grad w^T                          [1/s]
};

// How velocity travels between particles and grid: a particle gives v (+ C d when carries_affine),
// and `finish(p, gathered, k)` sets its new velocity (and C). Reads and Writes are those of finish.
template <class S>
concept TransferScheme = HasRole<S, role::Transfer> && HasName<S> && DeclaresFields<S> &&
    requires(detail::Archetype<S>& p, Gathered<float> const& g, parameters_t<S, float> const& k) {
  { S::carries_affine } -> std::convertible_to<bool>;
  { S::needs_moment } -> std::convertible_to<bool>;
  { S::needs_slope } -> std::convertible_to<bool>;
  { S::needs_previous_grid } -> std::convertible_to<bool>;
  S::finish(p, g, k);
};

// Which gradient carries forces to the grid and updates F: the weight's slope, or the moment (MLS).
template <class F> concept ForceForm = HasRole<F, role::Form> && HasName<F> && requires {
  { F::uses_moment } -> std::convertible_to<bool>;
};

namespace detail {
// Never called: its address makes the compiler look into the body of after_update for undeclared fields.
template <class M>
void update_archetype(Archetype<M>& p, parameters_t<M, float> const& k, Tick<float> const& tick) {
  M::after_update(p, k, tick);
}
}  // namespace detail

template <class M> consteval bool check_material() {
  static_assert(
      HasName<M>,
      "mpmpbd MaterialModel: give it a name: `static constexpr FixedString name = \"...\";`");
  static_assert(
      DeclaresFields<M>,
      "mpmpbd MaterialModel: say what it reads and writes per particle: `using Reads = Fields<particle::Deformation>; using Writes = Fields<>;`");
  static_assert(
      ComputesStress<M>,
      "mpmpbd MaterialModel: give the Kirchhoff stress [Pa]: `template <class P, class K> MPMPBD_HD static auto kirchhoff(P const& p, K const& k)` returning Mat3<typename P::Scalar>");
  static_assert(
      ComputesEnergy<M>,
      "mpmpbd MaterialModel: give the energy density [J/m^3]: `template <class P, class K> MPMPBD_HD static auto energy(P const& p, K const& k)` returning typename P::Scalar");
  static_assert(
      BoundsStiffness<M>,
      "mpmpbd MaterialModel: bound the stiffness [Pa] for the time step: `template <class P, class K> MPMPBD_HD static auto stiffness(P const& p, K const& k)` returning Stiffness<typename P::Scalar>");
  static_assert(
      UpdatesHistory<M> || !detail::names_after_update<M>,
      "mpmpbd MaterialModel: after_update cannot be called; write `template <class P, class K, class T> MPMPBD_HD static void after_update(P& p, K const& k, Tick<T> const& tick)`");
  if constexpr (UpdatesHistory<M>) {
    [[maybe_unused]] constexpr auto look_inside = &detail::update_archetype<M>;
  }
  return MaterialModel<M>;
}

}  // namespace mpmpbd
