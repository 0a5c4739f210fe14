// Two beads that may not come closer than a given distance.
#pragma once

#include <mpmpbd/pbd/constraints/distance.hpp>

namespace mpmpbd {

// C = |b - a| - l [m] >= 0: pushes two beads apart, never together.
struct MinimumDistance {
  using Role = role::Constraint;
  static constexpr FixedString name = "MinimumDistance";
  using Unknowns = TypeList<unknown::Point, unknown::Point>;
  static constexpr int dimension = 1;
  static constexpr ConstraintKind kind = ConstraintKind::inequality;
  static constexpr bool frame_invariant = true;

  template <class T> struct Parameters {
    T least;       // [m]
    T compliance;  // [m/N]
  };
  static constexpr std::array<ParameterInfo, 2> parameter_info{
      {bound::positive("least", "m"), bound::not_negative("compliance", "m/N")}};

  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k) {
    using T = typename X::Scalar;
    Evaluation<MinimumDistance, T> e;
    Vec3<T> const d = get<1>(x) - get<0>(x);
    T const length = norm(d);
    Vec3<T> const n = detail::direction_or_axis(d, length, k.least);
    e.value[0] = length - k.least;
    gradient<0>(e) = transpose(-n);
    gradient<1>(e) = transpose(n);
    return e;
  }
  template <class T> MPMPBD_HD static T compliance(Parameters<T> const& k) { return k.compliance; }
};

}  // namespace mpmpbd
