// The device's half of a step loop: memory for what environments show and are paid, and what is done before, between and
// after the steps of a decision.
//
// This header needs no CUDA compiler. The functions that do are defined in rl/cuda/episodes.cuh; a catalogue compiles
// them once for a task without its settings (Task::Composition).
#pragma once

#include <mpmpbd/backend/cuda.hpp>
#include <mpmpbd/rl/episode_control.hpp>

namespace mpmpbd::rl {

// Who is to begin an episode, and which.
struct Asked {
  unsigned char const* mask = nullptr;  // in the memory of the device: where it is not 0; null: all
  std::int64_t only = -1;               // this environment; -1: all
  std::int64_t episode = 0;             // counted from 1; 0: the next
  std::int64_t as = -1;  // of this environment of the larger set; -1: of each its own
};

template <class Task, class T> class EpisodesOnDevice {
 public:
  using Sim = Simulation<typename Task::Scene, Cuda, T>;
  using Views = detail::GroupViews<typename Task::Observations>;

  // For all environments of a run; everything is 0. `sizes` says how large groups are.
  EpisodesOnDevice(Sim const& sim, Cuda where, Views const& sizes);
  ~EpisodesOnDevice();
  EpisodesOnDevice(EpisodesOnDevice&&) noexcept;

  // Where everything lies in the memory of the device.
  Place place() const { return {MemorySpace::cuda, where_.device, where_.stream}; }
  OutcomeArrays const& outcome() const { return outcome_; }
  Views const& groups() const { return groups_; }
  float* actions() const { return actions_; }    // (num_envs, Action::size)
  unsigned char* mask() const { return mask_; }  // (num_envs)

  // Return before the device is done; nothing is copied, no memory of the device taken, but for what step_where and on_device
  // of the run wait for and send.
  void begin(Sim& sim, EpisodeRules const& rules, Asked const& asked) const;
  // A decision of `steps` steps of h [s]; the actions lie in the memory of the device.
  void decide(Sim& sim, EpisodeRules const& rules, float const* actions, double h, int steps) const;

  void send(void* to, void const* from, std::size_t bytes) const;  // waits
  void fetch(void* to, void const* from, std::size_t bytes) const;

 private:
  struct Memory;  // in rl/cuda/episodes.cuh

  // Calls f(pointer, numbers per environment) for everything that lies on the device.
  template <class Function> void for_each_array(Function&& f) {
    outcome_.walk([&](auto member, int of_each) { f(outcome_.*member, of_each); });
    groups_.for_each([&](auto& group) {
      f(group.now, group.stride());
      f(group.last, group.stride());
    });
    f(actions_, Task::Action::size);
    for (auto* flags : {&mask_, &acts_}) f(*flags, 1);
  }

  Cuda where_;
  OutcomeArrays outcome_{};
  Views groups_;
  float* actions_ = nullptr;
  unsigned char *mask_ = nullptr, *acts_ = nullptr;
  std::unique_ptr<Memory> memory_;
};

}  // namespace mpmpbd::rl
