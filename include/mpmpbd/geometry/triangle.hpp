// Triangles: nearest point, and the crossing of a line with a tie-break that closes every seam.
#pragma once

#include <cstdint>

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd {

template <class T> struct Triangle {
  Vec3<T> a, b, c;  // counter-clockwise seen from outside

  // Normal whose length is twice the area [m^2].
  MPMPBD_HD constexpr Vec3<T> area_normal() const { return cross(b - a, c - a); }
  MPMPBD_HD T area() const { return T(0.5) * norm(area_normal()); }
  // weights: of b and c; that of a is the rest.
  MPMPBD_HD constexpr Vec3<T> at(Vec<T, 2> const& w) const {
    return add_product(add_product(a, w[0], b - a), w[1], c - a);
  }
};

enum class Feature : std::int64_t { face, edge, vertex };

template <class T> struct OnTriangle {
  Vec<T, 2> weights;  // of b and c
  Feature feature;
};

// The nearest point of a triangle (Ericson, Real-Time Collision Detection, 2005, section 5.1.5). A
// triangle without area is treated as its edges.
template <class T>
MPMPBD_HD OnTriangle<T> nearest_on_triangle(Triangle<T> const& t, Vec3<T> const& p) {
  Vec3<T> const ab = t.b - t.a, ac = t.c - t.a;
  Vec3<T> const ap = p - t.a, bp = p - t.b, cp = p - t.c;
  T const d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
          d6 = dot(ac, cp);
  if (d1 <= T(0) && d2 <= T(0)) return {{{T(0), T(0)}}, Feature::vertex};
  if (d3 >= T(0) && d4 <= d3) return {{{T(1), T(0)}}, Feature::vertex};
  if (d6 >= T(0) && d5 <= d6) return {{{T(0), T(1)}}, Feature::vertex};
  T const vc = d1 * d4 - d3 * d2;
  if (vc <= T(0) && d1 >= T(0) && d3 <= T(0)) return {{{d1 / (d1 - d3), T(0)}}, Feature::edge};
  T const vb = d5 * d2 - d1 * d6;
  if (vb <= T(0) && d2 >= T(0) && d6 <= T(0)) return {{{T(0), d2 / (d2 - d6)}}, Feature::edge};
  T const va = d3 * d6 - d5 * d4;
  if (va <= T(0) && d4 - d3 >= T(0) && d5 - d6 >= T(0)) {
    T const w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {{{T(1) - w, w}}, Feature::edge};
  }
  T const scale = T(1) / (va + vb + vc);
  return {{{vb * scale, vc * scale}}, Feature::face};
}

namespace detail {
// The sign of a b - c d without rounding: in double for float, with the products' remainders for
// double.
MPMPBD_HD inline int sign_of_difference(float a, float b, float c, float d) {
  double const e = double(a) * double(b) - double(c) * double(d);
  return e > 0.0 ? 1 : (e < 0.0 ? -1 : 0);
}
MPMPBD_HD inline int sign_of_difference(double a, double b, double c, double d) {
  double const p = a * b, q = c * d;
  double const e = (p - q) + (::fma(a, b, -p) - ::fma(c, d, -q));
  return e > 0.0 ? 1 : (e < 0.0 ? -1 : 0);
}
template <class T> MPMPBD_HD int sign_of(T a) { return a > T(0) ? 1 : (a < T(0) ? -1 : 0); }
}  // namespace detail

// A directed line, prepared for many triangles: the longest axis of the direction is z', and points
// are sheared so that the line is the z' axis (Woop, Benthin, Wald, JCGT 2(1), 2013). A vertex gets
// the same coordinates in every triangle that has it, and the side of an edge is decided without
// rounding; where the line meets an edge or a vertex exactly, it counts as shifted by (e, e^2) for
// an endlessly small e (Edelsbrunner and Muecke, ACM TOG 9(1), 1990). So a line through a closed
// sheet crosses each seam once.
template <class T> struct SheetLine {
  Vec3<T> origin;
  int kx, ky, kz;
  T shear_x, shear_y;
  T reach;  // z' of the end point

  // From p to q; `usable()` is false when they are equal.
  MPMPBD_HD static SheetLine between(Vec3<T> const& p, Vec3<T> const& q) {
    Vec3<T> const d = q - p;
    int kz = 0;
    if (abs(d[1]) > abs(d[kz])) kz = 1;
    if (abs(d[2]) > abs(d[kz])) kz = 2;
    int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
    if (d[kz] < T(0)) {
      int const k = kx;
      kx = ky;
      ky = k;
    }
    bool const some = d[kz] != T(0);
    return {p, kx, ky, kz, some ? d[kx] / d[kz] : T(0), some ? d[ky] / d[kz] : T(0), d[kz]};
  }
  // Along an axis, to infinity.
  MPMPBD_HD static SheetLine along(Vec3<T> const& p, int axis) {
    return {p, (axis + 1) % 3, (axis + 2) % 3, axis, T(0), T(0), T(1)};
  }
  MPMPBD_HD bool usable() const { return reach != T(0); }

  MPMPBD_HD Vec3<T> project(Vec3<T> const& v) const {
    Vec3<T> const r = v - origin;
    return {{multiply_add(-shear_x, r[kz], r[kx]), multiply_add(-shear_y, r[kz], r[ky]), r[kz]}};
  }
};

template <class T> struct LineHit {
  bool hit;
  bool leaving;       // the line goes out of the solid here
  T z;                // along the line's longest axis, from its origin [m]
  Vec<T, 2> weights;  // of b and c
};

// The crossing of the whole line with a triangle; corners projected by SheetLine.
template <class T>
MPMPBD_HD LineHit<T> cross_projected(Vec3<T> const& a, Vec3<T> const& b, Vec3<T> const& c) {
  // Most triangles are clearly beside the line.
  LineHit<T> none{false, false, T(0), {{T(0), T(0)}}};
  for (int i = 0; i < 2; ++i)
    if ((a[i] > T(0) && b[i] > T(0) && c[i] > T(0)) || (a[i] < T(0) && b[i] < T(0) && c[i] < T(0)))
      return none;
  // On which side of the edge p -> q the origin lies. The tie-break is antisymmetric in p and q, so
  // two triangles that share an edge agree about it.
  auto side = [](Vec3<T> const& p, Vec3<T> const& q) {
    int s = detail::sign_of_difference(p[0], q[1], p[1], q[0]);
    if (s == 0) s = detail::sign_of(p[1] - q[1]);
    if (s == 0) s = detail::sign_of(q[0] - p[0]);
    return s;
  };
  int const u = side(b, c), v = side(c, a), w = side(a, b);
  if (u == 0 || u != v || v != w) return none;
  // Magnitudes by plain arithmetic; signs are known, so rounding cannot leave the triangle.
  T const sign = T(u);
  T const fu = max(sign * (b[0] * c[1] - b[1] * c[0]), T(0));
  T const fv = max(sign * (c[0] * a[1] - c[1] * a[0]), T(0));
  T const fw = max(sign * (a[0] * b[1] - a[1] * b[0]), T(0));
  T const sum = fu + fv + fw;
  T wb = T(1) / T(3), wc = T(1) / T(3);  // a triangle that the line sees as one point
  if (sum > T(0)) {
    wb = fv / sum;
    wc = fw / sum;
  }
  return {true, u > 0, a[2] + wb * (b[2] - a[2]) + wc * (c[2] - a[2]), {{wb, wc}}};
}

}  // namespace mpmpbd
