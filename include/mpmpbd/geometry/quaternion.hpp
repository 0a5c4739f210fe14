// Rotations as unit quaternions (w, x, y, z). q and -q are the same rotation.
#pragma once

#include <stdexcept>
#include <string>

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd {

template <class T> using Quaternion = Vec<T, 4>;

namespace quaternion {

template <class T> MPMPBD_HD constexpr Quaternion<T> identity() {
  return {{T(1), T(0), T(0), T(0)}};
}

template <class T> MPMPBD_HD constexpr Quaternion<T> conjugate(Quaternion<T> const& q) {
  return {{q[0], -q[1], -q[2], -q[3]}};
}

// First b, then a.
template <class T>
MPMPBD_HD constexpr Quaternion<T> product(Quaternion<T> const& a, Quaternion<T> const& b) {
  return {{a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
           a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
           a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
           a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]}};
}

// Whether q gives a direction on the unit sphere: finite, and far enough from zero to be scaled.
template <class T> MPMPBD_HD bool is_valid(Quaternion<T> const& q) {
  T const square = dot(q, q);
  return is_finite(square) && square > epsilon<T> * epsilon<T>;
}

// q scaled to length 1. What is not valid is handed back unchanged: a state never becomes NaN here,
// and `checked` has refused it before.
template <class T> MPMPBD_HD Quaternion<T> normalised(Quaternion<T> const& q) {
  return is_valid(q) ? T(1) / norm(q) * q : q;
}

// The length of q cancels: without the division its rounding would stretch v by about one ulp every
// time, always the same way (measured: 6e4 ulp of angular momentum in 20,000 steps, 8e3 with it).
template <class T> MPMPBD_HD constexpr Vec3<T> rotate(Quaternion<T> const& q, Vec3<T> const& v) {
  Vec3<T> const a = {{q[1], q[2], q[3]}};
  Vec3<T> const t = T(2) / dot(q, q) * cross(a, v);
  return v + add_product(cross(a, t), q[0], t);
}
template <class T>
MPMPBD_HD constexpr Vec3<T> rotate_back(Quaternion<T> const& q, Vec3<T> const& v) {
  return rotate(conjugate(q), v);
}

template <class T> MPMPBD_HD constexpr Mat3<T> matrix(Quaternion<T> const& q) {
  T const w = q[0], x = q[1], y = q[2], z = q[3];
  return {{T(1) - T(2) * (y * y + z * z), T(2) * (x * y + w * z), T(2) * (x * z - w * y),
           T(2) * (x * y - w * z), T(1) - T(2) * (x * x + z * z), T(2) * (y * z + w * x),
           T(2) * (x * z + w * y), T(2) * (y * z - w * x), T(1) - T(2) * (x * x + y * y)}};
}

// sin(a) / a, also at zero and for the smallest angles.
template <class T> MPMPBD_HD T sinc(T a) {
  T const s = a * a;
  return s < T(1e-4) ? T(1) - s / T(6) * (T(1) - s / T(20) * (T(1) - s / T(42))) : sin(a) / a;
}

// The rotation by |r| rad about the direction of r: the exponential map, exact for any angle.
template <class T> MPMPBD_HD Quaternion<T> from_rotation_vector(Vec3<T> const& r) {
  T const half = T(0.5) * norm(r);
  T const s = T(0.5) * sinc(half);
  return {{cos(half), s * r[0], s * r[1], s * r[2]}};
}
template <class T> MPMPBD_HD Quaternion<T> from_axis_angle(Vec3<T> const& unit_axis, T angle) {
  return from_rotation_vector(angle * unit_axis);
}

// q, then turned by |r| rad about the direction of r (world axes).
template <class T> MPMPBD_HD Quaternion<T> turned(Quaternion<T> const& q, Vec3<T> const& r) {
  return normalised(product(from_rotation_vector(r), q));
}

// The rotation vector of q, of length 0 to pi: the shorter of the two ways round, the same for q
// and -q.
template <class T> MPMPBD_HD Vec3<T> rotation_vector(Quaternion<T> const& q) {
  T const sign = q[0] < T(0) ? T(-1) : T(1);
  Vec3<T> const a = {{sign * q[1], sign * q[2], sign * q[3]}};
  T const sine = norm(a);
  T const cosine = sign * q[0];
  // At small angles 2 atan2(s, c) / s tends to 2 / c.
  T const factor = sine > epsilon<T> * cosine ? T(2) * atan2(sine, cosine) / sine
                                              : T(2) / max(cosine, epsilon<T>);
  return factor * a;
}

// The angle between two rotations [rad], 0 to pi; zero for q and -q.
template <class T> MPMPBD_HD T distance(Quaternion<T> const& a, Quaternion<T> const& b) {
  return norm(rotation_vector(product(a, conjugate(b))));
}

// From the images of the axes x, y, z, which are orthonormal and right-handed (Shepperd's choice of
// the largest component, so no branch loses digits).
template <class T>
MPMPBD_HD Quaternion<T> from_axes(Vec3<T> const& x, Vec3<T> const& y, Vec3<T> const& z) {
  T const t[4] = {T(1) + x[0] + y[1] + z[2], T(1) + x[0] - y[1] - z[2], T(1) - x[0] + y[1] - z[2],
                  T(1) - x[0] - y[1] + z[2]};
  int k = 0;
  for (int i = 1; i < 4; ++i)
    if (t[i] > t[k]) k = i;
  T const a = y[2] - z[1], b = z[0] - x[2], c = x[1] - y[0];
  T const d = y[0] + x[1], e = z[0] + x[2], f = z[1] + y[2];
  Quaternion<T> q{};
  if (k == 0) q = {{t[0], a, b, c}};
  if (k == 1) q = {{a, t[1], d, e}};
  if (k == 2) q = {{b, d, t[2], f}};
  if (k == 3) q = {{c, e, f, t[3]}};
  return normalised(q);
}

// Refuses zero, NaN and infinity; hands back q scaled to length 1.
template <class T> Quaternion<T> checked(char const* owner, Quaternion<T> const& q) {
  if (is_valid(q)) return normalised(q);
  auto number = [&q](int i) { return std::to_string(static_cast<double>(q[i])); };
  throw std::invalid_argument(
      "mpmpbd " + std::string(owner) + ": orientation = (" + number(0) + ", " + number(1) + ", " +
      number(2) + ", " + number(3) +
      ") is not a rotation; give four finite numbers (w, x, y, z), not all zero");
}

}  // namespace quaternion
}  // namespace mpmpbd
