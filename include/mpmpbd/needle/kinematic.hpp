// A needle whose motion is given: by a script, or by a commanded twist. Tissue cannot move it.
//
// A substep: `begin_*` sets the twist that contact feels; `finish_*` moves the pose, after
// everything else has been solved. Within the substep the motion is the constant twist, exactly.
#pragma once

#include <mpmpbd/needle/fields.hpp>
#include <mpmpbd/needle/script.hpp>

namespace mpmpbd::kinematic {

template <class View>
MPMPBD_HD void reset(View const& view, std::int64_t item, Script const& script) {
  using T = typename View::Scalar;
  needle::set_pose(view, item, cast_pose<T>(script.start));
  needle::set_twist(view, item, Twist<T>{});
  if constexpr (contains<typename View::List, needle::Offset>)
    view.template set<needle::Offset>(item, Vec3<T>{});
}

template <class View>
MPMPBD_HD void begin_scripted(View const& view, std::int64_t item, Script const& script, double t0,
                              double t1) {
  using T = typename View::Scalar;
  Twist<double> const twist = script.twist(t0, t1);
  needle::set_twist(view, item, Twist<T>{cast<T>(twist.linear), cast<T>(twist.angular)});
}
template <class View>
MPMPBD_HD void finish_scripted(View const& view, std::int64_t item, Script const& script,
                               double t1) {
  needle::set_pose(view, item, cast_pose<typename View::Scalar>(script.pose(t1)));
}

// A script that is shifted, at `speed` [m/s] at most, to a wanted offset [m]: how a hand corrects
// its way while it sees a marker move (SuturePath::offset_to). With offset 0 it is the script, bit
// for bit.
template <class View, class T>
MPMPBD_HD void begin_steered(View const& view, std::int64_t item, Script const& script, double t0,
                             double t1, Vec3<T> const& wanted, T speed) {
  T const dt = T(t1 - t0);
  Twist<T> twist{cast<T>(script.twist(t0, t1).linear), cast<T>(script.twist(t0, t1).angular)};
  Vec3<T> const d = wanted - view.template get<needle::Offset>(item);
  T const length = norm(d);
  Vec3<T> const shift = length > speed * dt ? (speed * dt / length) * d : d;
  twist.linear += T(1) / dt * shift;
  needle::set_twist(view, item, twist);
  view.template set<needle::Offset>(item, view.template get<needle::Offset>(item) + shift);
}
template <class View>
MPMPBD_HD void finish_steered(View const& view, std::int64_t item, Script const& script,
                              double t1) {
  auto pose = cast_pose<typename View::Scalar>(script.pose(t1));
  pose.position += view.template get<needle::Offset>(item);
  needle::set_pose(view, item, pose);
}

template <class View, class T>
MPMPBD_HD void begin_commanded(View const& view, std::int64_t item, Twist<T> const& wanted,
                               T acceleration, T angular_acceleration, T dt) {
  needle::set_twist(
      view, item,
      approach(needle::twist(view, item), wanted, acceleration, angular_acceleration, dt));
}
template <class View, class T>
MPMPBD_HD void finish_commanded(View const& view, std::int64_t item, T dt) {
  needle::set_pose(view, item, moved(needle::pose(view, item), needle::twist(view, item), dt));
}

}  // namespace mpmpbd::kinematic
