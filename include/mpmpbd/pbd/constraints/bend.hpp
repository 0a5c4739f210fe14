// The angle of a thread at a bead.
#pragma once

#include <mpmpbd/pbd/concepts.hpp>

namespace mpmpbd {

// C = turn - rest_turn [rad], turn = atan2(|d1 x d2|, d1 . d2) between the segments d1 = b - a and
// d2 = c - b: 0 for a straight thread, pi when folded. The angle theta seen from the middle bead is
// pi - turn; the turn itself is kept, because near pi a float has no room for a small deviation.
// Compliance l/EI [rad/(N m)] makes it a beam. Mueller et al. 2007, section 4.2, with atan2 for acos.
// Limits: a segment of (nearly) no length has no direction and gives C = 0; the rest shape is an
// angle, not a direction: the plane of bending is free.
struct Bend {
  using Role = role::Constraint;
  static constexpr FixedString name = "Bend";
  using Unknowns = TypeList<unknown::Point, unknown::Point, unknown::Point>;
  static constexpr int dimension = 1;
  static constexpr ConstraintKind kind = ConstraintKind::equality;
  static constexpr bool along_chain = true;
  static constexpr bool frame_invariant = true;

  template <class T> struct Parameters {
    T rest_turn;   // [rad], in [0, pi]
    T compliance;  // [rad/(N m)]
  };
  static constexpr std::array<ParameterInfo, 2> parameter_info{
      {bound::between("rest_turn", "rad", 0.0, pi<double>),
       bound::not_negative("compliance", "rad/(N m)")}};

  // The rest turn of a joint whose rest angle, seen from the middle bead, is theta [rad] (pi: straight).
  template <class T> MPMPBD_HD static T turn_of(T theta) { return pi<T> - theta; }

  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k) {
    using T = typename X::Scalar;
    Evaluation<Bend, T> e{};
    Vec3<T> const d1 = get<1>(x) - get<0>(x);
    Vec3<T> const d2 = get<2>(x) - get<1>(x);
    T const l1 = norm(d1), l2 = norm(d2);
    if (!(l1 > epsilon<T> * l2 && l2 > epsilon<T> * l1)) return e;
    Vec3<T> const t1 = T(1) / l1 * d1, t2 = T(1) / l2 * d2;
    Vec3<T> const across = cross(t1, t2);
    T const sine = norm(across), cosine = dot(t1, t2);
    e.value[0] = atan2(sine, cosine) - k.rest_turn;
    // Exactly straight or folded, every direction across is as good as another: take a fixed one.
    Vec3<T> const n = sine > epsilon<T> ? T(1) / sine * across : any_across(t1);
    Vec3<T> const by_d1 = -(T(1) / l1) * cross(n, t1);
    Vec3<T> const by_d2 = T(1) / l2 * cross(n, t2);
    gradient<0>(e) = transpose(-by_d1);
    gradient<1>(e) = transpose(by_d1 - by_d2);
    gradient<2>(e) = transpose(by_d2);
    return e;
  }
  // How a bent joint resists when its plane turns, which the angle alone does not show: the gradient of the
  // turn out of the plane, and (as value) that stiffness as a part of 1/compliance. A straight joint is as
  // stiff across as along.
  template <class X, class K> MPMPBD_HD static auto across(X const& x, K const& k) {
    using T = typename X::Scalar;
    Evaluation<Bend, T> e{};
    Vec3<T> const d1 = get<1>(x) - get<0>(x);
    Vec3<T> const d2 = get<2>(x) - get<1>(x);
    T const l1 = norm(d1), l2 = norm(d2);
    if (!(l1 > epsilon<T> * l2 && l2 > epsilon<T> * l1)) return e;
    Vec3<T> const t1 = T(1) / l1 * d1, t2 = T(1) / l2 * d2;
    Vec3<T> const normal = cross(t1, t2);
    T const sine = norm(normal), turn = atan2(sine, dot(t1, t2));
    Vec3<T> const n = sine > epsilon<T> ? T(1) / sine * normal : any_across(t1);
    e.value[0] = k.rest_turn > T(0) ? max(T(0), T(1) - k.rest_turn / turn) : T(1);
    gradient<0>(e) = transpose(T(1) / l1 * n);
    gradient<1>(e) = transpose(-(T(1) / l1 + T(1) / l2) * n);
    gradient<2>(e) = transpose(T(1) / l2 * n);
    return e;
  }
  template <class T> MPMPBD_HD static T compliance(Parameters<T> const& k) { return k.compliance; }
};

}  // namespace mpmpbd
