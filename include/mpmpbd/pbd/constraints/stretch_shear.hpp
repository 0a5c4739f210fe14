// A segment of a thread against its frame: stretch along it, shear across.
#pragma once

#include <mpmpbd/pbd/concepts.hpp>

namespace mpmpbd {

// C = R^T (b - a) - (0, 0, l) [m] in the axes of the segment's frame q (R turns its axes into world axes, the
// third one lies along the segment): two numbers of shear, one of stretch. Kugelstadt and Schoemer 2016,
// times l, so that f is the force through the section [N]; a stretched segment has f < 0 along d3.
// Compliances l/(k G A) across and l/EA along [m/N]. A frame without length feels nothing and asks for nothing.
struct StretchShear {
  using Role = role::Constraint;
  static constexpr FixedString name = "StretchShear";
  using Unknowns = TypeList<unknown::Point, unknown::Point, unknown::Orientation>;
  static constexpr int dimension = 3;
  static constexpr ConstraintKind kind = ConstraintKind::equality;
  static constexpr bool frame_invariant = true;
  static constexpr bool own_axes = true;

  template <class T> struct Parameters {
    T rest_length;         // [m]
    T stretch_compliance;  // [m/N]
    T shear_compliance;    // [m/N]
  };
  static constexpr std::array<ParameterInfo, 3> parameter_info{
      {bound::positive("rest_length", "m"), bound::not_negative("stretch_compliance", "m/N"),
       bound::not_negative("shear_compliance", "m/N")}};

  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k) {
    using T = typename X::Scalar;
    Evaluation<StretchShear, T> e{};
    if (!quaternion::is_valid(get<2>(x))) return e;
    Mat3<T> const to_frame = transpose(quaternion::matrix(quaternion::normalised(get<2>(x))));
    Vec3<T> const d = get<1>(x) - get<0>(x);
    e.value = to_frame * d - vec(T(0), T(0), k.rest_length);
    gradient<0>(e) = -to_frame;
    gradient<1>(e) = to_frame;
    gradient<2>(e) = to_frame * skew(d);
    return e;
  }
  template <class T> MPMPBD_HD static Vec3<T> compliance(Parameters<T> const& k) {
    return {{k.shear_compliance, k.shear_compliance, k.stretch_compliance}};
  }
};

}  // namespace mpmpbd
