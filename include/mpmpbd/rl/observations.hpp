// What all environments show, group by group: (num_envs, frames, shape...), the newest frame last.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
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
template <class Group> inline constexpr bool is_drawn = requires { typename Group::Viewer; };
template <class Group> struct ViewerOf {
  struct type {
    template <class Config> type(Config const&, int) {}
  };
};
template <class Group>
  requires is_drawn<Group>
struct ViewerOf<Group> {
  using type = typename Group::Viewer;
};
// The viewer, and which of its lanes draws.
template <class Group> struct DrawnBy {};
template <class Group>
  requires is_drawn<Group>
struct DrawnBy<Group> {
  typename Group::Viewer* viewer;
  int lane;
};

template <class Element>
MPMPBD_HD void copy_numbers(Element const* from, std::int64_t count, Element* to) {
  for (std::int64_t k = 0; k < count; ++k) to[k] = from[k];
}

// Where the frames of a group lie, in the memory of the host or of a device, and how they are
// written. One lane calls.
template <class Group> struct GroupView : DrawnBy<Group> {
  using Element = typename ElementOf<Group>::type;
  Element *now, *last;
  std::int64_t size, frames;  // numbers of a frame; frames of an environment

  MPMPBD_HD std::int64_t stride() const { return frames * size; }
  MPMPBD_HD std::int64_t row(std::int64_t env) const { return env * stride(); }
  MPMPBD_HD std::int64_t newest(std::int64_t env) const { return row(env) + (frames - 1) * size; }

  MPMPBD_HD void keep(std::int64_t env) const {
    copy_numbers(now + row(env), stride(), last + row(env));
  }
  // Writes a new frame of an environment, after the others have moved up. A number that is not
  // finite is shown as 0; returns whether there is none.
  template <class Access, class Context>
  MPMPBD_HD bool observe(std::int64_t env, Access const& access, Context const& context) const {
    for (std::int64_t f = 0; f + 1 < frames; ++f)
      copy_numbers(now + row(env) + (f + 1) * size, size, now + row(env) + f * size);
    Element* const to = now + newest(env);
    bool finite = true;
    if constexpr (is_drawn<Group>) {
      this->viewer->draw(access, context, this->lane, to);
    } else {
      for (std::int64_t k = 0; k < size; ++k) to[k] = Element{};  // slots that are not in use
      Group::observe(access, context, to);
      for (std::int64_t k = 0; k < size; ++k) {
        if (to[k] - to[k] == 0) continue;
        to[k] = 0;
        finite = false;
      }
    }
    return finite;
  }
  // At the start of an episode all frames show the same.
  MPMPBD_HD void repeat(std::int64_t env) const {
    for (std::int64_t f = 0; f + 1 < frames; ++f)
      copy_numbers(now + newest(env), size, now + row(env) + f * size);
  }
};

// All groups of a task.
template <class List> struct GroupViews;
template <class... Gs> struct GroupViews<TypeList<Gs...>> : GroupView<Gs>... {
  template <class Group> GroupView<Group>& of() { return *this; }
  template <class Group> GroupView<Group> const& of() const { return *this; }
  template <class Function> void for_each(Function&& f) { (f(of<Gs>()), ...); }

  MPMPBD_HD void keep(std::int64_t env) const { (GroupView<Gs>::keep(env), ...); }
  MPMPBD_HD void repeat(std::int64_t env) const { (GroupView<Gs>::repeat(env), ...); }
  template <class Access, class Context>
  MPMPBD_HD bool observe(std::int64_t env, Access const& access, Context const& context) const {
    bool finite = true;
    ((finite = GroupView<Gs>::observe(env, access, context) && finite), ...);
    return finite;
  }
};

// A group in the memory of the host.
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
  // The newest frame of one environment.
  std::span<Element const> newest(std::int64_t env) const {
    return std::span(now).subspan((static_cast<std::size_t>(env + 1) * frames - 1) * size, size);
  }
  // `lane` is who draws.
  GroupView<Group> view([[maybe_unused]] int lane) {
    auto const n = static_cast<std::int64_t>(size), f = static_cast<std::int64_t>(frames);
    if constexpr (is_drawn<Group>)
      return {{&viewer, lane}, now.data(), last.data(), n, f};
    else
      return {{}, now.data(), last.data(), n, f};
  }
};

template <class List> struct AllGroups;
template <class... Gs> struct AllGroups<TypeList<Gs...>> {
  using type = std::tuple<GroupArrays<Gs>...>;
  using Views = GroupViews<TypeList<Gs...>>;

  template <class Store, class Config>
  static type make(Store const& store, Config const& config, int lanes) {
    return type{GroupArrays<Gs>(store, config, lanes)...};
  }
  static Views views(type& groups, int lane) {
    return {std::get<GroupArrays<Gs>>(groups).view(lane)...};
  }
};

}  // namespace mpmpbd::rl::detail
