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

#include <span>
#include <tuple>

#include <mpmpbd/rl/env_settings.hpp>
#include <mpmpbd/scene/simulation.hpp>

namespace mpmpbd::rl {

template <class Task_, class Backend = Serial, class T = float>
class VectorEnv : public EnvSettings<Task_> {
  using Base = EnvSettings<Task_>;

 public:
  using Task = Task_;
  using Config = typename Task::Config;
  using Sim = Simulation<typename Task::Scene, Backend, T>;
  using Base::action_size;

  // All environments are in their first episode. Throws std::invalid_argument for settings that are
  // not allowed.
  VectorEnv(Config const& config, VectorEnvOptions const& options, Backend backend = {})
      : Base(config, options),
        backend_(with_fixed_lanes(backend)),
        sim_(Task::options(config_, options.num_envs), backend_),
        groups_(Groups::make(sim_.state(), config_, backend_.lanes())) {
    this->set_up(sim_);
    active_.assign(this->count(), 1);
    out_.resize(this->count(), std::size_t{Base::term_count}, std::size_t{Base::metric_count});
    reset(options.seed);
  }

  using Base::num_envs;
  using Base::step_time;
  Sim& simulation() { return sim_; }
  Sim const& simulation() const { return sim_; }

  // Of the episode in which an environment is: its number, counted from 1; decisions since its
  // start; whether it has ended and waits; and the environment whose random numbers it has, by its
  // number in the larger set.
  std::int64_t episode(std::int64_t env) const { return remembered<environment::Episode>(env); }
  std::int64_t decisions(std::int64_t env) const { return remembered<episode::Decisions>(env); }
  bool waits(std::int64_t env) const { return remembered<episode::Ended>(env) != 0; }
  std::int64_t stream(std::int64_t env) const { return remembered<episode::Stream>(env); }

  // Observations of a group: (num_envs, frames, shape...), contiguous, the newest frame last.
  template <class Group> auto observation() const { return std::span(arrays<Group>().now); }
  // The newest frame of one environment: (shape...).
  template <class Group> auto newest(std::int64_t env) const { return arrays<Group>().newest(env); }
  // All frames of episodes that ended in the last step (Autoreset::same_step); other rows are old.
  template <class Group> auto final_observation() const { return std::span(arrays<Group>().last); }
  // Of a group without the first two axes.
  template <class Group> std::vector<std::int64_t> const& shape() const {
    return arrays<Group>().shape;
  }

  // Starts a new episode, whose numbers outcome() has then: in all environments, ...
  void reset() {
    backend_.for_each(num_envs(), [&](std::int64_t env, int lane) { restart(env, lane); });
  }
  // ... with another seed, from its first episode on, ...
  void reset(std::int64_t seed) {
    options_.seed = seed;
    backend_.for_each(num_envs(), [&](std::int64_t env, int lane) {
      begin(env, control(env, lane).own(1), lane);
    });
  }
  // ... in those with a non-zero mask, ...
  void reset(std::span<unsigned char const> mask) {
    this->check_mask(mask.size());
    backend_.for_each(num_envs(), [&](std::int64_t env, int lane) {
      if (mask[static_cast<std::size_t>(env)]) restart(env, lane);
    });
  }
  // ... or a certain one, counted from 1, in one environment: to see it again. With `as` it is that
  // of another environment, counted as stream() does: 0 is the first one of the larger set.
  void start(std::int64_t env, std::int64_t episode) {
    start(env, episode, options_.first_environment + env);
  }
  void start(std::int64_t env, std::int64_t episode, std::int64_t as) {
    this->check_start(env, episode, as);
    begin(env, {episode, as}, 0);
  }

  // One decision in every environment: actions (num_envs, action_size) in [-1, 1].
  //
  // Another number of actions throws std::invalid_argument and nothing happens. An environment with
  // a number out of [-1, 1], or NaN, does not move: its episode is truncated, `invalid_action` says
  // so, and no other notices.
  StepOutcome const& step(std::span<float const> actions) {
    this->check_actions(actions.size());
    auto const action = [&](std::int64_t env) { return actions.data() + env * action_size; };
    backend_.for_each(num_envs(), [&](std::int64_t env, int lane) {
      auto& acts = active_[static_cast<std::size_t>(env)];
      carry_out(env, control(env, lane).decide(action(env), acts), lane);
    });
    double const h = step_time();
    for (int i = 0; i < config_.episode.decision_interval; ++i) {
      for_each_active([&](std::int64_t env) { control(env, 0).apply(action(env), h); });
      sim_.step(h, active_);
      for_each_active([&](std::int64_t env) { control(env, 0).advance(); });
    }
    backend_.for_each(num_envs(), [&](std::int64_t env, int lane) {
      bool const acts = active_[static_cast<std::size_t>(env)] != 0;
      carry_out(env, control(env, lane).finish(acts), lane);
    });
    return out_;
  }
  StepOutcome const& outcome() const { return out_; }
  // One metric of outcome(), by its type.
  template <class Metric> float metric(std::int64_t env) const {
    return out_.metrics[Base::template metric_index<Metric>(env)];
  }

 private:
  using Groups = detail::AllGroups<typename Task::Observations>;
  using Base::config_;
  using Base::options_;

  // Viewers are made for a number of lanes, which must not change behind their back.
  static Backend with_fixed_lanes(Backend backend) {
    if constexpr (requires { backend.count; }) backend.count = backend.lanes();
    return backend;
  }
  template <class Group> auto const& arrays() const {
    return std::get<detail::GroupArrays<Group>>(groups_);
  }
  template <class Function> void for_each_active(Function&& f) {
    for (std::int64_t env = 0; env < num_envs(); ++env)
      if (active_[static_cast<std::size_t>(env)]) f(env);
  }
  template <class F> std::int64_t remembered(std::int64_t env) const {
    return sim_.state().template get<F>(env);
  }
  // `lane` is who does it, of the lanes of the back end: environments are begun and drawn side by side.
  auto control(std::int64_t env, int lane) {
    auto const fields = access_environment(sim_.state(), env, typename Sim::Store::Domains{});
    return EpisodeControl<Task, std::remove_const_t<decltype(fields)>>{
        fields, sim_.lattice(), env, this->rules(), out_.arrays(), Groups::views(groups_, lane)};
  }
  void carry_out(std::int64_t env, Beginning const& next, int lane) {
    if (next.episode == 0) return;
    sim_.reset(env);
    control(env, lane).begin(next);
  }
  void begin(std::int64_t env, Beginning const& it, int lane) {
    out_.arrays().clear(env);
    carry_out(env, it, lane);
    control(env, lane).report();
  }
  void restart(std::int64_t env, int lane) { begin(env, control(env, lane).next(), lane); }

  Backend backend_;
  Sim sim_;
  typename Groups::type groups_;
  std::vector<unsigned char> active_;
  StepOutcome out_;
};

}  // namespace mpmpbd::rl
