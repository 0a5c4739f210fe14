// The joint between the frames of two segments: bending about two axes, twist about the third.
#pragma once

#include <mpmpbd/pbd/concepts.hpp>

namespace mpmpbd {

// C = (bend_1, bend_2, twist) - rest [rad]. The rotation from frame q1 to frame q2 is a twist about the segment's axis
// d3 and then the shortest rotation that takes d3 of one to d3 of the other (its swing). With the relative
// quaternion p = q1* q2 = (w, x, y, z), w >= 0:
//   twist = 2 atan2(z, w),   bend = 2 atan2(|(x, y)|, |(w, z)|) along (x, y)/|(x, y)|,
// the swing's rotation vector in the axes halfway through the twist. So a bend is the angle between the segments
// up to pi, and twists are those of parallel transport: they add up to link minus writhe, which the Darboux vector
// 2 Im(p) of Kugelstadt and Schoemer (2016) gives for small angles only.
// Compliances l/EI and l/GJ [rad/(N m)]. q and -q are the same frame. f is the moment through the section [N m].
// Limits: a joint counts no turns: its twist lies between -pi and pi and jumps when it passes there, so that a thread
// has to spread its turns over joints; a fold (bend pi) has no twist. A frame without length feels nothing.
struct BendTwist {
  using Role = role::Constraint;
  static constexpr FixedString name = "BendTwist";
  using Unknowns = TypeList<unknown::Orientation, unknown::Orientation>;
  static constexpr int dimension = 3;
  static constexpr ConstraintKind kind = ConstraintKind::equality;
  static constexpr bool frame_invariant = true;
  static constexpr bool own_axes = true;

  template <class T> struct Parameters {
    T rest_bend_1, rest_bend_2;  // [rad]
    T rest_twist;                // [rad]
    T bend_compliance;           // [rad/(N m)]
    T twist_compliance;          // [rad/(N m)]
  };
  static constexpr std::array<ParameterInfo, 5> parameter_info{
      {bound::between("rest_bend_1", "rad", -pi<double>, pi<double>),
       bound::between("rest_bend_2", "rad", -pi<double>, pi<double>),
       bound::between("rest_twist", "rad", -pi<double>, pi<double>),
       bound::not_negative("bend_compliance", "rad/(N m)"),
       bound::not_negative("twist_compliance", "rad/(N m)")}};

  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k) {
    using T = typename X::Scalar;
    Evaluation<BendTwist, T> e{};
    auto const &q1 = get<0>(x), &q2 = get<1>(x);
    if (!quaternion::is_valid(q1) || !quaternion::is_valid(q2)) return e;
    auto const joint = Joint<T>::of(quaternion::product(
        quaternion::conjugate(quaternion::normalised(q1)), quaternion::normalised(q2)));
    e.value = joint.angles() - vec(k.rest_bend_1, k.rest_bend_2, k.rest_twist);
    // A small rotation of the second frame against the first, seen in the first: R1^T (dtheta2 - dtheta1).
    Mat3<T> const to_first = transpose(quaternion::matrix(quaternion::normalised(q1)));
    gradient<1>(e) = joint.slopes() * to_first;
    gradient<0>(e) = -gradient<1>(e);
    return e;
  }
  template <class T> MPMPBD_HD static Vec3<T> compliance(Parameters<T> const& k) {
    return {{k.bend_compliance, k.bend_compliance, k.twist_compliance}};
  }

 private:
  template <class T> struct Joint {
    T w, x, y, z;
    T swing, twist;  // |(x, y)| = sin(bend/2), |(w, z)| = cos(bend/2)

    MPMPBD_HD static Joint of(Quaternion<T> const& p) {
      T const sign = p[0] < T(0) ? T(-1) : T(1);
      Joint j{sign * p[0], sign * p[1], sign * p[2], sign * p[3], T(0), T(0)};
      j.swing = sqrt(square(j.x) + square(j.y));
      j.twist = max(sqrt(square(j.w) + square(j.z)), epsilon<T>);  // a fold: its slopes end here
      return j;
    }
    // The bend angle over |(x, y)|; 2 for a straight joint.
    MPMPBD_HD T bend_per_swing() const {
      return swing > epsilon<T> ? T(2) * atan2(swing, twist) / swing : T(2) / twist;
    }
    MPMPBD_HD Vec3<T> angles() const {
      T const g = bend_per_swing();
      return {{g * x, g * y, T(2) * atan2(z, w)}};
    }
    // Their derivatives by a small rotation of the second frame, in axes of the first: of p it is
    // dp = (-v . r, w r + r x v) / 2 with v = (x, y, z).
    MPMPBD_HD Mat3<T> slopes() const {
      T const g = bend_per_swing();
      // d(g)/d(swing) / swing = (2/twist - g) / swing^2, which tends to 2/3.
      T const h = square(swing) > epsilon<T> ? (T(2) / twist - g) / square(swing) : T(2) / T(3);
      Vec3<T> const dx = T(0.5) * vec(w, z, -y), dy = T(0.5) * vec(-z, w, x);
      Vec3<T> const ds = x * dx + y * dy;  // swing d(swing)
      T const n2 = square(twist);
      Mat3<T> rows{};
      for (int i = 0; i < 3; ++i) {
        rows(0, i) = g * dx[i] + h * x * ds[i];
        rows(1, i) = g * dy[i] + h * y * ds[i];
      }
      rows(2, 0) = (w * y + z * x) / n2;
      rows(2, 1) = (z * y - w * x) / n2;
      rows(2, 2) = (w * w + z * z) / n2;
      return rows;
    }
  };
};

}  // namespace mpmpbd
