// The step loop on a CUDA device: the words of rl/vector_env.hpp, and the same arrays where they lie.
//
//   rl::VectorEnv<SuturingTask, Cuda> envs(config, {.num_envs = 1024, .seed = 42});
//   auto const pose = envs.array<NeedlePose>();          // (num_envs, frames, 7) on the device
//   for (;;) {
//     policy<<<...>>>(pose.as<float const>(), envs.actions());   // in the same stream
//     envs.step_from(envs.actions());                    // envs.arrays().reward, ...
//   }
//
// A program of plain C++ links a catalogue that has the task (mpmpbd::catalog_cuda). A task of your own is compiled in a
// .cu: see docs/concepts/device.md.
#pragma once

#include <array>
#include <utility>

#include <mpmpbd/rl/cuda/episodes.hpp>
#include <mpmpbd/rl/vector_env.hpp>

namespace mpmpbd::rl {

namespace detail {
template <class List> inline constexpr bool none_is_drawn = true;
template <class... Gs>
inline constexpr bool none_is_drawn<TypeList<Gs...>> = (!is_drawn<Gs> && ...);
}  // namespace detail

template <class Task_, class T> class VectorEnv<Task_, Cuda, T> : public EnvSettings<Task_> {
  using Base = EnvSettings<Task_>;
  using Episodes = EpisodesOnDevice<typename Task_::Composition, T>;
  using Groups = detail::AllGroups<typename Task_::Observations>;

  static_assert(detail::none_is_drawn<typename Task_::Observations>,
                "mpmpbd VectorEnv<Task, Cuda>: an observation group of the task is drawn (it names "
                "a Viewer), and pictures are not drawn on a device yet; take Serial or Threads, or "
                "groups of numbers");

 public:
  using Task = Task_;
  using Config = typename Task::Config;
  using Sim = Simulation<typename Task::Scene, Cuda, T>;
  using Base::action_size;

  // As on the host; std::runtime_error where there is no such device or not enough memory.
  VectorEnv(Config const& config, VectorEnvOptions const& options, Cuda where = {})
      : Base(config, options),
        sim_(Task::options(config_, options.num_envs), where),
        groups_(Groups::make(std::as_const(sim_).state(), config_, 1)),
        episodes_(sim_, where, Groups::views(groups_, 0)) {
    this->set_up(sim_);
    out_.resize(this->count(), std::size_t{Base::term_count}, std::size_t{Base::metric_count});
    for (auto& numbers : episode_numbers_) numbers.resize(this->count());
    reset(options.seed);
  }

  using Base::num_envs;
  using Base::step_time;
  // What is changed in its state, also by the host, the next step begins with. Ask for it again for each change: what is asked
  // for below is then fetched anew.
  Sim& simulation() {
    device_is_newer_ = true;
    return sim_;
  }
  Sim const& simulation() const { return sim_; }

  // In the memory of the device, valid as long as this; all work is in the order of `Cuda::stream`. What was shown and
  // paid is there when the step is done.
  template <class Group> Array array() const { return shaped<Group>(view<Group>().now); }
  template <class Group> Array final_array() const { return shaped<Group>(view<Group>().last); }
  OutcomeArrays const& arrays() const { return episodes_.outcome(); }
  Place place() const { return episodes_.place(); }
  // A place for actions, (num_envs, action_size).
  float* actions() { return episodes_.actions(); }
  // Copies actions of the host there, (num_envs, action_size), which waits; another number of them throws
  // std::invalid_argument.
  float const* send(std::span<float const> actions) {
    this->check_actions(actions.size());
    episodes_.send(episodes_.actions(), actions.data(), actions.size_bytes());
    return episodes_.actions();
  }
  // One decision in every environment, whose actions lie in the memory of the device: (num_envs, action_size). Nothing is
  // copied, no memory of the device taken, and nothing waits; but where environments in tiled form choose their substeps it
  // waits once per step of the scene, and what the host has changed is sent before. A launch that is refused throws
  // std::runtime_error and may leave a decision half done: reset.
  void step_from(float const* actions) {
    device_is_newer_ = true;
    episodes_.decide(sim_, this->rules(), actions, step_time(), config_.episode.decision_interval);
  }
  // New episodes where a mask in the memory of the device is not 0; null: everywhere.
  void reset_where(unsigned char const* mask) { ask({.mask = mask}); }

  // From here on as on the host: what is asked for is fetched when the device's is newer, which waits for it.
  std::int64_t episode(std::int64_t env) const { return remembered<environment::Episode>(env); }
  std::int64_t decisions(std::int64_t env) const { return remembered<episode::Decisions>(env); }
  bool waits(std::int64_t env) const { return remembered<episode::Ended>(env) != 0; }
  std::int64_t stream(std::int64_t env) const { return remembered<episode::Stream>(env); }

  template <class Group> auto observation() const { return std::span(fetched<Group>().now); }
  template <class Group> auto newest(std::int64_t env) const {
    return fetched<Group>().newest(env);
  }
  template <class Group> auto final_observation() const { return std::span(fetched<Group>().last); }
  template <class Group> std::vector<std::int64_t> const& shape() const {
    return std::get<detail::GroupArrays<Group>>(groups_).shape;
  }

  void reset() { ask({}); }
  void reset(std::int64_t seed) {
    auto const before = std::exchange(options_.seed, seed);
    try {
      ask({.episode = 1});
    } catch (...) {
      options_.seed = before;
      throw;
    }
  }
  void reset(std::span<unsigned char const> mask) {
    this->check_mask(mask.size());
    episodes_.send(episodes_.mask(), mask.data(), mask.size());
    ask({.mask = episodes_.mask()});
  }
  void start(std::int64_t env, std::int64_t episode) {
    start(env, episode, options_.first_environment + env);
  }
  void start(std::int64_t env, std::int64_t episode, std::int64_t as) {
    this->check_start(env, episode, as);
    ask({.only = env, .episode = episode, .as = as});
  }

  StepOutcome const& step(std::span<float const> actions) {
    step_from(send(actions));
    return outcome();
  }
  StepOutcome const& outcome() const {
    fetch();
    return out_;
  }
  template <class Metric> float metric(std::int64_t env) const {
    return outcome().metrics[Base::template metric_index<Metric>(env)];
  }

 private:
  using Base::config_;
  using Base::options_;
  using EpisodeNumbers =
      TypeList<environment::Episode, episode::Decisions, episode::Ended, episode::Stream>;

  void ask(Asked const& asked) {
    device_is_newer_ = true;
    episodes_.begin(sim_, this->rules(), asked);
  }
  template <class Group> auto const& view() const {
    return episodes_.groups().template of<Group>();
  }
  template <class Group, class Element> Array shaped(Element* data) const {
    std::vector<std::int64_t> all{num_envs(), view<Group>().frames};
    all.insert(all.end(), shape<Group>().begin(), shape<Group>().end());
    return contiguous_array(data, all, place());
  }
  template <class Group> auto const& fetched() const {
    fetch();
    return std::get<detail::GroupArrays<Group>>(groups_);
  }
  template <class F> std::int64_t remembered(std::int64_t env) const {
    fetch();
    return episode_numbers_[detail::index_in<EpisodeNumbers, F>][static_cast<std::size_t>(env)];
  }

  // Makes the arrays of the host those of the device. What a caller sees of this object stays what it was.
  void fetch() const {
    if (device_is_newer_) const_cast<VectorEnv&>(*this).fetch_all();
  }
  void fetch_all() {
    auto const copy = [&]<class Number>(Number* to, Number const* from, std::int64_t of_each) {
      episodes_.fetch(to, from, this->count() * static_cast<std::size_t>(of_each) * sizeof(Number));
    };
    auto const here = out_.arrays();
    here.walk([&](auto member, int of_each) { copy(here.*member, arrays().*member, of_each); });
    Groups::views(groups_, 0).for_each([&]<class Group>(detail::GroupView<Group>& mine) {
      copy(mine.now, view<Group>().now, mine.stride());
      copy(mine.last, view<Group>().last, mine.stride());
    });
    for_each_type(EpisodeNumbers{}, [&]<class F>(std::type_identity<F>) {
      auto const* const from = static_cast<std::int64_t const*>(sim_.template array<F>().data);
      copy(episode_numbers_[detail::index_in<EpisodeNumbers, F>].data(), from, 1);
    });
    sim_.wait();
    device_is_newer_ = false;
  }

  Sim sim_;
  typename Groups::type groups_;
  Episodes episodes_;
  StepOutcome out_;
  std::array<std::vector<std::int64_t>, EpisodeNumbers::size> episode_numbers_;
  bool device_is_newer_ = true;
};

}  // namespace mpmpbd::rl
