// What all environments show, group by group: (num_envs, frames, shape...), the newest frame last.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include <mpmpbd/rl/task.hpp>

namespace mpmpbd::rl::detail {

// The shape of a group for one environment: what it says itself, `size`, or `size` for every slot
// of `Each`.
template <class Group, class Store, class Config>
std::vector<std::int64_t> group_shape([[maybe_unused]] Store const& store,
                                      [[maybe_unused]] Config const& config) {
  if constexpr (requires { Group::shape(config); })
    return Group::shape(config);
  else if constexpr (requires { typename Group::Each; })
    return {store.template table<typename Group::Each>().capacity(), Group::size};
  else
    return {Group::size};
}

template <class Group> struct ElementOf { using type = float; };
template <class Group>
  requires requires { typename Group::Element; }
struct ElementOf<Group> {
  using type = typename Group::Element;
};

// What a group that is drawn draws with; others need nothing.
template <class Group> struct ViewerOf {
  struct type {
    template <class Config> type(Config const&, int) {}
  };
};
template <class Group>
  requires requires { typename Group::Viewer; }
struct ViewerOf<Group> {
  using type = typename Group::Viewer;
};

template <class Group> struct GroupArrays {
  using Element = typename ElementOf<Group>::type;
  std::vector<std::int64_t> shape;
  std::size_t size = 1, frames;
  std::vector<Element> now, last;
  typename ViewerOf<Group>::type viewer;

  template <class Store, class Config>
  GroupArrays(Store const& store, Config const& config, int lanes)
      : shape(group_shape<Group>(store, config)),
        frames(static_cast<std::size_t>(config.episode.frames)),
        viewer(config, lanes) {
    for (auto n : shape) size *= static_cast<std::size_t>(n);
    auto const all = static_cast<std::size_t>(store.environments()) * frames * size;
    now.assign(all, Element{});
    last.assign(all, Element{});
  }
  std::size_t stride() const { return frames * size; }
  std::size_t row(std::int64_t env) const { return static_cast<std::size_t>(env) * stride(); }
  std::size_t newest(std::int64_t env) const { return row(env) + (frames - 1) * size; }

  void keep(std::int64_t env) {
    std::copy_n(now.data() + row(env), stride(), last.data() + row(env));
  }
  // Writes a new frame of an environment, after the others have moved up. A number that is not
  // finite is shown as 0; returns whether there is none.
  template <class Access, class Context>
  bool observe(std::int64_t env, int lane, Access const& access, Context const& context) {
    auto* const first = now.data() + row(env);
    std::copy(first + size, first + stride(), first);
    auto* const to = now.data() + newest(env);
    bool finite = true;
    if constexpr (requires { typename Group::Viewer; }) {
      viewer.draw(access, context, lane, to);
    } else {
      std::fill_n(to, size, Element{});  // slots that are not in use
      Group::observe(access, context, to);
      for (std::size_t k = 0; k < size; ++k) {
        if (to[k] - to[k] == 0) continue;
        to[k] = 0;
        finite = false;
      }
    }
    return finite;
  }
  // At the start of an episode all frames show the same.
  void repeat(std::int64_t env) {
    for (std::size_t f = 0; f + 1 < frames; ++f)
      std::copy_n(now.data() + newest(env), size, now.data() + row(env) + f * size);
  }
};

template <class List> struct AllGroups;
template <class... Gs> struct AllGroups<TypeList<Gs...>> {
  using type = std::tuple<GroupArrays<Gs>...>;

  template <class Store, class Config>
  static type make(Store const& store, Config const& config, int lanes) {
    return type{GroupArrays<Gs>(store, config, lanes)...};
  }
};

}  // namespace mpmpbd::rl::detail
