// What a decision is beside the steps of its scene, on a device. Where these are one launch, what lies between two of them is part
// of it; else it is a launch with a block for every environment.
#pragma once

#include <mpmpbd/backend/cuda/simulation.cuh>
#include <mpmpbd/rl/cuda/episodes.hpp>

namespace mpmpbd::rl {

// When a kernel is started: out of turn, before the first step of a decision, between two, after the last.
enum class Moment { begin, decide, between, finish };

template <class Task, class T> struct EpisodeLaunch {
  cuda::StateOnDevice<typename Task::Scene, T> run;
  EpisodeRules rules;
  OutcomeArrays out;
  detail::GroupViews<typename Task::Observations> groups;
  unsigned char* acts;  // whether an environment moves in this decision
  float const* actions;
  double h;  // length of a step [s]
  Asked asked;

  __device__ auto control(std::int64_t env) const {
    auto const fields = run.now.environment(env);
    return EpisodeControl<Task, std::remove_const_t<decltype(fields)>>{fields, run.lattice, env,
                                                                       rules,  out,         groups};
  }
  // What the text of all back ends makes of a moment. One thread calls.
  __device__ Beginning meet(Moment moment, std::int64_t env) const {
    auto const one = control(env);
    float const* const action = actions + env * Task::Action::size;
    if (moment == Moment::begin) return answer(one);
    Beginning next{};
    if (moment == Moment::decide)
      next = one.decide(action, acts[env]);
    else if (acts[env])
      one.advance();
    if (moment == Moment::finish) return one.finish(acts[env] != 0);
    if (acts[env]) one.apply(action, h);
    return next;
  }

 private:
  template <class Control> __device__ Beginning answer(Control const& one) const {
    if (asked.mask != nullptr && asked.mask[one.env] == 0) return {};
    if (asked.only >= 0 && asked.only != one.env) return {};
    out.clear(one.env);
    if (asked.episode == 0) return one.next();
    return asked.as >= 0 ? Beginning{asked.episode, asked.as} : one.own(asked.episode);
  }
};

// What two steps of a decision have between them. A function of its own, told little: it must not crowd the registers of
// what moves particles.
template <class Task, class T> struct BetweenSteps {
  EpisodeLaunch<Task, T> launch;
  __device__ void operator()(std::int64_t env) const { meet(launch, env); }

 private:
  __device__ __noinline__ static void meet(EpisodeLaunch<Task, T> const& launch, std::int64_t env) {
    launch.meet(Moment::between, env);
  }
};

// One thread reads the text; all put an environment back that begins an episode.
template <class Task, class T>
__global__ void __launch_bounds__(128)
    between_steps(__grid_constant__ EpisodeLaunch<Task, T> const launch, Moment const moment) {
  std::int64_t const env = blockIdx.x;
  Beginning next{};
  if (threadIdx.x == 0) next = launch.meet(moment, env);
  if (!__syncthreads_or(next.episode > 0)) return;
  launch.run.now.copy_environment(env, launch.run.remembered, env);
  __syncthreads();
  if (threadIdx.x != 0) return;
  launch.control(env).begin(next);
  if (moment == Moment::begin) launch.control(env).report();
}

// One piece of memory for all arrays.
template <class Task, class T> struct EpisodesOnDevice<Task, T>::Memory { cuda::Memory all; };

template <class Task, class T>
EpisodesOnDevice<Task, T>::EpisodesOnDevice(Sim const& sim, Cuda where, Views const& sizes)
    : where_(where), groups_(sizes), memory_(std::make_unique<Memory>()) {
  cuda::OnDevice const here(where.device);
  outcome_.term_count = Task::Rewards::size;
  outcome_.metric_count = Task::Metrics::size;
  auto const size = [&]<class Number>(Number*, std::int64_t of_each) {
    auto const numbers = static_cast<std::size_t>(sim.environments() * of_each);
    return (numbers * sizeof(Number) + 255) / 256 * 256;
  };
  std::size_t bytes = 0, at = 0;
  for_each_array([&](auto* array, std::int64_t of_each) { bytes += size(array, of_each); });
  memory_->all = cuda::Memory(bytes);
  for_each_array([&]<class Number>(Number*& array, std::int64_t of_each) {
    array = memory_->all.template as<Number>(at);
    at += size(array, of_each);
  });
  cuda::require(
      cudaMemsetAsync(memory_->all.as(), 0, bytes, static_cast<cudaStream_t>(where.stream)),
      "clearing arrays");
}
template <class Task, class T> EpisodesOnDevice<Task, T>::~EpisodesOnDevice() = default;
template <class Task, class T>
EpisodesOnDevice<Task, T>::EpisodesOnDevice(EpisodesOnDevice&&) noexcept = default;

template <class Task, class T>
void EpisodesOnDevice<Task, T>::begin(Sim& sim, EpisodeRules const& rules,
                                      Asked const& asked) const {
  cuda::OnDevice const here(where_.device);
  EpisodeLaunch<Task, T> const launch{sim.on_device(), rules,    outcome_, groups_,
                                      acts_,           actions_, 0.0,      asked};
  cuda::start(static_cast<cudaStream_t>(where_.stream), "episodes", between_steps<Task, T>,
              sim.environments(), 128, 0, launch, Moment::begin);
}
template <class Task, class T>
void EpisodesOnDevice<Task, T>::decide(Sim& sim, EpisodeRules const& rules, float const* actions,
                                       double h, int steps) const {
  cuda::OnDevice const here(where_.device);
  EpisodeLaunch<Task, T> const launch{sim.on_device(), rules,   outcome_, groups_,
                                      acts_,           actions, h,        {}};
  auto const meet = [&](Moment moment) {
    cuda::start(static_cast<cudaStream_t>(where_.stream), "a decision", between_steps<Task, T>,
                sim.environments(), 128, 0, launch, moment);
  };
  meet(Moment::decide);
  if (!sim.steps_at_once(h, acts_, steps, BetweenSteps<Task, T>{launch}))
    for (int i = 0; i < steps; ++i) {
      if (i > 0) meet(Moment::between);
      sim.step_where(h, acts_);
    }
  meet(Moment::finish);
}

template <class Task, class T>
void EpisodesOnDevice<Task, T>::send(void* to, void const* from, std::size_t bytes) const {
  cuda::OnDevice const here(where_.device);
  auto const stream = static_cast<cudaStream_t>(where_.stream);
  cuda::copy(stream, to, from, bytes, cudaMemcpyHostToDevice);
  cuda::require(cudaStreamSynchronize(stream), "sending");
}
template <class Task, class T>
void EpisodesOnDevice<Task, T>::fetch(void* to, void const* from, std::size_t bytes) const {
  cuda::OnDevice const here(where_.device);
  cuda::copy(static_cast<cudaStream_t>(where_.stream), to, from, bytes, cudaMemcpyDeviceToHost);
}

}  // namespace mpmpbd::rl
