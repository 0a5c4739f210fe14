// A bead tied to a place in the tissue.
#pragma once

#include <mpmpbd/pbd/concepts.hpp>

namespace mpmpbd {

// C = x - y [m], y the tissue point. Solved by a coupling, which knows the tissue.
struct Attachment {
  using Role = role::Constraint;
  static constexpr FixedString name = "Attachment";
  using Unknowns = TypeList<unknown::Point, unknown::TissuePoint>;
  static constexpr int dimension = 3;
  static constexpr ConstraintKind kind = ConstraintKind::equality;
  static constexpr bool frame_invariant = true;

  template <class T> struct Parameters {
    T compliance;  // [m/N]
  };
  static constexpr std::array<ParameterInfo, 1> parameter_info{
      {bound::not_negative("compliance", "m/N")}};

  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const&) {
    using T = typename X::Scalar;
    Evaluation<Attachment, T> e;
    e.value = get<0>(x) - get<1>(x);
    gradient<0>(e) = Mat3<T>::identity();
    gradient<1>(e) = -Mat3<T>::identity();
    return e;
  }
  template <class T> MPMPBD_HD static T compliance(Parameters<T> const& k) { return k.compliance; }
};

}  // namespace mpmpbd
