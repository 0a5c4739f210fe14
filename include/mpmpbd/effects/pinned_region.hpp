// Boxes of grid nodes with a prescribed motion: held in place, or driven like a grip or a plate.
#pragma once

#include <array>
#include <string_view>

#include <mpmpbd/effects/concepts.hpp>
#include <mpmpbd/effects/plane.hpp>

namespace mpmpbd {

namespace detail {
template <class Node, class K> MPMPBD_HD bool in_box(Node const& n, K const& k) {
  using T = typename Node::Scalar;
  auto const& x = n[node::Position{}];
  bool inside = true;
  for (int a = 0; a < 3; ++a)
    inside = inside && at_or_behind(x[a], k.low[a], T(-1)) && at_or_behind(x[a], k.high[a], T(1));
  return inside;
}
inline constexpr std::array<ParameterInfo, 9> box_info{
    {bound::any("low_x", "m"), bound::any("low_y", "m"), bound::any("low_z", "m"),
     bound::any("high_x", "m"), bound::any("high_y", "m"), bound::any("high_z", "m"),
     bound::any("velocity_x", "m/s"), bound::any("velocity_y", "m/s"),
     bound::any("velocity_z", "m/s")}};
// Refuses a corner `high` that is below `low` [m].
template <class K> void check_corners(std::string_view owner, K const& k) {
  for (std::size_t a = 0; a < 3; ++a) {
    ParameterInfo info = box_info[3 + a];
    info.low = static_cast<double>(k.low[a]);
    info.low_is_allowed = true;
    check_parameter(owner, info, static_cast<double>(k.high[a]));
  }
}
}  // namespace detail

// Nodes with low <= x <= high on every axis do not move; contact feels no mass there.
// Limits: what is held is the grid, so tissue within one cell of the box is held in part too.
struct PinnedRegion {
  using Role = role::Effect;
  static constexpr FixedString name = "pinned region";
  static constexpr Slot slot = Slot::at_boundary;
  using Reads = Fields<node::Position, node::Velocity>;
  using Writes = Fields<node::Velocity>;

  template <class T> struct Parameters {
    T low[3];   // [m]
    T high[3];  // [m]
  };
  static constexpr std::array<ParameterInfo, 6> parameter_info{
      {detail::box_info[0], detail::box_info[1], detail::box_info[2], detail::box_info[3],
       detail::box_info[4], detail::box_info[5]}};
  template <class T> static void check_together(Parameters<T> const& k) {
    detail::check_corners("PinnedRegion", k);
  }

  template <class Node, class K, class T>
  MPMPBD_HD static void apply(Node& n, K const& k, Tick<T> const&) {
    if (!detail::in_box(n, k)) return;
    for (int a = 0; a < 3; ++a) hold_axis(n, a);
  }
};

// Nodes inside the box move with a given velocity. The box itself stands still: a grip that travels is
// moved by its owner, who sets low and high between steps.
struct DrivenRegion {
  using Role = role::Effect;
  static constexpr FixedString name = "driven region";
  static constexpr Slot slot = Slot::at_boundary;
  static constexpr bool drives = true;  // may add energy
  using Reads = Fields<node::Position, node::Velocity>;
  using Writes = Fields<node::Velocity>;

  template <class T> struct Parameters {
    T low[3];       // [m]
    T high[3];      // [m]
    T velocity[3];  // [m/s]
  };
  static constexpr auto parameter_info = detail::box_info;
  template <class T> static void check_together(Parameters<T> const& k) {
    detail::check_corners("DrivenRegion", k);
  }

  template <class Node, class K, class T>
  MPMPBD_HD static void apply(Node& n, K const& k, Tick<T> const&) {
    if (!detail::in_box(n, k)) return;
    for (int a = 0; a < 3; ++a) {
      hold_axis(n, a);
      n[node::Velocity{}][a] = k.velocity[a];
    }
  }
};

}  // namespace mpmpbd
