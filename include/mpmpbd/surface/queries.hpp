// Questions to the sheet: is a point inside, how far is the surface, where does a path go through
// it.
#pragma once

#include <mpmpbd/surface/columns.hpp>

namespace mpmpbd {

// Whether x is inside the closed sheet: the parity of the crossings of the ray from x along +z. A
// ray through edges and vertices counts each once. A point exactly on the sheet may be either.
//
// Here as below, the lanes of a group share the triangles; all of them ask for the same point and get
// the same answer, that of one lane.
template <class Group_, class S, class C, class T>
MPMPBD_HD bool is_inside(Group_ const& group, S const& sheet, C const& columns, Vec3<T> const& x) {
  auto const line = SheetLine<T>::along(x, 2);
  int crossings = 0;
  columns.for_each(group, x, x, [&](std::int64_t k) {
    auto const t = sheet.triangle(k);
    auto const hit = cross_projected(line.project(t.a), line.project(t.b), line.project(t.c));
    if (hit.hit && hit.z > T(0)) ++crossings;
  });
  crossings = group.sum(crossings);
  return crossings % 2 == 1;
}
template <class S, class C, class T>
MPMPBD_HD bool is_inside(S const& sheet, C const& columns, Vec3<T> const& x) {
  return is_inside(Solo{}, sheet, columns, x);
}

template <class T> struct SurfacePoint {
  bool found;  // within reach
  bool inside;
  T distance;           // to the surface, negative inside [m]; +-reach when not found
  SurfaceMark<T> mark;  // the nearest material point of the surface
  Vec3<T> point;        // where it is [m]
  Vec3<T> normal;       // unit, outwards
};

namespace detail {
// The nearest triangle that one lane has seen.
template <class T> struct NearestTriangle {
  std::int64_t number;  // -1: none within reach
  T distance;           // to it, or the reach [m]

  template <class S> MPMPBD_HD void look(S const& sheet, std::int64_t k, Vec3<T> const& x) {
    auto const t = sheet.triangle(k);
    for (int a = 0; a < 3; ++a)
      if (beyond(t.a[a], t.b[a], t.c[a], x[a])) return;
    T const d = norm(x - t.at(nearest_on_triangle(t, x).weights));
    if (d < distance || (d == distance && (number < 0 || k < number))) *this = {k, d};
  }
  // That of all lanes.
  template <class Group_> MPMPBD_HD NearestTriangle of_all(Group_ const& group) const {
    constexpr std::int64_t none = INT64_MAX;
    T const least = group.min(distance);
    std::int64_t const first = group.min(number >= 0 && distance == least ? number : none);
    return {first == none ? -1 : first, least};
  }

 private:
  // Whether the box around a triangle is too far along one axis. What rounding adds to a corner is
  // allowed for, so that the order in which triangles come does not matter.
  MPMPBD_HD bool beyond(T a, T b, T c, T x) const {
    T const low = min(a, min(b, c)), high = max(a, max(b, c));
    T const slack = T(16) * epsilon<T> * max(abs(low), abs(high));
    return max(low - x, x - high) > distance + slack;
  }
};

// What there is to know of a point x, `inside` the sheet or not, once its nearest triangle is known.
template <class S, class T>
MPMPBD_HD SurfacePoint<T> surface_point(S const& sheet, NearestTriangle<T> const& nearest,
                                        Vec3<T> const& x, bool inside) {
  SurfacePoint<T> s{};
  s.found = nearest.number >= 0;
  s.inside = inside;
  s.distance = inside ? -nearest.distance : nearest.distance;
  s.mark = {nearest.number, {}};
  if (!s.found) return s;
  auto const t = sheet.triangle(nearest.number);
  auto const on = nearest_on_triangle(t, x);
  s.mark.weights = on.weights;
  s.point = t.at(on.weights);
  s.normal = direction(t.area_normal());
  // Beside an edge or a vertex the face's normal is one of several; the way to the point is not.
  if (on.feature != Feature::face) {
    T const size = abs(t.b[0] - t.a[0]) + abs(t.b[1] - t.a[1]) + abs(t.b[2] - t.a[2]);
    if (nearest.distance > T(1e-3) * size) s.normal = T(1) / s.distance * (x - s.point);
  }
  return s;
}
}  // namespace detail

// The nearest point of the surface, looked for up to `reach`; of equally near triangles the lowest
// number. `inside`: is_inside(x), where that is known already.
template <class Group_, class S, class C, class T>
MPMPBD_HD SurfacePoint<T> nearest_on_sheet(Group_ const& group, S const& sheet, C const& columns,
                                           Vec3<T> const& x, T reach, bool inside) {
  detail::NearestTriangle<T> nearest{-1, reach};
  auto const look = [&](std::int64_t k) { nearest.look(sheet, k, x); };
  // First the point's own column; then only as far as what was found there.
  columns.for_each(group, x, x, look);
  nearest = nearest.of_all(group);
  T const r = nearest.distance;
  Vec3<T> const box{{r, r, r}};
  columns.for_each(group, x - box, x + box, look);
  return detail::surface_point(sheet, nearest.of_all(group), x, inside);
}
template <class Group_, class S, class C, class T>
MPMPBD_HD SurfacePoint<T> nearest_on_sheet(Group_ const& group, S const& sheet, C const& columns,
                                           Vec3<T> const& x, T reach) {
  return nearest_on_sheet(group, sheet, columns, x, reach, is_inside(group, sheet, columns, x));
}
template <class S, class C, class T>
MPMPBD_HD SurfacePoint<T> nearest_on_sheet(S const& sheet, C const& columns, Vec3<T> const& x,
                                           T reach) {
  return nearest_on_sheet(Solo{}, sheet, columns, x, reach);
}

template <class T> struct Crossing {
  T share;       // of the path, (0, 1]
  bool leaving;  // from inside to outside
  SurfaceMark<T> mark;
};

template <class T, int Capacity> struct Crossings {
  int count;
  bool more;  // than `Capacity`; the first ones are kept
  Crossing<T> list[Capacity];
};

namespace detail {
// In and out must come in turn. Where a path meets two faces at the same place (it grazes an edge
// or a corner), rounding may have put them in the wrong order.
template <class T, int Capacity>
MPMPBD_HD void put_in_turn(Crossings<T, Capacity>& found, bool inside) {
  for (int i = 0; i < found.count; ++i) {
    int j = i;
    while (j < found.count && found.list[j].leaving != inside) ++j;
    if (j == found.count) return;
    Crossing<T> const next = found.list[j];
    for (; j > i; --j) found.list[j] = found.list[j - 1];
    found.list[i] = next;
    inside = !inside;
  }
}
}  // namespace detail

// Where the path from p to q goes through the sheet, in order, in and out in turn. The end belongs
// to the path, the start does not. A way through an edge or a vertex counts once.
template <int Capacity = 8, class S, class C, class T>
MPMPBD_HD Crossings<T, Capacity> crossings(S const& sheet, C const& columns, Vec3<T> const& p,
                                           Vec3<T> const& q) {
  Crossings<T, Capacity> found{};
  auto const line = SheetLine<T>::between(p, q);
  if (!line.usable()) return found;
  // A little wider than the path: a crossing that rounding has moved to a neighbour is not lost.
  T const slack = T(16) * epsilon<T> * (norm(p) + norm(q));
  Vec3<T> low, high;
  for (int a = 0; a < 3; ++a) {
    low[a] = min(p[a], q[a]) - slack;
    high[a] = max(p[a], q[a]) + slack;
  }
  int balance = 0;
  columns.for_each(low, high, [&](std::int64_t k) {
    auto const t = sheet.triangle(k);
    for (int a = 0; a < 3; ++a)
      if (min(t.a[a], min(t.b[a], t.c[a])) > high[a] || max(t.a[a], max(t.b[a], t.c[a])) < low[a])
        return;
    auto const hit = cross_projected(line.project(t.a), line.project(t.b), line.project(t.c));
    T const share = hit.z / line.reach;
    if (!hit.hit || !(share > T(0)) || !(share <= T(1))) return;
    for (int i = 0; i < found.count; ++i)
      if (found.list[i].mark.triangle == k) return;  // seen in another column
    // Insertion by share, then by triangle.
    int at = found.count;
    while (at > 0 && (found.list[at - 1].share > share ||
                      (found.list[at - 1].share == share && found.list[at - 1].mark.triangle > k)))
      --at;
    if (found.count == Capacity)
      found.more = true;
    else
      ++found.count;
    for (int i = found.count - 1; i > at; --i) found.list[i] = found.list[i - 1];
    if (at < Capacity) found.list[at] = {share, hit.leaving, {k, hit.weights}};
    balance += hit.leaving ? -1 : 1;
  });
  if (found.count > 1 && !found.more)
    detail::put_in_turn(found, balance != 0 ? balance < 0 : is_inside(sheet, columns, p));
  return found;
}

// The material point of the surface nearest to x, wherever it is: how markers are made. Tests all
// triangles.
template <class S, class T> MPMPBD_HD SurfaceMark<T> mark_at(S const& sheet, Vec3<T> const& x) {
  SurfaceMark<T> best{-1, {{T(0), T(0)}}};
  T distance = T(0);
  for (std::int64_t k = 0; k < sheet.triangles; ++k) {
    auto const t = sheet.triangle(k);
    auto const on = nearest_on_triangle(t, x);
    T const d = norm(x - t.at(on.weights));
    if (best.triangle < 0 || d < distance) {
      best = {k, on.weights};
      distance = d;
    }
  }
  return best;
}

}  // namespace mpmpbd
