// What a decision came to, in all environments.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <mpmpbd/core/config.hpp>

namespace mpmpbd::rl {

// Where the words of a StepOutcome lie: in the memory of the host, or of a device.
struct OutcomeArrays {
  float *reward, *terms, *returns, *metrics;
  unsigned char *terminated, *truncated, *diverged, *invalid_action, *restarted;
  std::int32_t* episode_length;
  std::uint32_t* status;
  int term_count, metric_count;

  MPMPBD_HD bool done(std::int64_t env) const { return (terminated[env] | truncated[env]) != 0; }

  // Nothing has been decided yet.
  MPMPBD_HD void clear(std::int64_t env) const {
    reward[env] = 0;
    terminated[env] = truncated[env] = diverged[env] = invalid_action[env] = restarted[env] = 0;
    for (int k = 0; k < term_count; ++k) terms[env * term_count + k] = 0;
  }
  // Its numbers mean nothing.
  MPMPBD_HD void lose(std::int64_t env) const {
    clear(env);
    diverged[env] = terminated[env] = 1;
  }

  // Calls f(member, numbers per environment) for every array.
  template <class Function> void walk(Function&& f) const {
    f(&OutcomeArrays::reward, 1);
    f(&OutcomeArrays::terms, term_count);
    f(&OutcomeArrays::returns, term_count);
    f(&OutcomeArrays::metrics, metric_count);
    for (auto flags :
         {&OutcomeArrays::terminated, &OutcomeArrays::truncated, &OutcomeArrays::diverged,
          &OutcomeArrays::invalid_action, &OutcomeArrays::restarted})
      f(flags, 1);
    f(&OutcomeArrays::episode_length, 1);
    f(&OutcomeArrays::status, 1);
  }
};

// (num_envs) each; `terms` and `returns` are (num_envs, terms), `metrics` is (num_envs, metrics).
// All are of the episode that acted, also where a new one has begun by itself since. Of one that was asked for
// (reset, start), they are what it has come to so far: nothing.
struct StepOutcome {
  std::vector<float> reward, terms;
  std::vector<float> returns;  // sums of the terms so far
  std::vector<float> metrics;
  std::vector<unsigned char> terminated;  // by a Termination, or because it diverged
  std::vector<unsigned char> truncated;   // by the limit of decisions, or by an invalid action
  std::vector<unsigned char> diverged, invalid_action, restarted;
  std::vector<std::int32_t> episode_length;  // decisions so far
  std::vector<std::uint32_t> status;         // faults met so far

  bool done(std::int64_t env) const {
    auto const i = static_cast<std::size_t>(env);
    return (terminated[i] | truncated[i]) != 0;
  }

  void resize(std::size_t environments, std::size_t term_count, std::size_t metric_count) {
    reward.assign(environments, 0);
    terms.assign(environments * term_count, 0);
    returns.assign(environments * term_count, 0);
    metrics.assign(environments * metric_count, 0);
    for (auto* flags : {&terminated, &truncated, &diverged, &invalid_action, &restarted})
      flags->assign(environments, 0);
    episode_length.assign(environments, 0);
    status.assign(environments, 0);
  }
  OutcomeArrays arrays() {
    return {reward.data(),
            terms.data(),
            returns.data(),
            metrics.data(),
            terminated.data(),
            truncated.data(),
            diverged.data(),
            invalid_action.data(),
            restarted.data(),
            episode_length.data(),
            status.data(),
            static_cast<int>(terms.size() / reward.size()),
            static_cast<int>(metrics.size() / reward.size())};
  }
};

}  // namespace mpmpbd::rl
