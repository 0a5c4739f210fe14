// A bead that stays on one side of a plane.
#pragma once

#include <mpmpbd/pbd/concepts.hpp>

namespace mpmpbd {

// C = n . x - offset [m] >= 0 with the direction n of (nx, ny, nz), which need not have length 1.
// Limits: no friction; a plane without a direction does nothing.
struct HalfSpace {
  using Role = role::Constraint;
  static constexpr FixedString name = "HalfSpace";
  using Unknowns = TypeList<unknown::Point>;
  static constexpr int dimension = 1;
  static constexpr ConstraintKind kind = ConstraintKind::inequality;

  template <class T> struct Parameters {
    T nx, ny, nz;  // outward normal of the forbidden side
    T offset;      // [m], of the plane from the origin along n
    T compliance;  // [m/N]
  };
  static constexpr std::array<ParameterInfo, 5> parameter_info{
      {bound::any("nx", "1"), bound::any("ny", "1"), bound::any("nz", "1"),
       bound::any("offset", "m"), bound::not_negative("compliance", "m/N")}};

  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k) {
    using T = typename X::Scalar;
    Evaluation<HalfSpace, T> e;
    Vec3<T> const n = direction(vec(k.nx, k.ny, k.nz));
    e.value[0] = dot(n, get<0>(x)) - k.offset;
    gradient<0>(e) = transpose(n);
    return e;
  }
  template <class T> MPMPBD_HD static T compliance(Parameters<T> const& k) { return k.compliance; }
};

}  // namespace mpmpbd
