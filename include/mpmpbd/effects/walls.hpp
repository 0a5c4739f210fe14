// Axis-aligned walls: grid nodes at or behind a plane are held as the wall's condition says.
#pragma once

#include <array>

#include <mpmpbd/core/joined.hpp>
#include <mpmpbd/effects/concepts.hpp>
#include <mpmpbd/effects/plane.hpp>

namespace mpmpbd {

// Conditions: `hold(node, axis, inward)` acts on a node at a wall; inward is +1 or -1, the direction
// along the axis from the wall into the domain.
struct Sticky {  // nothing moves
  static constexpr FixedString name = "sticky";
  template <class Node, class T> MPMPBD_HD static void hold(Node& n, int, T) {
    for (int a = 0; a < 3; ++a) hold_axis(n, a);
  }
};
struct Slip {  // nothing moves through or away, everything slides
  static constexpr FixedString name = "slip";
  template <class Node, class T> MPMPBD_HD static void hold(Node& n, int axis, T) {
    hold_axis(n, axis);
  }
};
struct Separating {  // nothing moves through; a node at rest on the wall counts as held for contact
  static constexpr FixedString name = "separating";
  template <class Node, class T> MPMPBD_HD static void hold(Node& n, int axis, T inward) {
    if (n[node::Velocity{}][axis] * inward <= T(0)) hold_axis(n, axis);
  }
};

template <class C>
concept WallCondition = requires(Local<float, Fields<node::Velocity, node::InverseMass>>& n) {
  C::hold(n, 0, 1.0f);
};

enum class Side { low, high };

namespace detail {
// "sticky wall x low"
template <int axis, Side side, std::size_t n>
constexpr auto wall_name(FixedString<n> const& condition) {
  constexpr FixedString<4> axes[] = {" x ", " y ", " z "};
  if constexpr (side == Side::low)
    return joined(condition, FixedString(" wall"), axes[axis], FixedString("low"));
  else
    return joined(condition, FixedString(" wall"), axes[axis], FixedString("high"));
}
}  // namespace detail

// One wall: a plane across `axis` (0, 1, 2 for x, y, z) that bounds the domain on its low or high side.
// Limits: a wall has no friction between stick and slip; it acts on nodes, so put it on a node plane.
template <class Condition, int axis, Side side> struct Wall {
  static_assert(
      WallCondition<Condition>,
      "mpmpbd Wall<Condition, axis, side>: a condition gives `template <class Node, class T> "
      "MPMPBD_HD static void hold(Node& n, int axis, T inward)`; write Sticky, Slip or "
      "Separating");
  static_assert(axis >= 0 && axis < 3,
                "mpmpbd Wall<Condition, axis, side>: axis is 0, 1 or 2 for x, y or z");

  using Role = role::Effect;
  static constexpr auto name = detail::wall_name<axis, side>(Condition::name);
  static constexpr Slot slot = Slot::at_boundary;
  using Reads = Fields<node::Position, node::Velocity>;
  using Writes = Fields<node::Velocity>;

  template <class T> struct Parameters {
    T position;  // of the plane along its axis [m]
  };
  static constexpr std::array<ParameterInfo, 1> parameter_info{{bound::any("position", "m")}};

  template <class Node, class K, class T>
  MPMPBD_HD static void apply(Node& n, K const& k, Tick<T> const&) {
    constexpr T inward = side == Side::low ? T(1) : T(-1);
    if (at_or_behind(n[node::Position{}][axis], k.position, inward))
      Condition::hold(n, axis, inward);
  }
};

// Six walls around a box.
template <class Condition> struct Walls {
  static_assert(
      WallCondition<Condition>,
      "mpmpbd Walls<Condition>: a condition gives `template <class Node, class T> MPMPBD_HD "
      "static void hold(Node& n, int axis, T inward)`; write Sticky, Slip or Separating");

  using Role = role::Effect;
  static constexpr auto name = joined(Condition::name, FixedString(" walls"));
  static constexpr Slot slot = Slot::at_boundary;
  using Reads = Fields<node::Position, node::Velocity>;
  using Writes = Fields<node::Velocity>;

  template <class T> struct Parameters {
    T low[3];   // [m]
    T high[3];  // [m]
  };
  static constexpr std::array<ParameterInfo, 6> parameter_info{
      {bound::any("low_x", "m"), bound::any("low_y", "m"), bound::any("low_z", "m"),
       bound::any("high_x", "m"), bound::any("high_y", "m"), bound::any("high_z", "m")}};

  template <class Node, class K, class T>
  MPMPBD_HD static void apply(Node& n, K const& k, Tick<T> const&) {
    for (int a = 0; a < 3; ++a) {
      if (at_or_behind(n[node::Position{}][a], k.low[a], T(1))) Condition::hold(n, a, T(1));
      if (at_or_behind(n[node::Position{}][a], k.high[a], T(-1))) Condition::hold(n, a, T(-1));
    }
  }
};

}  // namespace mpmpbd
