// The step loop: N environments of a task, that equal N separate runs, bit for bit.
//
//   rl::VectorEnv<SuturingTask, Threads> envs(config, {.num_envs = 8, .seed = 42});
//   for (;;) {
//     policy(envs.observation<NeedlePose>(), actions);   // (num_envs, ...), contiguous
//     auto const& out = envs.step(actions);              // out.reward, out.terminated, out.truncated, ...
//   }
//
// Words as in Gymnasium.
#pragma once

#include <array>
#include <span>
#include <tuple>

#include <mpmpbd/pbd/fields.hpp>
#include <mpmpbd/rl/episode.hpp>
#include <mpmpbd/rl/observations.hpp>
#include <mpmpbd/rl/outcome.hpp>
#include <mpmpbd/scene/simulation.hpp>

namespace mpmpbd::rl {

// What happens to an environment whose episode has ended.
enum class Autoreset {
  same_step,  // it starts anew within the step; the last observation is in `final_observation`
  next_step,  // it starts anew in the next step, whose action is ignored and pays nothing
  disabled,   // it stands still until reset(mask)
};

struct VectorEnvOptions {
  std::int64_t num_envs = 1;
  std::int64_t seed = 1;
  Autoreset autoreset = Autoreset::same_step;
  std::int64_t first_environment = 0;  // its number in a larger set, to run a part of it again
};

// Faults with which an episode does not go on: its numbers are lost, or no longer those of the scene.
inline constexpr std::uint32_t fatal_faults =
    Fault::not_finite | Fault::inversion | static_cast<std::uint32_t>(Fault::solver);

namespace detail {
template <class List, class P> inline constexpr int index_in = -1;
template <class P, class... Ps> inline constexpr int index_in<TypeList<P, Ps...>, P> = 0;
template <class Q, class... Ps, class P>
inline constexpr int index_in<TypeList<Q, Ps...>, P> = 1 + index_in<TypeList<Ps...>, P>;

[[noreturn]] inline void refuse_env(std::string const& sentence) {
  throw std::invalid_argument("mpmpbd VectorEnv: " + sentence);
}
}  // namespace detail

template <class Task_, class Backend = Serial, class T = float> class VectorEnv {
 public:
  using Task = Task_;
  using Config = typename Task::Config;
  using Sim = Simulation<typename Task::Scene, Backend, T>;
  static constexpr int action_size = Task::Action::size;
  static constexpr int term_count = Task::Rewards::size;
  static constexpr int metric_count = Task::Metrics::size;

  // All environments are in their first episode. Throws std::invalid_argument for settings that are
  // not allowed.
  VectorEnv(Config const& config, VectorEnvOptions const& options, Backend backend = {})
      : config_(config),
        options_(options),
        backend_(with_fixed_lanes(backend)),
        sim_(checked(options, config), backend_),
        groups_(Groups::make(sim_.state(), config_, backend_.lanes())) {
    Task::set_up(sim_, 0, config_);
    for (std::int64_t env = 1; env < num_envs(); ++env) sim_.clone(0, env);
    sim_.remember();
    active_.assign(count(), 1);
    out_.resize(count(), std::size_t{term_count}, std::size_t{metric_count});
    reset(options.seed);
  }

  std::int64_t num_envs() const { return options_.num_envs; }
  Config const& config() const { return config_; }
  VectorEnvOptions const& options() const { return options_; }
  double step_time() const { return Task::step_time(config_); }  // [s] of a step of the scene
  double decision_time() const { return step_time() * config_.episode.decision_interval; }  // [s]
  Sim& simulation() { return sim_; }
  Sim const& simulation() const { return sim_; }

  // Of the episode in which an environment is: its number, counted from 1; decisions since its
  // start; whether it has ended and waits; and the environment whose random numbers it has.
  std::int64_t episode(std::int64_t env) const { return remembered<environment::Episode>(env); }
  std::int64_t decisions(std::int64_t env) const { return remembered<episode::Decisions>(env); }
  bool waits(std::int64_t env) const { return remembered<episode::Ended>(env) != 0; }
  std::int64_t stream(std::int64_t env) const { return remembered<episode::Stream>(env); }

  // Observations of a group: (num_envs, frames, shape...), contiguous, the newest frame last.
  template <class Group> auto observation() const { return std::span(arrays<Group>().now); }
  // The newest frame of one environment: (shape...).
  template <class Group> auto newest(std::int64_t env) const {
    auto const& g = arrays<Group>();
    return std::span(g.now).subspan(g.newest(env), g.size);
  }
  // All frames of episodes that ended in the last step (Autoreset::same_step); other rows are old.
  template <class Group> auto final_observation() const { return std::span(arrays<Group>().last); }
  // Of a group without the first two axes.
  template <class Group> std::vector<std::int64_t> const& shape() const {
    return arrays<Group>().shape;
  }

  // Names of the reward terms and metrics, in the order of their arrays.
  static constexpr auto term_names() { return names(typename Task::Rewards{}); }
  static constexpr auto metric_names() { return names(typename Task::Metrics{}); }

  // Starts a new episode: in all environments, ...
  void reset() {
    backend_.for_each(num_envs(), [&](std::int64_t env, int lane) { restart(env, lane); });
  }
  // ... with another seed, from its first episode on, ...
  void reset(std::int64_t seed) {
    options_.seed = seed;
    backend_.for_each(num_envs(), [&](std::int64_t env, int lane) { begin(env, 1, env, lane); });
  }
  // ... in those with a non-zero mask, ...
  void reset(std::span<unsigned char const> mask) {
    if (mask.size() != count())
      detail::refuse_env("a mask of " + std::to_string(mask.size()) + " entries given; there are " +
                         std::to_string(num_envs()) + " environments");
    backend_.for_each(num_envs(), [&](std::int64_t env, int lane) {
      if (mask[static_cast<std::size_t>(env)]) restart(env, lane);
    });
  }
  // ... or a certain one, counted from 1, in one environment: to see it again. With `as` it is that
  // of another environment.
  void start(std::int64_t env, std::int64_t episode) { start(env, episode, env); }
  void start(std::int64_t env, std::int64_t episode, std::int64_t as) {
    if (env < 0 || env >= num_envs() || episode < 1 || as < 0)
      detail::refuse_env("start(" + std::to_string(env) + ", " + std::to_string(episode) + ", " +
                         std::to_string(as) + "); there are environments 0 to " +
                         std::to_string(num_envs() - 1) +
                         ", episodes are counted from 1, and `as` from 0");
    begin(env, episode, as, 0);
  }

  // One decision in every environment: actions (num_envs, action_size) in [-1, 1].
  //
  // Another number of actions throws std::invalid_argument and nothing happens. An environment with
  // a number out of [-1, 1], or NaN, does not move: its episode is truncated, `invalid_action` says
  // so, and no other notices.
  StepOutcome const& step(std::span<float const> actions) {
    if (actions.size() != count() * action_size)
      detail::refuse_env(std::to_string(actions.size()) + " actions given; " +
                         std::to_string(num_envs()) + " environments with " +
                         std::to_string(action_size) + " each are needed");
    backend_.for_each(num_envs(), [&](std::int64_t env, int lane) {
      begin_decision(env, row(actions, env), lane);
    });
    double const h = step_time();
    for (int i = 0; i < config_.episode.decision_interval; ++i) {
      for_each_active([&](std::int64_t env) {
        Task::Action::apply(access(env), sim_.context(env), row(actions, env), h);
      });
      sim_.step(h, active_);
      for_each_active([&](std::int64_t env) { follow(env, advancing); });
    }
    backend_.for_each(num_envs(), [&](std::int64_t env, int lane) { finish_decision(env, lane); });
    return out_;
  }
  StepOutcome const& outcome() const { return out_; }
  // One metric of the last step, by its type.
  template <class Metric> float metric(std::int64_t env) const {
    constexpr int k = detail::index_in<typename Task::Metrics, Metric>;
    return out_.metrics[static_cast<std::size_t>(env * metric_count + k)];
  }

 private:
  using Groups = detail::AllGroups<typename Task::Observations>;

  // Viewers are made for a number of lanes, which must not change behind their back.
  static Backend with_fixed_lanes(Backend backend) {
    if constexpr (requires { backend.count; }) backend.count = backend.lanes();
    return backend;
  }
  static SimulationOptions checked(VectorEnvOptions const& o, Config const& config) {
    if (o.num_envs < 1)
      detail::refuse_env("num_envs = " + std::to_string(o.num_envs) + "; give at least 1");
    if (o.first_environment < 0)
      detail::refuse_env("first_environment = " + std::to_string(o.first_environment) +
                         "; give 0 or more");
    if constexpr (requires(Config c, ConfigKeys & keys) { c.declare(keys); })
      check_config(config);
    else
      check_config(config.episode);
    return Task::options(config, o.num_envs);
  }
  template <class... Ps> static constexpr auto names(TypeList<Ps...>) {
    return std::array<std::string_view, sizeof...(Ps)>{Ps::name.view()...};
  }
  template <class Group> auto const& arrays() const {
    return std::get<detail::GroupArrays<Group>>(groups_);
  }
  template <class Function> void for_each_group(Function&& f) {
    std::apply([&](auto&... group) { (f(group), ...); }, groups_);
  }
  template <class Function> void for_each_active(Function&& f) {
    for (std::int64_t env = 0; env < num_envs(); ++env)
      if (active_[static_cast<std::size_t>(env)]) f(env);
  }
  std::size_t count() const { return static_cast<std::size_t>(options_.num_envs); }
  auto access(std::int64_t env) {
    return access_environment(sim_.state(), env, typename Sim::Store::Domains{});
  }
  template <class F> std::int64_t remembered(std::int64_t env) const {
    return sim_.state().template get<F>(env);
  }
  static float const* row(std::span<float const> actions, std::int64_t env) {
    return actions.data() + env * action_size;
  }

  // What the task remembers is told of the scene: at the start, before a decision, after a step.
  static constexpr auto beginning = []<class P>(std::type_identity<P>, auto const& env,
                                                auto const& context) { P::begin(env, context); };
  static constexpr auto deciding = []<class P>(std::type_identity<P>, auto const& env,
                                               auto const& context) { P::decide(env, context); };
  static constexpr auto advancing = []<class P>(std::type_identity<P>, auto const& env,
                                                auto const& context) { P::advance(env, context); };
  template <class What> void follow(std::int64_t env, What const& what) {
    auto const one = access(env);
    auto const context = sim_.context(env);
    for_each_type(typename Task::Progress{}, [&](auto part) { what(part, one, context); });
  }

  void restart(std::int64_t env, int lane) { begin(env, episode(env) + 1, env, lane); }
  // `lane` is who does it, of the lanes of the back end: environments are begun and drawn side by side.
  void begin(std::int64_t env, std::int64_t episode, std::int64_t as, int lane) {
    begin_episode(env, episode, as, lane);
    out_.clear(env);
  }
  void begin_episode(std::int64_t env, std::int64_t episode, std::int64_t as, int lane) {
    sim_.reset(env);
    auto& state = sim_.state();
    std::int64_t const stream = options_.first_environment + as;
    state.template set<environment::Episode>(env, episode);
    state.template set<environment::Seed>(env, options_.seed);
    state.template set<episode::Stream>(env, stream);
    Random random(options_.seed, stream, episode);
    for_each_type(typename Task::Randomisations{}, [&]<class P>(std::type_identity<P>) {
      P::apply(access(env), sim_.context(env), random);
    });
    follow(env, beginning);
    observe(env, lane);
    for_each_group([env](auto& g) { g.repeat(env); });
  }

  // Forgets what the last step said, and decides who acts.
  void begin_decision(std::int64_t env, float const* action, int lane) {
    auto const i = static_cast<std::size_t>(env);
    out_.clear(env);
    active_[i] = 0;
    if (waits(env)) {
      if (options_.autoreset != Autoreset::next_step) return;
      restart(env, lane);
      out_.restarted[i] = 1;
      return;
    }
    for (int a = 0; a < action_size; ++a)
      if (!(action[a] >= -1.0f && action[a] <= 1.0f)) out_.invalid_action[i] = 1;
    out_.truncated[i] = out_.invalid_action[i];
    if (out_.invalid_action[i]) return;
    active_[i] = 1;
    follow(env, deciding);
  }

  // What came of the decision; then, where the episode has ended, the next one.
  void finish_decision(std::int64_t env, int lane) {
    if (active_[static_cast<std::size_t>(env)]) judge(env, observe(env, lane));
    report(env);
    if (!out_.done(env)) return;
    sim_.state().template set<episode::Ended>(env, 1);
    if (options_.autoreset != Autoreset::same_step) return;
    for_each_group([env](auto& g) { g.keep(env); });
    begin_episode(env, episode(env) + 1, env, lane);
  }

  // Rewards and ends of a decision.
  void judge(std::int64_t env, bool seen_whole) {
    auto const i = static_cast<std::size_t>(env);
    auto& state = sim_.state();
    state.template set<episode::Decisions>(env, decisions(env) + 1);
    auto const one = access(env);
    auto const context = sim_.context(env);
    bool const whole = seen_whole && (sim_.status(env) & fatal_faults) == 0;
    if (!whole || !pay(env, one, context, typename Task::Rewards{})) return lose(env);
    for_each_type(typename Task::Terminations{}, [&]<class P>(std::type_identity<P>) {
      if (P::holds(one, context)) out_.terminated[i] = 1;
    });
    out_.truncated[i] = !out_.terminated[i] && decisions(env) >= config_.episode.limit;
  }
  void lose(std::int64_t env) {
    if ((sim_.status(env) & fatal_faults) == 0)
      sim_.state().template set<environment::Status>(
          env, static_cast<std::int64_t>(sim_.status(env) |
                                         static_cast<std::uint32_t>(Fault::not_finite)));
    out_.lose(env);
  }
  // Returns false, and pays nothing, where a term is not finite.
  template <class Access, class Ctx, class... Rs>
  bool pay(std::int64_t env, Access const& one, Ctx const& context, TypeList<Rs...>) {
    auto const i = static_cast<std::size_t>(env);
    Vec<T, term_count> const terms{{static_cast<T>(Rs::value(one, context))...}};
    if (!is_finite(terms)) return false;
    set_vector<typename Task::Returns>(one, 0, get_vector<typename Task::Returns>(one, 0) + terms);
    for (int k = 0; k < term_count; ++k) {
      auto const term = static_cast<float>(terms[k]);
      out_.terms[i * term_count + static_cast<std::size_t>(k)] = term;
      out_.reward[i] += term;
    }
    return true;
  }
  void report(std::int64_t env) {
    auto const i = static_cast<std::size_t>(env);
    auto const one = access(env);
    out_.status[i] = sim_.status(env);
    out_.episode_length[i] = static_cast<std::int32_t>(decisions(env));
    auto const sums = get_vector<typename Task::Returns>(one, 0);
    for (int k = 0; k < term_count; ++k)
      out_.returns[i * term_count + static_cast<std::size_t>(k)] = static_cast<float>(sums[k]);
    measure(out_.metrics.data() + i * metric_count, one, sim_.context(env),
            typename Task::Metrics{});
  }
  template <class Access, class Ctx, class... Ms>
  static void measure([[maybe_unused]] float* to, [[maybe_unused]] Access const& one,
                      [[maybe_unused]] Ctx const& context, TypeList<Ms...>) {
    [[maybe_unused]] auto const finite = [](float value) {
      return value - value == 0 ? value : 0.0f;
    };
    ((*to++ = finite(static_cast<float>(Ms::value(one, context)))), ...);
  }
  // Takes a new frame of every group; returns whether all numbers in them are finite.
  bool observe(std::int64_t env, int lane) {
    auto const one = access(env);
    auto const context = sim_.context(env);
    bool finite = true;
    for_each_group([&](auto& g) { finite = g.observe(env, lane, one, context) && finite; });
    return finite;
  }

  Config config_;
  VectorEnvOptions options_;
  Backend backend_;
  Sim sim_;
  typename Groups::type groups_;
  std::vector<unsigned char> active_;
  StepOutcome out_;
};

}  // namespace mpmpbd::rl
