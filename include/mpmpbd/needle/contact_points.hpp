// The needle's points in the form that the exchange of momentum takes.
//
// Point 0 is the tip's axial point (one-sided, capped); points 1... lie along the wire from the tip
// to the blunt end. Contact, force cap, pressure and coverage are filled in by others.
#pragma once

#include <mpmpbd/coupling/contact_law.hpp>
#include <mpmpbd/needle/points.hpp>

namespace mpmpbd {

template <class T> MPMPBD_HD constexpr int contact_points(ArcPoints<T> const& points) {
  return points.count() + 1;
}

template <class T>
MPMPBD_HD void place_contact_point(ContactPoint<T>& p, int i, Arc<T> const& arc,
                                   ArcPoints<T> const& points, Pose<T> const& pose) {
  T const s = i == 0 ? T(0) : points.s(i - 1);
  p.position = to_world(pose, arc.point(s));
  p.axis = quaternion::rotate(pose.orientation, arc.tangent(s));
  p.length = i == 0 ? T(0) : points.ds(i - 1);
  p.radius = arc.wire_radius_at(s);
  p.segment = -1;
  p.along = T(0);
}

}  // namespace mpmpbd
