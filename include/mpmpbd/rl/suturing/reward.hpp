// The reward of a stitch, term by term. What is paid for every decision is paid in the phase in
// which the decision began; what is paid for a milestone, in the decision that reached it.
//
// After the reference system (three phases: insertion, driving, extraction), with the turn towards
// the exit rewarded where its text and its formula disagree (docs/concepts/suturing_task.md).
#pragma once

#include <mpmpbd/rl/suturing/progress.hpp>

namespace mpmpbd::rl {

namespace detail {
// What all terms have: one number, their weight.
template <class Term> struct StitchTerm {
  using Role = role::RewardTerm;
  using Reads = union_t<StitchProgress::Reads, stitch::Memory>;
  using Writes = Fields<>;
  template <class T> struct Parameters { T weight; };
  static constexpr ParameterInfo parameter_info[] = {bound::not_negative("weight", "1")};

  template <class Env, class Ctx> MPMPBD_HD static auto value(Env const& env, Ctx const& context) {
    using T = typename Env::Scalar;
    T const weight = context.template of<Term>().weight;
    return stitch::phase_before(env) == Term::phase ? weight * T(Term::amount(env, context)) : T(0);
  }
  template <class Env, class Ctx>
  MPMPBD_HD static auto distance(Env const& env, Ctx const& context, stitch::Marker which) {
    return norm(stitch::tip_position(env, context) - stitch::marker_position(env, which));
  }
};
// 1 in the decision that reaches a milestone.
template <class Term, stitch::Milestone milestone> struct StitchBonus : StitchTerm<Term> {
  template <class Env, class Ctx> MPMPBD_HD static auto value(Env const& env, Ctx const& context) {
    using T = typename Env::Scalar;
    return stitch::has_just(env, milestone) ? T(context.template of<Term>().weight) : T(0);
  }
};
}  // namespace detail

// - d_entry: from the tip to the entry marker [m].
struct EntryDistance : detail::StitchTerm<EntryDistance> {
  static constexpr FixedString name = "entry_distance";
  static constexpr auto phase = StitchPhase::insertion;
  template <class Env, class Ctx> MPMPBD_HD static auto amount(Env const& env, Ctx const& context) {
    return -distance(env, context, stitch::entry);
  }
};
// 1 when the tip has gone in at the entry marker.
struct EntryReached : detail::StitchBonus<EntryReached, stitch::entered> {
  static constexpr FixedString name = "entry_reached";
};
// How far the needle has turned round towards the exit in this decision [rad].
struct TurnTowardsExit : detail::StitchTerm<TurnTowardsExit> {
  static constexpr FixedString name = "turn_towards_exit";
  static constexpr auto phase = StitchPhase::driving;
  template <class Env, class Ctx> MPMPBD_HD static auto amount(Env const& env, Ctx const&) {
    return env.template get<stitch::Angle>(0) - env.template get<stitch::AngleBefore>(0);
  }
};
// 1 / d_exit: from the tip to the exit marker [1/m], at most 1 / `least`.
struct ExitCloseness : detail::StitchTerm<ExitCloseness> {
  static constexpr FixedString name = "exit_closeness";
  static constexpr auto phase = StitchPhase::driving;
  template <class T> struct Parameters {
    T weight;
    T least;  // [m]
  };
  static constexpr ParameterInfo parameter_info[] = {bound::not_negative("weight", "m"),
                                                     bound::positive("least", "m")};
  template <class Env, class Ctx> MPMPBD_HD static auto amount(Env const& env, Ctx const& context) {
    return 1 /
           max(distance(env, context, stitch::exit), context.template of<ExitCloseness>().least);
  }
};
// 1 when the tip has come out at the exit marker.
struct ExitReached : detail::StitchBonus<ExitReached, stitch::came_out> {
  static constexpr FixedString name = "exit_reached";
};
// - |v_trans|: how far the arc's centre has moved in this decision [m]; a needle that only turns
// follows itself.
struct CentreMotion : detail::StitchTerm<CentreMotion> {
  static constexpr FixedString name = "centre_motion";
  static constexpr auto phase = StitchPhase::driving;
  template <class Env, class Ctx> MPMPBD_HD static auto amount(Env const& env, Ctx const&) {
    return -norm(stitch::needle_pose(env).position - env.template get<stitch::CentreBefore>(0));
  }
};
// 1 when enough of the needle is out.
struct StitchFinished : detail::StitchBonus<StitchFinished, stitch::done> {
  static constexpr FixedString name = "finished";
};

}  // namespace mpmpbd::rl
