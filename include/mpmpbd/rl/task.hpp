// A task is a type, too: a scene, and what an agent does in it, sees of it and is paid for.
//
//   struct Reach : rl::Task<Suturing, MoveNeedle, NeedlePose, Distance, Arrived> {
//     using Config = ...;                              // settings, with a member `episode` (rl/episode.hpp)
//     static SimulationOptions options(Config const&, std::int64_t environments);
//     static double step_time(Config const&);          // of one step of the scene [s]
//     template <class Sim> static void set_up(Sim&, std::int64_t env, Config const&);  // before randomisation
//   };
//
// Its parts are policies as those of a scene: stateless, with a role, a name, `Reads`, `Writes`
// and, where they have numbers, `Parameters`. What they remember are fields, so it is saved, cloned
// and reset with everything else. All see one environment: env.get<Field>(slot),
// env.set<Field>(slot, value), and their numbers: context.of<Policy>().
#pragma once

#include <mpmpbd/pbd/fields.hpp>
#include <mpmpbd/rl/random.hpp>
#include <mpmpbd/scene/scene.hpp>

namespace mpmpbd {

namespace role {
// What the agent does: `size` numbers in [-1, 1] per decision. apply(env, context, action, h)
// before every step of h [s].
struct Action {
  static constexpr FixedString name = "Action";
};
// What a task remembers: begin(env, context) of an episode, decide(env, context) before a decision,
// advance(env, context) after every step. In the order of the task.
struct Progress {
  static constexpr FixedString name = "Progress";
};
// A group of numbers that the agent sees: `size` of them, or as many for every slot of the domain
// `Each`. observe(env, context, out).
struct Observation {
  static constexpr FixedString name = "Observation";
};
// A part of the reward of a decision, weight included: value(env, context).
struct RewardTerm {
  static constexpr FixedString name = "RewardTerm";
};
// Ends an episode: holds(env, context).
struct Termination {
  static constexpr FixedString name = "Termination";
};
// Changes an environment that has been reset: apply(env, context, random). In the order of the task.
struct Randomisation {
  static constexpr FixedString name = "Randomisation";
};
// A number to judge an episode by, which is no reward: value(env, context).
struct Metric {
  static constexpr FixedString name = "Metric";
};
}  // namespace role

namespace rl {

// What every episode remembers.
namespace episode {
struct Decisions : Field<"decisions", "1", Integer, Environments> {};  // since its start
struct Ended : Field<"ended", "1", Integer, Environments> {};          // waits for a reset
struct Stream : Field<"stream", "1", Integer, Environments> {};        // of random numbers
// Sums of the reward terms, in the order of the task.
template <int terms> struct Returns : Field<"returns", "1", numbers_t<terms>, Environments> {};
}  // namespace episode

namespace detail {

template <class List> struct Lists;
template <class... Ps> struct Lists<TypeList<Ps...>> {
  using Reads = union_t<Fields<>, typename Ps::Reads...>;
  using Writes = union_t<Fields<>, typename Ps::Writes...>;
};

// The parts that leave something to store: what they remember, or their numbers. Tasks that differ
// in what is seen only have the same scene, so it is compiled once.
template <class P>
inline constexpr bool leaves_something =
    !std::is_same_v<typename P::Writes, Fields<>> || (parameter_count<P> > 0);
template <class... Ps>
using stored_parts_t =
    join_t<TypeList<>, std::conditional_t<leaves_something<Ps>, TypeList<Ps>, TypeList<>>...>;

// A scene that also stores what its task remembers and the numbers of the task's policies.
template <class Scene_, int terms, class Parts> struct SceneOfTask;
template <class Scene_, int terms, class... Parts>
struct SceneOfTask<Scene_, terms, TypeList<Parts...>> : Scene_ {
  using Policies = join_t<typename Scene_::Policies, TypeList<Parts...>>;
  using Memory =
      union_t<Fields<episode::Decisions, episode::Ended, episode::Stream, episode::Returns<terms>>,
              typename Lists<TypeList<Parts...>>::Writes>;
  using StateFields =
      union_t<typename Scene_::StateFields,
              typename mpmpbd::detail::ParameterFields<TypeList<Parts...>>::type, Memory>;
};

template <class P, class... Roles>
inline constexpr bool has_one_of = (std::is_same_v<typename P::Role, Roles> || ...);
template <class P>
inline constexpr bool is_part =
    has_one_of<P, role::Action, role::Progress, role::Observation, role::RewardTerm,
               role::Termination, role::Randomisation, role::Metric>;

template <class List> inline constexpr bool names_differ = true;
template <class P, class... Ps>
inline constexpr bool names_differ<TypeList<P, Ps...>> =
    ((P::name.view() != Ps::name.view()) && ...) && names_differ<TypeList<Ps...>>;

template <class Reads, class StateFields> inline constexpr bool all_stored = false;
template <class... Fs, class StateFields>
inline constexpr bool all_stored<Fields<Fs...>, StateFields> = (contains<StateFields, Fs> && ...);

}  // namespace detail

template <class Scene_, class... Parts> struct Task {
  using Composition = Task;  // the parts alone, without the settings of a task that is made of them
  template <class Role> using With = of_role_t<Role, Parts...>;
  using Actions = With<role::Action>;
  using Progress = With<role::Progress>;
  using Observations = With<role::Observation>;
  using Rewards = With<role::RewardTerm>;
  using Terminations = With<role::Termination>;
  using Randomisations = With<role::Randomisation>;
  using Metrics = With<role::Metric>;

  static_assert((detail::is_part<Parts> && ...),
                "mpmpbd Task<...>: a part is none of Action, Progress, Observation, RewardTerm, "
                "Termination, Randomisation and Metric; effects, materials and the like belong "
                "into the scene");
  static_assert(detail::names_differ<Observations> && detail::names_differ<Rewards> &&
                    detail::names_differ<Metrics>,
                "mpmpbd Task<...>: two observation groups, reward terms or metrics have the same "
                "name, by which they are logged; rename one");
  static_assert(Actions::size == 1,
                "mpmpbd Task<...>: a task has exactly one Action, which says what the agent's "
                "numbers do; add one, or join them into one policy");
  static_assert(Observations::size > 0,
                "mpmpbd Task<...>: no Observation given, so the agent would see nothing; add a "
                "group, for example NeedlePose");
  static_assert(Rewards::size > 0,
                "mpmpbd Task<...>: no RewardTerm given, so nothing could be learnt; add one");

  using Action = pick_t<role::Action, void, Parts...>;
  using Returns = episode::Returns<Rewards::size>;
  using Scene = detail::SceneOfTask<Scene_, Rewards::size, detail::stored_parts_t<Parts...>>;

  static_assert(
      detail::all_stored<typename detail::Lists<TypeList<Parts...>>::Reads,
                         typename Scene::StateFields>,
      "mpmpbd Task<...>: a part reads a field that neither its scene stores nor another part "
      "writes; name a scene that has it, or add the part that writes it");
};

}  // namespace rl

}  // namespace mpmpbd
