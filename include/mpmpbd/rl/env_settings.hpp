// What step loops have in common on all back ends: their settings, names, and what they refuse.
#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>

#include <mpmpbd/rl/episode.hpp>
#include <mpmpbd/rl/episode_control.hpp>

namespace mpmpbd::rl {

struct VectorEnvOptions {
  std::int64_t num_envs = 1;
  std::int64_t seed = 1;
  Autoreset autoreset = Autoreset::same_step;
  std::int64_t first_environment = 0;  // its number in a larger set, to run a part of it again
};

namespace detail {
// -1: it is not there.
template <class List, class P> inline constexpr int index_in = -1;
template <class P, class... Ps> inline constexpr int index_in<TypeList<P, Ps...>, P> = 0;
template <class Q, class... Ps, class P>
inline constexpr int index_in<TypeList<Q, Ps...>, P> =
    index_in<TypeList<Ps...>, P> < 0 ? -1 : 1 + index_in<TypeList<Ps...>, P>;

[[noreturn]] inline void refuse_env(std::string const& sentence) {
  throw std::invalid_argument("mpmpbd VectorEnv: " + sentence);
}
}  // namespace detail

template <class Task_> class EnvSettings {
 public:
  using Task = Task_;
  using Config = typename Task::Config;
  static constexpr int action_size = Task::Action::size;
  static constexpr int term_count = Task::Rewards::size;
  static constexpr int metric_count = Task::Metrics::size;

  std::int64_t num_envs() const { return options_.num_envs; }
  Config const& config() const { return config_; }
  VectorEnvOptions const& options() const { return options_; }
  double step_time() const { return Task::step_time(config_); }  // [s] of a step of the scene
  double decision_time() const { return step_time() * config_.episode.decision_interval; }  // [s]

  // Names of the reward terms and metrics, in the order of their arrays.
  static constexpr auto term_names() { return names(typename Task::Rewards{}); }
  static constexpr auto metric_names() { return names(typename Task::Metrics{}); }

 protected:
  EnvSettings(Config const& config, VectorEnvOptions const& options)
      : config_(config), options_(options) {
    if (options.num_envs < 1)
      detail::refuse_env("num_envs = " + std::to_string(options.num_envs) + "; give at least 1");
    if (options.first_environment < 0)
      detail::refuse_env("first_environment = " + std::to_string(options.first_environment) +
                         "; give 0 or more");
    if constexpr (requires(Config c, ConfigKeys & keys) { c.declare(keys); })
      check_config(config);
    else
      check_config(config.episode);
  }

  // All environments as the task sets up one; that is what an episode begins from.
  template <class Sim> void set_up(Sim& sim) const {
    Task::set_up(sim, 0, config_);
    for (std::int64_t env = 1; env < num_envs(); ++env) sim.clone(0, env);
    sim.remember();
  }

  std::size_t count() const { return static_cast<std::size_t>(options_.num_envs); }
  EpisodeRules rules() const {
    return {options_.seed, options_.first_environment, config_.episode.limit, options_.autoreset};
  }
  // Where a metric of an environment is.
  template <class Metric> static constexpr std::size_t metric_index(std::int64_t env) {
    constexpr int k = detail::index_in<typename Task::Metrics, Metric>;
    static_assert(k >= 0,
                  "mpmpbd VectorEnv: metric<M> of a metric that the task does not have; name one "
                  "of Task::Metrics, or add it to the task");
    return static_cast<std::size_t>(env * metric_count + k);
  }

  void check_mask(std::size_t entries) const {
    if (entries != count())
      detail::refuse_env("a mask of " + std::to_string(entries) + " entries given; there are " +
                         std::to_string(num_envs()) + " environments");
  }
  void check_start(std::int64_t env, std::int64_t episode, std::int64_t as) const {
    if (env < 0 || env >= num_envs() || episode < 1 || as < 0)
      detail::refuse_env("start(" + std::to_string(env) + ", " + std::to_string(episode) + ", " +
                         std::to_string(as) + "); there are environments 0 to " +
                         std::to_string(num_envs() - 1) +
                         ", episodes are counted from 1, and `as` from 0");
  }
  void check_actions(std::size_t numbers) const {
    if (numbers != count() * action_size)
      detail::refuse_env(std::to_string(numbers) + " actions given; " + std::to_string(num_envs()) +
                         " environments with " + std::to_string(action_size) + " each are needed");
  }

  Config config_;
  VectorEnvOptions options_;

 private:
  template <class... Ps> static constexpr auto names(TypeList<Ps...>) {
    return std::array<std::string_view, sizeof...(Ps)>{Ps::name.view()...};
  }
};

}  // namespace mpmpbd::rl
