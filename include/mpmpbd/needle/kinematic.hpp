// A needle whose motion is given: by a script, or by a commanded twist. Tissue cannot move it.
//
// A substep: `begin_*` sets the twist that contact feels; `finish_*` moves the pose, after everything
// else has been solved. Within the substep the motion is the constant twist, exactly.
#pragma once

#include <mpmpbd/needle/fields.hpp>
#include <mpmpbd/needle/script.hpp>

namespace mpmpbd::kinematic {

template <class View> MPMPBD_HD void reset(View const& view, std::int64_t item, Script const& script) {
  using T = typename View::Scalar;
  needle::set_pose(view, item, cast_pose<T>(script.start));
  needle::set_twist(view, item, Twist<T>{});
}

template <class View>
MPMPBD_HD void begin_scripted(View const& view, std::int64_t item, Script const& script, double t0, double t1) {
  using T = typename View::Scalar;
  Twist<double> const twist = script.twist(t0, t1);
  needle::set_twist(view, item, Twist<T>{cast<T>(twist.linear), cast<T>(twist.angular)});
}
template <class View>
MPMPBD_HD void finish_scripted(View const& view, std::int64_t item, Script const& script, double t1) {
  needle::set_pose(view, item, cast_pose<typename View::Scalar>(script.pose(t1)));
}

template <class View, class T>
MPMPBD_HD void begin_commanded(View const& view, std::int64_t item, Twist<T> const& wanted, T acceleration,
                               T angular_acceleration, T dt) {
  needle::set_twist(view, item, approach(needle::twist(view, item), wanted, acceleration, angular_acceleration, dt));
}
template <class View, class T> MPMPBD_HD void finish_commanded(View const& view, std::int64_t item, T dt) {
  needle::set_pose(view, item, moved(needle::pose(view, item), needle::twist(view, item), dt));
}

}  // namespace mpmpbd::kinematic
