// What a needle remembers: one item per needle.
#pragma once

#include <mpmpbd/core/table.hpp>
#include <mpmpbd/geometry/pose.hpp>

namespace mpmpbd {

struct Needles {
  static constexpr FixedString name = "needle";
  static constexpr std::int64_t fewest_slots = 1;
};

namespace needle {
struct Position : Field<"x", "m", Vector, Needles> {};          // of the arc's centre
struct Orientation : Field<"q", "1", Numbers<4>, Needles> {};   // unit quaternion (w, x, y, z)
struct LinearVelocity : Field<"v", "m/s", Vector, Needles> {};  // of the arc's centre
struct AngularVelocity : Field<"omega", "rad/s", Vector, Needles> {};  // world axes

// Only of a needle that is steered: how far its script has been shifted so far.
struct Offset : Field<"offset", "m", Vector, Needles> {};

using State = Fields<Position, Orientation, LinearVelocity, AngularVelocity>;
using SteeredState = Fields<Position, Orientation, LinearVelocity, AngularVelocity, Offset>;

template <class View> MPMPBD_HD auto pose(View const& view, std::int64_t item) {
  return Pose<typename View::Scalar>{view.template get<Position>(item),
                                     view.template get<Orientation>(item)};
}
template <class View> MPMPBD_HD auto twist(View const& view, std::int64_t item) {
  return Twist<typename View::Scalar>{view.template get<LinearVelocity>(item),
                                      view.template get<AngularVelocity>(item)};
}
template <class View, class T>
MPMPBD_HD void set_pose(View const& view, std::int64_t item, Pose<T> const& pose) {
  view.template set<Position>(item, pose.position);
  view.template set<Orientation>(item, pose.orientation);
}
template <class View, class T>
MPMPBD_HD void set_twist(View const& view, std::int64_t item, Twist<T> const& twist) {
  view.template set<LinearVelocity>(item, twist.linear);
  view.template set<AngularVelocity>(item, twist.angular);
}
}  // namespace needle

}  // namespace mpmpbd
