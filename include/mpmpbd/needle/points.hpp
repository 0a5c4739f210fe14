// The needle as contact sees it: points along the arc, each with position, tangent and mean
// velocity.
#pragma once

#include <mpmpbd/geometry/arc.hpp>
#include <mpmpbd/geometry/pose.hpp>

namespace mpmpbd {

template <class T> struct NeedlePoint {
  Vec3<T> position;  // [m]
  Vec3<T> tangent;   // unit, towards the tip: the direction in which the needle is driven
  Vec3<T>
      velocity;  // mean over the substep, so that position + dt * velocity is the next position [m/s]
  T ds;          // length of wire that it stands for [m]
  T wire_radius;  // [m]
};

// Point i of the needle; 0 is the tip, the last one the blunt end that holds the thread.
template <class T>
MPMPBD_HD NeedlePoint<T> needle_point(Arc<T> const& arc, ArcPoints<T> const& points, int i,
                                      Pose<T> const& pose, Sweep<T> const& sweep) {
  T const s = points.s(i);
  Vec3<T> const x = to_world(pose, arc.point(s));
  return {x, quaternion::rotate(pose.orientation, arc.tangent(s)), sweep.mean_velocity(x),
          points.ds(i), arc.wire_radius_at(s)};
}

// The blunt end, where a thread is swaged: a bead there has this position, and velocity V + omega x
// r in the solve. `arm` is r, from the body's origin.
template <class T> struct SwagePoint {
  Vec3<T> position;
  Vec3<T> velocity;
  Vec3<T> direction;  // along which the wire goes on into the thread: away from the tip
  Vec3<T> arm;
};
template <class T>
MPMPBD_HD SwagePoint<T> swage_point(Arc<T> const& arc, Pose<T> const& pose, Sweep<T> const& sweep) {
  Vec3<T> const x = to_world(pose, arc.point(arc.length()));
  return {x, sweep.mean_velocity(x),
          -quaternion::rotate(pose.orientation, arc.tangent(arc.length())), x - pose.position};
}

}  // namespace mpmpbd
