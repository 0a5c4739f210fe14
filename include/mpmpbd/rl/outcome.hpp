// What a decision came to, in all environments.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mpmpbd::rl {

// (num_envs) each; `terms` and `returns` are (num_envs, terms), `metrics` is (num_envs, metrics).
// All are of the episode that acted, also where a new one has begun since.
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
  // Nothing has been decided yet.
  void clear(std::int64_t env) {
    auto const i = static_cast<std::size_t>(env);
    reward[i] = 0;
    terminated[i] = truncated[i] = diverged[i] = invalid_action[i] = restarted[i] = 0;
    std::size_t const n = terms.size() / reward.size();
    for (std::size_t k = 0; k < n; ++k) terms[i * n + k] = 0;
  }
  // Its numbers mean nothing.
  void lose(std::int64_t env) {
    auto const i = static_cast<std::size_t>(env);
    clear(env);
    diverged[i] = terminated[i] = 1;
  }
};

}  // namespace mpmpbd::rl
