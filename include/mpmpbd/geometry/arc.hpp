// The needle's shape: a circular arc of wire with a pointed tip.
//
// Body frame: the arc's centre is the origin, the arc lies in the x-y plane and turns about +z. The
// tip is at (radius, 0, 0) and the wire follows behind it, so that a positive turn about z drives
// it forward. A point is named by its arc length s [m] from the tip, 0 to `length()`.
#pragma once

#include <cstdint>

#include <mpmpbd/core/matrix.hpp>
#include <mpmpbd/core/parameters.hpp>

namespace mpmpbd {

template <class T> struct Arc {
  T radius;       // of the centre line [m]
  T angle;        // from tip to blunt end [rad], up to a full turn
  T wire_radius;  // [m]
  T taper;        // length over which the wire grows from a point to its full radius [m]

  MPMPBD_HD constexpr T length() const { return radius * angle; }

  MPMPBD_HD Vec3<T> point(T s) const {
    T const a = s / radius;
    return {{radius * cos(a), -radius * sin(a), T(0)}};
  }
  // Unit, towards the tip.
  MPMPBD_HD Vec3<T> tangent(T s) const {
    T const a = s / radius;
    return {{sin(a), cos(a), T(0)}};
  }
  MPMPBD_HD T wire_radius_at(T s) const {
    return s < taper ? wire_radius * (max(s, T(0)) / taper) : wire_radius;
  }

  // The arc length of the point nearest to x (body frame). In the gap between the ends it is the
  // nearer end (the tip when both are equal); on the axis, where all are equal, the tip.
  MPMPBD_HD T nearest(Vec3<T> const& x) const {
    T const turn = T(2) * pi<T>;
    T a = -atan2(x[1], x[0]);  // -pi..pi; counted from the tip backwards it has no gap at pi
    if (x[0] == T(0) && x[1] == T(0)) a = T(0);
    if (a < T(0)) a += turn;
    if (a <= angle) return min(radius * a, length());
    return a - angle < turn - a ? length() : T(0);
  }
  MPMPBD_HD T distance(Vec3<T> const& x) const { return norm(x - point(nearest(x))); }
};

// Where along the arc the contact points are: from the tip to the blunt end at equal spacing, the least
// that is about a cell or more (a long arc: dx; 1.3 dx at most above 3 dx; an arc shorter than 1.9 dx: its
// two ends). Closer points carry impulses that alternate along a needle pushed sideways (decision 7).
template <class T> struct ArcPoints {
  T length;
  int intervals;

  // A tenth of a cell may be lacking, so that rounding does not decide about arcs of whole cells.
  MPMPBD_HD static ArcPoints over(Arc<T> const& arc, T dx) {
    int const cells = static_cast<int>(arc.length() / dx + T(0.1));
    return {arc.length(), cells > 1 ? cells : 1};
  }
  MPMPBD_HD constexpr int count() const { return intervals + 1; }
  MPMPBD_HD constexpr T spacing() const { return length / T(intervals); }
  // The last point is the blunt end itself, not a rounded neighbour of it.
  MPMPBD_HD constexpr T s(int i) const { return i == intervals ? length : T(i) * spacing(); }
  // Length of wire that point i stands for; the sum is the arc's length.
  MPMPBD_HD constexpr T ds(int i) const {
    return (i == 0 || i == intervals ? T(0.5) : T(1)) * spacing();
  }
};

// Refuses an arc that cannot be, by name, value and bound.
template <class T> void check_arc(Arc<T> const& arc, char const* owner = "Arc") {
  auto const radius = static_cast<double>(arc.radius);
  check_parameter(owner, bound::positive("radius", "m"), radius);
  check_parameter(owner, {"angle", "rad", 0.0, 2.0 * static_cast<double>(pi<T>), false, true},
                  static_cast<double>(arc.angle));
  check_parameter(owner, {"wire_radius", "m", 0.0, radius, true, false},
                  static_cast<double>(arc.wire_radius));
  check_parameter(owner, {"taper", "m", 0.0, static_cast<double>(arc.length()), true, true},
                  static_cast<double>(arc.taper));
}

}  // namespace mpmpbd
