// What one environment goes through between two steps of its scene: the same text for every back end.
#pragma once

#include <mpmpbd/pbd/fields.hpp>
#include <mpmpbd/rl/observations.hpp>
#include <mpmpbd/rl/outcome.hpp>
#include <mpmpbd/rl/task.hpp>

namespace mpmpbd::rl {

// What happens to an environment whose episode has ended.
enum class Autoreset {
  same_step,  // it starts anew within the step; the last observation is in `final_observation`
  next_step,  // it starts anew in the next step, whose action is ignored and pays nothing
  disabled,   // it stands still until reset(mask)
};

// Faults with which an episode does not go on: its numbers are lost, or no longer those of the scene.
inline constexpr std::uint32_t fatal_faults =
    Fault::not_finite | Fault::inversion | static_cast<std::uint32_t>(Fault::solver);

// What all episodes of a run have in common.
struct EpisodeRules {
  std::int64_t seed, first_environment;
  std::int64_t limit;  // decisions
  Autoreset autoreset;
};

// An episode that is to begin: its number, counted from 1, and the environment whose it is, by its
// number in the larger set: that is what is recorded of an episode.
struct Beginning {
  std::int64_t episode = 0;  // 0: none begins
  std::int64_t as = 0;
};

// Env: an environment's fields (pbd/access.hpp). One lane calls. Who is told to begin an episode first puts the
// environment back to the remembered state, and makes this anew.
template <class Task, class Env> struct EpisodeControl {
  using T = typename Env::Scalar;
  Env fields;
  Lattice<T> lattice;
  std::int64_t env;  // its number
  EpisodeRules rules;
  OutcomeArrays out;
  detail::GroupViews<typename Task::Observations> groups;

  // Before a decision: forgets what the last one came to, and says whether it acts.
  MPMPBD_HD Beginning decide(float const* action, unsigned char& acts) const {
    out.clear(env);
    acts = 0;
    if (waits()) {
      if (rules.autoreset != Autoreset::next_step) return {};
      out.restarted[env] = 1;
      return next();
    }
    bool legal = true;
    for (int a = 0; a < Task::Action::size; ++a)
      legal = legal && action[a] >= -1.0f && action[a] <= 1.0f;
    out.invalid_action[env] = out.truncated[env] = !legal;
    if (!legal) return {};
    acts = 1;
    tell_decision(typename Task::Progress{});
    return {};
  }
  // Before and after every step of h [s].
  MPMPBD_HD void apply(float const* action, double h) const {
    Task::Action::apply(fields, context(), action, h);
  }
  MPMPBD_HD void advance() const { tell_step(typename Task::Progress{}); }
  // What came of the decision; then, where the episode has ended, the next one.
  MPMPBD_HD Beginning finish(bool acts) const {
    if (acts) judge(observe());
    report();
    if (!out.done(env)) return {};
    fields.template set<episode::Ended>(0, 1);
    if (rules.autoreset != Autoreset::same_step) return {};
    groups.keep(env);
    return next();
  }
  // An episode, in an environment that has been put back.
  MPMPBD_HD void begin(Beginning const& it) const {
    fields.template set<environment::Episode>(0, it.episode);
    fields.template set<environment::Seed>(0, rules.seed);
    fields.template set<episode::Stream>(0, it.as);
    Random random(rules.seed, it.as, it.episode);
    randomise(random, typename Task::Randomisations{});
    tell_beginning(typename Task::Progress{});
    observe();
    groups.repeat(env);
  }
  // The one after the present one.
  MPMPBD_HD Beginning next() const { return own(fields.template get<environment::Episode>(0) + 1); }
  // One that is this environment's.
  MPMPBD_HD Beginning own(std::int64_t episode) const {
    return {episode, rules.first_environment + env};
  }

  // What the episode has come to so far.
  MPMPBD_HD void report() const {
    out.status[env] = status();
    out.episode_length[env] = static_cast<std::int32_t>(decisions());
    auto const sums = get_vector<typename Task::Returns>(fields, 0);
    for (int k = 0; k < out.term_count; ++k)
      out.returns[env * out.term_count + k] = static_cast<float>(sums[k]);
    measure(out.metrics + env * out.metric_count, typename Task::Metrics{});
  }

 private:
  MPMPBD_HD auto context() const {
    return load_context<typename Task::Scene::Policies>(fields, lattice);
  }
  MPMPBD_HD std::int64_t decisions() const { return fields.template get<episode::Decisions>(0); }
  MPMPBD_HD bool waits() const { return fields.template get<episode::Ended>(0) != 0; }
  MPMPBD_HD std::uint32_t status() const {
    return static_cast<std::uint32_t>(fields.template get<environment::Status>(0));
  }

  // What the task remembers is told of the scene: at the start, before a decision, after a step.
  template <class... Ps> MPMPBD_HD void tell_beginning(TypeList<Ps...>) const {
    [[maybe_unused]] auto const now = context();
    (Ps::begin(fields, now), ...);
  }
  template <class... Ps> MPMPBD_HD void tell_decision(TypeList<Ps...>) const {
    [[maybe_unused]] auto const now = context();
    (Ps::decide(fields, now), ...);
  }
  template <class... Ps> MPMPBD_HD void tell_step(TypeList<Ps...>) const {
    [[maybe_unused]] auto const now = context();
    (Ps::advance(fields, now), ...);
  }
  // Each sees what the one before has changed.
  template <class... Ps>
  MPMPBD_HD void randomise([[maybe_unused]] Random& random, TypeList<Ps...>) const {
    (Ps::apply(fields, context(), random), ...);
  }
  // Takes a new frame of every group; returns whether all numbers in them are finite.
  MPMPBD_HD bool observe() const { return groups.observe(env, fields, context()); }

  // Rewards and ends of a decision.
  MPMPBD_HD void judge(bool seen_whole) const {
    fields.template set<episode::Decisions>(0, decisions() + 1);
    auto const now = context();
    bool const whole = seen_whole && (status() & fatal_faults) == 0;
    if (!whole || !pay(now, typename Task::Rewards{})) return lose();
    bool const over = has_ended(now, typename Task::Terminations{});
    out.terminated[env] = over;
    out.truncated[env] = !over && decisions() >= rules.limit;
  }
  template <class Ctx, class... Ps>
  MPMPBD_HD bool has_ended([[maybe_unused]] Ctx const& now, TypeList<Ps...>) const {
    return (Ps::holds(fields, now) | ... | false);
  }
  MPMPBD_HD void lose() const {
    if ((status() & fatal_faults) == 0)
      fields.template set<environment::Status>(
          0, static_cast<std::int64_t>(status() | static_cast<std::uint32_t>(Fault::not_finite)));
    out.lose(env);
  }
  // Returns false, and pays nothing, where a term is not finite.
  template <class Ctx, class... Rs> MPMPBD_HD bool pay(Ctx const& now, TypeList<Rs...>) const {
    using Returns = typename Task::Returns;
    constexpr int count = sizeof...(Rs);
    Vec<T, count> const terms{{static_cast<T>(Rs::value(fields, now))...}};
    if (!is_finite(terms)) return false;
    set_vector<Returns>(fields, 0, get_vector<Returns>(fields, 0) + terms);
    for (int k = 0; k < count; ++k) {
      auto const term = static_cast<float>(terms[k]);
      out.terms[env * count + k] = term;
      out.reward[env] += term;
    }
    return true;
  }
  template <class... Ms> MPMPBD_HD void measure([[maybe_unused]] float* to, TypeList<Ms...>) const {
    [[maybe_unused]] auto const now = context();
    ((*to++ = finite(static_cast<float>(Ms::value(fields, now)))), ...);
  }
  static MPMPBD_HD float finite(float value) { return value - value == 0 ? value : 0.0f; }
};

}  // namespace mpmpbd::rl
