// What a step loop shows and pays, as arrays where they lie, by name: the same ones after every step, with its numbers.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <mpmpbd/core/array.hpp>
#include <mpmpbd/rl/vector_env.hpp>

namespace mpmpbd::rl {

namespace detail {

// Whether what environments show and are paid lies in the memory of a device.
template <class Envs> inline constexpr bool on_device = requires(Envs const& envs) {
  envs.arrays();
};

// (num_envs, frames, shape...)
template <class Group, class Envs, class Numbers>
NamedArray group_array(Envs const& envs, Numbers const& numbers) {
  std::vector<std::int64_t> shape{envs.num_envs(), envs.config().episode.frames};
  auto const& own = envs.template shape<Group>();
  shape.insert(shape.end(), own.begin(), own.end());
  using Element = typename ElementOf<Group>::type;
  // Handed out by somebody who may change the environments.
  return {std::string(Group::name.view()),
          contiguous_array(const_cast<Element*>(numbers.data()), shape)};
}
template <class Group, class Envs> NamedArray newest_array(Envs const& envs) {
  if constexpr (on_device<Envs>)
    return {std::string(Group::name.view()), envs.template array<Group>()};
  else
    return group_array<Group>(envs, envs.template observation<Group>());
}
template <class Group, class Envs> NamedArray final_array(Envs const& envs) {
  if constexpr (on_device<Envs>)
    return {std::string(Group::name.view()), envs.template final_array<Group>()};
  else
    return group_array<Group>(envs, envs.template final_observation<Group>());
}

struct PlacedOutcome {
  OutcomeArrays arrays;
  Place place;
};
template <class Envs> PlacedOutcome outcome_of(Envs const& envs) {
  if constexpr (on_device<Envs>)
    return {envs.arrays(), envs.place()};
  else
    return {const_cast<StepOutcome&>(envs.outcome()).arrays(), {}};
}

template <class Task, class Of> std::vector<NamedArray> group_arrays(Of&& array_of) {
  std::vector<NamedArray> all;
  for_each_type(typename Task::Observations{},
                [&]<class Group>(std::type_identity<Group> g) { all.push_back(array_of(g)); });
  return all;
}

}  // namespace detail

// Observations by group, (num_envs, frames, shape...), the newest frame last.
template <class Envs> std::vector<NamedArray> observation_arrays(Envs& envs) {
  return detail::group_arrays<typename Envs::Task>(
      [&]<class G>(std::type_identity<G>) { return detail::newest_array<G>(envs); });
}
// The same of episodes that ended in the last step (Autoreset::same_step); other rows are old.
template <class Envs> std::vector<NamedArray> final_observation_arrays(Envs& envs) {
  return detail::group_arrays<typename Envs::Task>(
      [&]<class G>(std::type_identity<G>) { return detail::final_array<G>(envs); });
}

// The members of StepOutcome by their names: (num_envs), and (num_envs, terms or metrics) in the order of term_names(),
// metric_names(). Flags are of element type bool.
template <class Envs> std::vector<NamedArray> outcome_arrays(Envs& envs) {
  auto const placed = detail::outcome_of(envs);
  OutcomeArrays const& out = placed.arrays;
  Place const& place = placed.place;
  std::vector<NamedArray> all;
  auto per_env = [&](char const* name, auto* numbers) {
    std::int64_t const shape[] = {envs.num_envs()};
    all.push_back({name, contiguous_array(numbers, shape, place)});
  };
  auto flags = [&](char const* name, unsigned char* bytes) {
    per_env(name, bytes);
    all.back().array.element = element_type<bool>;
  };
  auto table = [&](char const* name, auto* numbers, std::int64_t columns) {
    std::int64_t const shape[] = {envs.num_envs(), columns};
    all.push_back({name, contiguous_array(numbers, shape, place)});
  };
  per_env("reward", out.reward);
  flags("terminated", out.terminated);
  flags("truncated", out.truncated);
  flags("diverged", out.diverged);
  flags("invalid_action", out.invalid_action);
  flags("restarted", out.restarted);
  per_env("episode_length", out.episode_length);
  per_env("status", out.status);
  table("terms", out.terms, Envs::term_count);
  table("returns", out.returns, Envs::term_count);
  table("metrics", out.metrics, Envs::metric_count);
  return all;
}

}  // namespace mpmpbd::rl
