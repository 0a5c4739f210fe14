// The end of a thread tied to the needle.
#pragma once

#include <mpmpbd/pbd/concepts.hpp>

namespace mpmpbd {

// C = x - (c + R r) [m]: r is the place of the tie in the needle's own axes. By the needle's rotation
// vector w, d(R r) = w x R r, so its block is (-I, skew(R r)). Solved by a coupling, which moves the needle.
struct Swage {
  using Role = role::Constraint;
  static constexpr FixedString name = "Swage";
  using Unknowns = TypeList<unknown::Point, unknown::RigidBody>;
  static constexpr int dimension = 3;
  static constexpr ConstraintKind kind = ConstraintKind::equality;
  static constexpr bool frame_invariant = true;

  template <class T> struct Parameters {
    T x, y, z;     // the tie in body axes [m]
    T compliance;  // [m/N]
  };
  static constexpr std::array<ParameterInfo, 4> parameter_info{
      {bound::any("x", "m"), bound::any("y", "m"), bound::any("z", "m"),
       bound::not_negative("compliance", "m/N")}};

  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k) {
    using T = typename X::Scalar;
    Evaluation<Swage, T> e{};
    auto const& body = get<1>(x);
    Vec3<T> const arm = quaternion::rotate(body.orientation, vec(k.x, k.y, k.z));
    e.value = get<0>(x) - (body.position + arm);
    gradient<0>(e) = Mat3<T>::identity();
    Mat3<T> const turn = skew(arm);
    for (int i = 0; i < 3; ++i) {
      gradient<1>(e)(i, i) = T(-1);
      for (int j = 0; j < 3; ++j) gradient<1>(e)(i, 3 + j) = turn(i, j);
    }
    return e;
  }
  template <class T> MPMPBD_HD static T compliance(Parameters<T> const& k) { return k.compliance; }
};

}  // namespace mpmpbd
