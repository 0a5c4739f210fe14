// A constraint that the library does not have.
#pragma once

#include <mpmpbd/pbd/concepts.hpp>

namespace hospital {

// A bead stays within `length` of a place: C = length - |x - p| >= 0 [m].
struct Leash {
  using Role = mpmpbd::role::Constraint;
  static constexpr mpmpbd::FixedString name = "Leash";
  using Unknowns = mpmpbd::TypeList<mpmpbd::unknown::Point>;
  static constexpr int dimension = 1;
  static constexpr auto kind = mpmpbd::ConstraintKind::inequality;

  template <class T> struct Parameters {
    T px, py, pz;  // the place [m]
    T length;      // [m]
    T compliance;  // [m/N]
  };
  static constexpr std::array<mpmpbd::ParameterInfo, 5> parameter_info{
      {mpmpbd::bound::any("px", "m"), mpmpbd::bound::any("py", "m"), mpmpbd::bound::any("pz", "m"),
       mpmpbd::bound::positive("length", "m"), mpmpbd::bound::not_negative("compliance", "m/N")}};

  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k) {
    using T = typename X::Scalar;
    mpmpbd::Evaluation<Leash, T> e;
    auto const d = get<0>(x) - mpmpbd::vec(k.px, k.py, k.pz);
    e.value[0] = k.length - norm(d);
    gradient<0>(e) = transpose(-direction(d));
    return e;
  }
  template <class T> MPMPBD_HD static T compliance(Parameters<T> const& k) { return k.compliance; }
};

}  // namespace hospital
