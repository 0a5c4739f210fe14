// A plane: a point on it and the unit normal of its free side.
#pragma once

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd {

template <class T> struct Plane {
  Vec3<T> point;
  Vec3<T> normal;

  // Positive on the side of the normal [m].
  MPMPBD_HD T distance(Vec3<T> const& x) const { return dot(normal, x - point); }
  MPMPBD_HD Vec3<T> nearest(Vec3<T> const& x) const { return x - distance(x) * normal; }
};

}  // namespace mpmpbd
