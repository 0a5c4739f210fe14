// Two beads at a given distance: the stretch of a thread's segment.
#pragma once

#include <mpmpbd/pbd/concepts.hpp>

namespace mpmpbd {

namespace detail {
// The direction of d, or the x axis when d is too short against `scale` to have one: beads that
// coincide separate, always the same way.
template <class T> MPMPBD_HD Vec3<T> direction_or_axis(Vec3<T> const& d, T length, T scale) {
  if (length > epsilon<T> * scale) return T(1) / length * d;
  return {{T(1), T(0), T(0)}};
}
}  // namespace detail

// C = |b - a| - l0 [m]. Mueller et al. 2007, eq. 8; compliance l0/EA [m/N] makes it a bar.
struct Distance {
  using Role = role::Constraint;
  static constexpr FixedString name = "Distance";
  using Unknowns = TypeList<unknown::Point, unknown::Point>;
  static constexpr int dimension = 1;
  static constexpr ConstraintKind kind = ConstraintKind::equality;
  static constexpr bool along_chain = true;
  static constexpr bool measures_length = true;
  static constexpr bool frame_invariant = true;

  template <class T> struct Parameters {
    T rest_length;  // [m]
    T compliance;   // [m/N]
  };
  static constexpr std::array<ParameterInfo, 2> parameter_info{
      {bound::positive("rest_length", "m"), bound::not_negative("compliance", "m/N")}};

  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k) {
    using T = typename X::Scalar;
    Evaluation<Distance, T> e;
    Vec3<T> const d = get<1>(x) - get<0>(x);
    T const l = norm(d);
    Vec3<T> const n = detail::direction_or_axis(d, l, k.rest_length);
    e.value[0] = l - k.rest_length;
    gradient<0>(e) = transpose(-n);
    gradient<1>(e) = transpose(n);
    return e;
  }
  template <class T> MPMPBD_HD static T compliance(Parameters<T> const& k) { return k.compliance; }
};

}  // namespace mpmpbd
