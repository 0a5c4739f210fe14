// A bead held at a fixed place.
#pragma once

#include <mpmpbd/pbd/concepts.hpp>

namespace mpmpbd {

// C = x - p [m], three numbers. A spring of stiffness 1/compliance; rigid at 0. A bead that simply
// does not move is cheaper with an inverse mass of 0.
struct Pin {
  using Role = role::Constraint;
  static constexpr FixedString name = "Pin";
  using Unknowns = TypeList<unknown::Point>;
  static constexpr int dimension = 3;
  static constexpr ConstraintKind kind = ConstraintKind::equality;

  template <class T> struct Parameters {
    T x, y, z;     // the place [m]
    T compliance;  // [m/N]
  };
  static constexpr std::array<ParameterInfo, 4> parameter_info{
      {bound::any("x", "m"), bound::any("y", "m"), bound::any("z", "m"),
       bound::not_negative("compliance", "m/N")}};

  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k) {
    using T = typename X::Scalar;
    Evaluation<Pin, T> e;
    e.value = get<0>(x) - vec(k.x, k.y, k.z);
    gradient<0>(e) = Mat3<T>::identity();
    return e;
  }
  template <class T> MPMPBD_HD static T compliance(Parameters<T> const& k) { return k.compliance; }
};

}  // namespace mpmpbd
