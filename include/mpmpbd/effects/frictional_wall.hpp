// An axis-aligned wall with Coulomb friction: what presses on it sticks or slides.
#pragma once

#include <array>

#include <mpmpbd/effects/walls.hpp>

namespace mpmpbd {

// A node at or behind the plane that moves into it loses its normal velocity, u, and up to mu u of its velocity
// along the wall: |dv_t| <= mu |dv_n|, Coulomb's law for the impulses of one substep, independent of its length. It
// lets go freely.
// Limits: acts on nodes, so put it on a node plane; its friction has no memory: at rest it holds because in every
// substep what pulls stays below mu times what presses. Contact with a needle feels its normal direction as held,
// the others as free.
template <int axis, Side side> struct FrictionalWall {
  static_assert(axis >= 0 && axis < 3,
                "mpmpbd FrictionalWall<axis, side>: axis is 0, 1 or 2 for x, y or z");
  using Role = role::Effect;
  static constexpr auto name = detail::wall_name<axis, side>(FixedString("frictional"));
  static constexpr Slot slot = Slot::at_boundary;
  using Reads = Fields<node::Position, node::Velocity>;
  using Writes = Fields<node::Velocity>;

  template <class T> struct Parameters {
    T position;     // of the plane along its axis [m]
    T coefficient;  // mu [1]
  };
  static constexpr std::array<ParameterInfo, 2> parameter_info{
      {bound::any("position", "m"), bound::not_negative("coefficient", "1")}};

  template <class Node, class K, class T>
  MPMPBD_HD static void apply(Node& n, K const& k, Tick<T> const&) {
    constexpr T inward = side == Side::low ? T(1) : T(-1);
    if (!at_or_behind(n[node::Position{}][axis], k.position, inward)) return;
    auto& v = n[node::Velocity{}];
    T const into = -v[axis] * inward;
    if (into < T(0)) return;
    hold_axis(n, axis);  // v is now along the wall
    T const speed = norm(v), stopped = k.coefficient * into;
    if (speed > T(0)) v *= speed > stopped ? T(1) - stopped / speed : T(0);
  }
};

}  // namespace mpmpbd
