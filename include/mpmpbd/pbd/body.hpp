// A rod body: constraints and their solver, by role and in any order.
#pragma once

#include <mpmpbd/pbd/project.hpp>
#include <mpmpbd/pbd/solvers/gauss_seidel.hpp>

namespace mpmpbd {

namespace detail {
struct NoConstraints {
  using Role = role::ConstraintSet;
  using List = TypeList<>;
  using InstanceFields = Fields<>;
  static constexpr bool has_frames = false;
};

// Whether solver S takes constraint C: a direct solver says so by `takes<C>`, the others take any.
template <class S, class C>
inline constexpr bool is_taken = [] {
  if constexpr (requires { S::template takes<C>; }) {
    return S::template takes<C>;
  } else {
    return true;
  }
}();
template <class S, class List> inline constexpr bool takes_all = true;
template <class S, class... Cs>
inline constexpr bool takes_all<S, TypeList<Cs...>> = (is_taken<S, Cs> && ...);

template <class S>
inline constexpr bool needs_chain = [] {
  if constexpr (requires { S::needs_chain; }) {
    return S::needs_chain;
  } else {
    return false;
  }
}();
template <class S>
inline constexpr int substeps_of = [] {
  if constexpr (requires { S::substeps; }) {
    return S::substeps;
  } else {
    return 1;
  }
}();

template <class... Ps> struct PbdPolicies {
  template <class Role> static constexpr int count = count_role<Role, Ps...>;
  static_assert(
      count<role::ConstraintSet> > 0,
      "mpmpbd Pbd<...>: no constraints given; add them, for example Pbd<Constraints<Distance, Bend>>");
  static_assert(
      count<role::ConstraintSet> < 2,
      "mpmpbd Pbd<...>: more than one set of constraints given; write all kinds into one Constraints<...>");
  static_assert(
      count<role::Solver> < 2,
      "mpmpbd Pbd<...>: more than one solver given; keep one of them, for example Xpbd<8>");
  static_assert(
      count<role::ConstraintSet> + count<role::Solver> == sizeof...(Ps),
      "mpmpbd Pbd<...>: takes Constraints<...> and a solver; effects, needle and coupling belong to the Scene");

  using Set = pick_t<role::ConstraintSet, NoConstraints, Ps...>;
  using Solver = pick_t<role::Solver, Xpbd<8>, Ps...>;

  static_assert(
      SolverPolicy<Solver>,
      "mpmpbd SolverPolicy: give a name, `static constexpr int iterations` of at least 1, ScratchFields<Set> and `iterate<Set>(team, env, tick, list)`");
  static_assert(
      takes_all<Solver, typename Set::List>,
      "mpmpbd Pbd<...>: DirectBanded solves constraints between neighbours of a thread (Distance, Bend), DirectFrames those of its frames (StretchShear, BendTwist); write Xpbd<8> or Jacobi<20> for the others, or hold a bead by an inverse mass of 0");
};

template <class Out, class List, class Taken> struct Without { using type = Out; };
template <class... Os, class C, class... Cs, class... Ts>
struct Without<TypeList<Os...>, TypeList<C, Cs...>, TypeList<Ts...>>
    : Without<
          std::conditional_t<(std::is_same_v<C, Ts> || ...), TypeList<Os...>, TypeList<Os..., C>>,
          TypeList<Cs...>, TypeList<Ts...>> {};

template <class Solver, class Set, bool = takes_all<Solver, typename Set::List>>
struct SolverScratch {
  using type = typename Solver::template ScratchFields<Set>;
};
template <class Solver, class Set> struct SolverScratch<Solver, Set, false> {
  using type = Fields<>;
};
}  // namespace detail

// The constraints of a list that a coupling does not take.
template <class List, class Taken>
using without_t = typename detail::Without<TypeList<>, List, Taken>::type;

// The threads of an environment. Default solver: Xpbd<8>.
//
// Its functions are stages: they run on a team of lanes (`team.each(n, f)` shares f(0)...f(n-1) among
// the lanes, `team.one(f)` runs f on one, `team.sync()` waits) over one environment (access.hpp) and
// return the faults that this lane met. Order of a substep: predict, solve, finish.
// `Taken` lists constraints that a coupling solves itself and that are left out here.
template <class... Policies> struct Pbd {
  using Role = role::Pbd;
  using Composition = detail::PbdPolicies<Policies...>;
  using Set = typename Composition::Set;
  using Solver = typename Composition::Solver;
  using Leaves = TypeList<Set, Solver>;

  // Substeps that the solver wants per step of a scene that leaves it the choice.
  static constexpr int substeps = detail::substeps_of<Solver>;

  // Whether segments have frames: only when a constraint acts on them.
  static constexpr bool has_frames = Set::has_frames;

  using ScratchFields = union_t<Fields<bead::Previous>,
                                std::conditional_t<has_frames, Fields<frame::Previous>, Fields<>>,
                                typename detail::SolverScratch<Solver, Set>::type>;
  using MovedFields = union_t<
      Fields<bead::Position, bead::Velocity>,
      std::conditional_t<has_frames, Fields<frame::Orientation, frame::AngularVelocity>, Fields<>>>;
  using Reads = union_t<MovedFields, Fields<bead::InverseMass>,
                        std::conditional_t<has_frames, Fields<frame::InverseInertia>, Fields<>>,
                        typename Set::InstanceFields>;
  using Writes = union_t<MovedFields, typename Set::InstanceFields, ScratchFields>;
  using AllFields = union_t<Reads, Writes>;

  // x0 = x, x += dt v, all multipliers 0; frames turn by dt omega.
  template <class Team, class Env, class T>
  MPMPBD_HD static std::uint32_t predict(Team const& team, Env const& env, Tick<T> const& tick) {
    detail::each(team, env.template live<Beads>(), [&](std::int64_t b) {
      auto const x = env.template get<bead::Position>(b);
      env.template set<bead::Previous>(b, x);
      env.template set<bead::Position>(
          b, add_product(x, tick.dt, env.template get<bead::Velocity>(b)));
    });
    if constexpr (has_frames)
      detail::each(team, env.template live<Frames>(), [&](std::int64_t f) {
        auto const q = env.template get<frame::Orientation>(f);
        env.template set<frame::Previous>(f, q);
        auto const turn = tick.dt * env.template get<frame::AngularVelocity>(f);
        if (dot(turn, turn) > T(0))  // one at rest keeps its bits
          env.template set<frame::Orientation>(f, quaternion::turned(q, turn));
      });
    forget(team, env, typename Set::List{});
    team.sync();
    return 0;
  }

  // Moves the beads until the constraints hold, as well as the solver's iterations allow.
  template <class Taken = TypeList<>, class Team, class Env, class T>
  MPMPBD_HD static std::uint32_t solve(Team const& team, Env const& env, Tick<T> const& tick) {
    using Mine = without_t<typename Set::List, Taken>;
    check_solvable(Mine{});
    std::uint32_t faults = 0;
    if constexpr (Mine::size > 0) {
      if constexpr (requires { Solver::template begin<Set>(team, env, tick, Mine{}); })
        faults |= Solver::template begin<Set>(team, env, tick, Mine{});
      for (int i = 0; i < Solver::iterations; ++i)
        faults |= Solver::template iterate<Set>(team, env, tick, Mine{});
      if constexpr (requires { Solver::template end<Set>(team, env, tick, Mine{}); })
        faults |= Solver::template end<Set>(team, env, tick, Mine{});
    }
    return faults;
  }

  // v = (x - x0)/dt of the beads that are free to move, and of frames the turn per dt.
  template <class Team, class Env, class T>
  MPMPBD_HD static std::uint32_t finish(Team const& team, Env const& env, Tick<T> const& tick) {
    detail::each(team, env.template live<Beads>(),
                 [&](std::int64_t b) { set_velocity(env, b, tick); });
    if constexpr (has_frames)
      detail::each(team, env.template live<Frames>(),
                   [&](std::int64_t f) { set_angular_velocity(env, f, tick); });
    team.sync();
    return 0;
  }

  // The same, and x = x0: the constraints have acted as velocity changes, and a coupling moves the beads.
  template <class Team, class Env, class T>
  MPMPBD_HD static std::uint32_t finish_as_velocity(Team const& team, Env const& env,
                                                    Tick<T> const& tick) {
    static_assert(
        !has_frames,
        "mpmpbd Pbd<...>: a coupling moves beads, not the frames of segments (StretchShear, BendTwist); give a thread that is coupled Distance and Bend");
    detail::each(team, env.template live<Beads>(), [&](std::int64_t b) {
      set_velocity(env, b, tick);
      env.template set<bead::Position>(b, env.template get<bead::Previous>(b));
    });
    team.sync();
    return 0;
  }

  // A step of rods alone: `forces(team, env, tick)` changes velocities, then the three stages, once per
  // substep of the solver.
  template <class Team, class Env, class T, class Forces>
  MPMPBD_HD static std::uint32_t step(Team const& team, Env const& env, Tick<T> const& whole,
                                      Forces const& forces) {
    Tick<T> tick = whole;
    tick.dt /= T(substeps), tick.previous_dt /= T(substeps);
    std::uint32_t faults = 0;
    for (int s = 0; s < substeps; ++s) {
      tick.time = whole.time + T(s) * tick.dt;
      forces(team, env, tick);
      faults |= predict(team, env, tick);
      faults |= solve(team, env, tick);
      faults |= finish(team, env, tick);
    }
    return faults;
  }

  // How far constraint C is from its law, max |C + alpha f| over its instances (an inequality: how far
  // it is violated) [unit of C]. For reports and tests; runs on one lane.
  template <class C, class Env> MPMPBD_HD static auto residual(Env const& env) {
    using T = typename Env::Scalar;
    T worst = T(0);
    for (std::int64_t i = 0; i < env.template live<Instances<C>>(); ++i) {
      auto const one = detail::load_instance<C>(env, i);
      auto const sum = one.at.value + detail::scaled(one.compliance, one.multiplier);
      for (int a = 0; a < C::dimension; ++a) {
        worst = max(worst, C::kind == ConstraintKind::inequality ? -sum[a] : abs(sum[a]));
      }
    }
    return worst;
  }

 private:
  template <class... Cs> MPMPBD_HD static constexpr void check_solvable(TypeList<Cs...>) {
    static_assert(
        (acts_on_rod_only<Cs> && ... && true),
        "mpmpbd Pbd<...>: a constraint acts on the needle or on tissue, which the rod's solver cannot move; add a coupling that takes it, for example Coupling<Embedded>");
  }
  template <class Team, class Env, class... Cs>
  MPMPBD_HD static void forget(Team const& team, Env const& env, TypeList<Cs...>) {
    (forget_kind<Cs>(team, env), ...);
  }
  template <class C, class Team, class Env>
  MPMPBD_HD static void forget_kind(Team const& team, Env const& env) {
    detail::each(team, env.template live<Instances<C>>(), [&](std::int64_t i) {
      set_vector<typename instance<C>::Multiplier>(env, i,
                                                   Vec<typename Env::Scalar, C::dimension>{});
    });
  }
  template <class Env, class T>
  MPMPBD_HD static void set_velocity(Env const& env, std::int64_t b, Tick<T> const& tick) {
    if (!(env.template get<bead::InverseMass>(b) > T(0))) return;
    auto const moved = env.template get<bead::Position>(b) - env.template get<bead::Previous>(b);
    env.template set<bead::Velocity>(b, T(1) / tick.dt * moved);
  }
  template <class Env, class T>
  MPMPBD_HD static void set_angular_velocity(Env const& env, std::int64_t f, Tick<T> const& tick) {
    if (!(env.template get<frame::InverseInertia>(f) > T(0))) return;
    auto const turn =
        quaternion::product(env.template get<frame::Orientation>(f),
                            quaternion::conjugate(env.template get<frame::Previous>(f)));
    env.template set<frame::AngularVelocity>(f, T(1) / tick.dt * quaternion::rotation_vector(turn));
  }
};

}  // namespace mpmpbd
