// What a constraint has to give, and nothing else: multipliers, weights and dt belong to the solver.
//
// Checked at one door, where a rod is composed: one requirement, one sentence.
#pragma once

#include <array>

#include <mpmpbd/core/parameters.hpp>
#include <mpmpbd/mpm/concepts.hpp>
#include <mpmpbd/pbd/unknowns.hpp>

namespace mpmpbd {

// C = 0, or C >= 0: an inequality only pushes, towards larger C.
enum class ConstraintKind { equality, inequality };

// The values that constraint C is evaluated at, and its result.
template <class C, class T> using ValuesOf = Values<T, typename C::Unknowns>;
template <class C, class T> using Evaluation = EvaluationOf<T, C::dimension, typename C::Unknowns>;

// How many beads a constraint acts on.
template <class C>
inline constexpr int point_count = count_unknowns<unknown::Point, typename C::Unknowns>;
// How many frames of segments.
template <class C>
inline constexpr int frame_count = count_unknowns<unknown::Orientation, typename C::Unknowns>;
// Whether it acts on beads alone, or on beads and frames, so that a rod's own solver can solve it.
template <class C> inline constexpr bool acts_on_points_only = point_count<C> == C::Unknowns::size;
template <class C>
inline constexpr bool acts_on_rod_only = point_count<C> + frame_count<C> == C::Unknowns::size;

// Optional: a constraint between k beads that follow each other on a thread (for direct solvers).
template <class C>
inline constexpr bool is_along_chain = [] {
  if constexpr (requires { C::along_chain; }) {
    return C::along_chain && acts_on_points_only<C> && C::dimension == 1 &&
           C::kind == ConstraintKind::equality;
  } else {
    return false;
  }
}();
// Optional: C is the length of a segment against another one, so that f < 0 is a tension along it.
template <class C>
inline constexpr bool is_length = [] {
  if constexpr (requires { C::measures_length; }) {
    return C::measures_length && is_along_chain<C> && point_count<C> == 2;
  } else {
    return false;
  }
}();
// Optional: C does not change when all unknowns move together as a rigid body.
template <class C>
inline constexpr bool is_frame_invariant = [] {
  if constexpr (requires { C::frame_invariant; }) {
    return C::frame_invariant;
  } else {
    return false;
  }
}();

// Optional: the numbers of C are components along axes that turn with its unknowns.
template <class C>
inline constexpr bool has_own_axes = [] {
  if constexpr (requires { C::own_axes; }) {
    return C::own_axes;
  } else {
    return false;
  }
}();

template <class C> concept NamesUnknowns = requires {
  { C::Unknowns::size } -> std::convertible_to<int>;
}
&&(C::Unknowns::size > 0);
template <class C> concept HasDimension = requires {
  { C::dimension } -> std::convertible_to<int>;
}
&&(C::dimension >= 1 && C::dimension <= 3);
template <class C> concept HasKind = requires {
  { C::kind } -> std::convertible_to<ConstraintKind>;
};
template <class C>
concept EvaluatesConstraint = requires(ValuesOf<C, float> const& x,
                                       parameters_t<C, float> const& k) {
  { C::evaluate(x, k) } -> std::same_as<Evaluation<C, float>>;
}
&&requires(ValuesOf<C, double> const& x, parameters_t<C, double> const& k) {
  { C::evaluate(x, k) } -> std::same_as<Evaluation<C, double>>;
};
// What C::compliance gives: a T, or a Vec<T, dimension>.
template <class C, class T>
using compliance_t = decltype(C::compliance(std::declval<parameters_t<C, T> const&>()));
template <class C, class A>
concept IsCompliance = std::same_as<A, float> ||
    (C::dimension > 1 && std::same_as<A, Vec<float, C::dimension>>);
template <class C> concept HasCompliance = requires(parameters_t<C, float> const& k) {
  requires IsCompliance<C, decltype(C::compliance(k))>;
};

// Static functions, float and double, host and device:
//   evaluate(x, k) -> Evaluation<C, T>: value C and one gradient block per unknown, finite at any x;
//   compliance(k) -> T: alpha in energy C^2 / (2 alpha), 0 = rigid. [m^2/J] for lengths, [rad^2/J] for angles.
//   A C of several numbers may give each its own, as Vec<T, dimension>.
template <class C>
concept Constraint = HasRole<C, role::Constraint> && HasName<C> && NamesUnknowns<C> &&
    HasDimension<C> && HasKind<C> && EvaluatesConstraint<C> && HasCompliance<C>;

template <class C> consteval bool check_constraint() {
  static_assert(
      HasRole<C, role::Constraint>,
      "mpmpbd Constraints<...>: takes constraints only, for example Constraints<Distance, Bend>; a constraint says `using Role = role::Constraint;`");
  static_assert(
      HasName<C>,
      "mpmpbd Constraint: give it a name: `static constexpr FixedString name = \"...\";`");
  static_assert(
      NamesUnknowns<C>,
      "mpmpbd Constraint: say what it acts on, for example `using Unknowns = TypeList<unknown::Point, unknown::Point>;`");
  static_assert(
      HasDimension<C>,
      "mpmpbd Constraint: say how many numbers C has: `static constexpr int dimension = 1;` (1, 2 or 3)");
  static_assert(
      HasKind<C>,
      "mpmpbd Constraint: say whether C = 0 or C >= 0: `static constexpr ConstraintKind kind = ConstraintKind::equality;`");
  if constexpr (NamesUnknowns<C> && HasDimension<C>) {
    static_assert(
        EvaluatesConstraint<C>,
        "mpmpbd Constraint: give C and its gradients: `template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k)` returning Evaluation<YourConstraint, typename X::Scalar>");
  }
  static_assert(
      HasCompliance<C>,
      "mpmpbd Constraint: give its compliance alpha (energy C^2 / (2 alpha), 0 is rigid): `template <class T> MPMPBD_HD static T compliance(Parameters<T> const& k)`");
  return HasName<C>;
}

// A solver moves beads until the constraints hold. `iterate<Set>(team, env, tick, TypeList<Cs...>{})` is one
// iteration over the constraints it is given; `iterations` of them make a solve. `ScratchFields<Set>` lists
// fields that it needs beside those of the rod. Optional: `begin` and `end` of a solve, `substeps`.
template <class S> concept SolverPolicy = HasRole<S, role::Solver> && HasName<S> && requires {
  { S::iterations } -> std::convertible_to<int>;
} &&(S::iterations >= 1);

}  // namespace mpmpbd
