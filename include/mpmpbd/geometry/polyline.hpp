// A line of straight pieces through points that something else owns: `point(i)` gives point i.
#pragma once

#include <cstdint>

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd {

template <class T> struct OnPolyline {
  std::int64_t piece;  // between points `piece` and `piece + 1`; -1 when the line has no point
  T weight;            // of point `piece + 1`
  T distance;          // [m]
  Vec3<T> point;
};

// The nearest point of the segment a-b, as the weight of b. A segment of no length is its point a.
template <class T>
MPMPBD_HD T nearest_on_segment(Vec3<T> const& a, Vec3<T> const& b, Vec3<T> const& x) {
  Vec3<T> const e = b - a;
  T const square = dot(e, e);
  return square > T(0) ? clamp(dot(x - a, e) / square, T(0), T(1)) : T(0);
}

// How far the segment a-b is [m].
template <class T>
MPMPBD_HD T distance_to_segment(Vec3<T> const& a, Vec3<T> const& b, Vec3<T> const& x) {
  return norm(x - add_product(a, nearest_on_segment(a, b, x), b - a));
}

// The nearest point of a polyline of `count` points; of equally near pieces the first.
template <class Points, class T>
MPMPBD_HD OnPolyline<T> nearest_on_polyline(Points const& point, std::int64_t count,
                                            Vec3<T> const& x) {
  OnPolyline<T> best{-1, T(0), T(0), Vec3<T>{}};
  if (count <= 0) return best;
  Vec3<T> a = point(std::int64_t{0});
  best = {0, T(0), norm(x - a), a};
  for (std::int64_t i = 0; i + 1 < count; ++i) {
    Vec3<T> const b = point(i + 1);
    T const w = nearest_on_segment(a, b, x);
    Vec3<T> const p = add_product(a, w, b - a);
    T const d = norm(x - p);
    if (d < best.distance) best = {i, w, d, p};
    a = b;
  }
  return best;
}

template <class T, class Points>
MPMPBD_HD T polyline_length(Points const& point, std::int64_t count) {
  T length = T(0);
  for (std::int64_t i = 0; i + 1 < count; ++i) length += norm(point(i + 1) - point(i));
  return length;
}

// Walks along a polyline of `count` >= 2 points: uses n points, the first at its start, each a
// distance `step` [m] from the one before; on and on along the last piece.
template <class T, class Use>
MPMPBD_HD void walk_polyline(Vec3<T> const* line, int count, T step, std::int64_t n,
                             Use const& use) {
  Vec3<T> at = line[0];
  int piece = 1;
  for (std::int64_t i = 0; i < n; ++i) {
    use(i, at);
    while (piece + 1 < count && norm(line[piece] - at) < step) ++piece;
    // Where the piece leaves the ball of radius `step` around this point.
    Vec3<T> const along = direction(line[piece] - line[piece - 1]);
    Vec3<T> const arm = line[piece - 1] - at;
    T const b = dot(arm, along);
    T const reach = -b + sqrt(max(b * b + step * step - dot(arm, arm), T(0)));
    at = line[piece - 1] + reach * along;
  }
}

}  // namespace mpmpbd
