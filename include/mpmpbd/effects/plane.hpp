// Which grid nodes are on a plane.
#pragma once

#include <mpmpbd/core/math.hpp>

namespace mpmpbd {

// Whether a node at x [m] is on the plane or behind it: at x <= plane where inward is 1, at x >= plane where it is -1.
// Coordinates of nodes and planes are rounded: a node counts as on a plane that is off by four units in the last place, or a
// floor would sink by a cell.
template <class T> MPMPBD_HD bool at_or_behind(T x, T plane, T inward) {
  return (x - plane) * inward <= 4 * epsilon<T> * abs(plane);
}

}  // namespace mpmpbd
