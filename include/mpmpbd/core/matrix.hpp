// Small fixed-size vectors and matrices for host and device.
//
// Eigen's memory order (column-major), so a host border can map them without a copy; Eigen itself
// stays out of device code, where its inverse() once compiled to a kernel that is a single trap.
#pragma once

#include <mpmpbd/core/math.hpp>

namespace mpmpbd {

template <class T, int Rows, int Columns = 1> struct Mat {
  using Scalar = T;
  static constexpr int size = Rows * Columns;

  T m[Rows * Columns];

  MPMPBD_HD constexpr T& operator()(int row, int column) { return m[column * Rows + row]; }
  MPMPBD_HD constexpr T operator()(int row, int column) const { return m[column * Rows + row]; }
  MPMPBD_HD constexpr T& operator[](int i) { return m[i]; }
  MPMPBD_HD constexpr T operator[](int i) const { return m[i]; }

  static MPMPBD_HD constexpr Mat zero() { return Mat{}; }
  static MPMPBD_HD constexpr Mat identity() {
    Mat r{};
    for (int i = 0; i < Rows; ++i) r(i, i) = T(1);
    return r;
  }

  MPMPBD_HD constexpr Mat& operator+=(Mat const& b) {
    for (int i = 0; i < size; ++i) m[i] += b.m[i];
    return *this;
  }
  MPMPBD_HD constexpr Mat& operator-=(Mat const& b) {
    for (int i = 0; i < size; ++i) m[i] -= b.m[i];
    return *this;
  }
  MPMPBD_HD constexpr Mat& operator*=(T s) {
    for (int i = 0; i < size; ++i) m[i] *= s;
    return *this;
  }
};

template <class T, int N> using Vec = Mat<T, N, 1>;
template <class T> using Vec3 = Vec<T, 3>;
template <class T> using Mat3 = Mat<T, 3, 3>;

// Keeps a scalar factor out of template argument deduction, so that `2 * v` works for any T.
namespace detail {
template <class T> struct Identity { using type = T; };
template <class T> using identity_t = typename Identity<T>::type;
}  // namespace detail

template <class T, int R, int C>
MPMPBD_HD constexpr Mat<T, R, C> operator+(Mat<T, R, C> a, Mat<T, R, C> const& b) {
  return a += b;
}
template <class T, int R, int C>
MPMPBD_HD constexpr Mat<T, R, C> operator-(Mat<T, R, C> a, Mat<T, R, C> const& b) {
  return a -= b;
}
template <class T, int R, int C> MPMPBD_HD constexpr Mat<T, R, C> operator-(Mat<T, R, C> a) {
  for (int i = 0; i < R * C; ++i) a.m[i] = -a.m[i];
  return a;
}
template <class T, int R, int C>
MPMPBD_HD constexpr Mat<T, R, C> operator*(detail::identity_t<T> s, Mat<T, R, C> a) {
  return a *= s;
}
template <class T, int R, int K, int C>
MPMPBD_HD constexpr Mat<T, R, C> operator*(Mat<T, R, K> const& a, Mat<T, K, C> const& b) {
  Mat<T, R, C> r{};
  for (int j = 0; j < C; ++j)
    for (int k = 0; k < K; ++k)
      for (int i = 0; i < R; ++i) r(i, j) = multiply_add(a(i, k), b(k, j), r(i, j));
  return r;
}
// sum + s a, as multiply_add does it.
template <class T, int R, int C>
MPMPBD_HD constexpr Mat<T, R, C> add_product(Mat<T, R, C> sum, detail::identity_t<T> const& s,
                                             Mat<T, R, C> const& a) {
  for (int i = 0; i < R * C; ++i) sum.m[i] = multiply_add(s, a.m[i], sum.m[i]);
  return sum;
}

template <class T, int R, int C> MPMPBD_HD constexpr Mat<T, C, R> transpose(Mat<T, R, C> const& a) {
  Mat<T, C, R> r{};
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < C; ++j) r(j, i) = a(i, j);
  return r;
}
template <class T, int N> MPMPBD_HD constexpr T trace(Mat<T, N, N> const& a) {
  T r{};
  for (int i = 0; i < N; ++i) r += a(i, i);
  return r;
}
// Sum of products of all entries: the dot product of vectors, A : B of matrices.
template <class T, int R, int C>
MPMPBD_HD constexpr T dot(Mat<T, R, C> const& a, Mat<T, R, C> const& b) {
  T r{};
  for (int i = 0; i < R * C; ++i) r = multiply_add(a.m[i], b.m[i], r);
  return r;
}
template <class T, int R, int C> MPMPBD_HD T norm(Mat<T, R, C> const& a) { return sqrt(dot(a, a)); }
template <class T, int R, int C>
MPMPBD_HD constexpr bool operator==(Mat<T, R, C> const& a, Mat<T, R, C> const& b) {
  for (int i = 0; i < R * C; ++i)
    if (a.m[i] != b.m[i]) return false;
  return true;
}
template <class T, int R, int C> MPMPBD_HD bool is_finite(Mat<T, R, C> const& a) {
  for (int i = 0; i < R * C; ++i)
    if (!is_finite(a.m[i])) return false;
  return true;
}
// The same numbers in another precision.
template <class To, class T, int R, int C>
MPMPBD_HD constexpr Mat<To, R, C> cast(Mat<T, R, C> const& a) {
  Mat<To, R, C> r{};
  for (int i = 0; i < R * C; ++i) r.m[i] = To(a.m[i]);
  return r;
}

template <class T> MPMPBD_HD constexpr Vec3<T> vec(T x, T y, T z) { return {{x, y, z}}; }
template <class T> MPMPBD_HD constexpr Vec3<T> cross(Vec3<T> const& a, Vec3<T> const& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}
// The matrix of the cross product: skew(a) b = a x b.
template <class T> MPMPBD_HD constexpr Mat3<T> skew(Vec3<T> const& a) {
  return {{T(0), a[2], -a[1], -a[2], T(0), a[0], a[1], -a[0], T(0)}};
}
template <class T> MPMPBD_HD constexpr Mat3<T> outer(Vec3<T> const& a, Vec3<T> const& b) {
  Mat3<T> r{};
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) r(i, j) = a[i] * b[j];
  return r;
}
// The direction of a, or zero when a is zero: no direction is invented.
template <class T> MPMPBD_HD Vec3<T> direction(Vec3<T> const& a) {
  T const length = norm(a);
  return length > T(0) ? T(1) / length * a : Vec3<T>{};
}
// A unit vector across a, always the same one for the same a: made with the axis that a leans on least.
template <class T> MPMPBD_HD Vec3<T> any_across(Vec3<T> const& a) {
  T const x = abs(a[0]), y = abs(a[1]), z = abs(a[2]);
  Vec3<T> axis{};
  axis[x <= y && x <= z ? 0 : (y <= z ? 1 : 2)] = T(1);
  return direction(cross(a, axis));
}
template <class T> MPMPBD_HD constexpr Mat3<T> cofactor(Mat3<T> const& f) {
  Mat3<T> c{};
  c(0, 0) = f(1, 1) * f(2, 2) - f(1, 2) * f(2, 1);
  c(0, 1) = f(1, 2) * f(2, 0) - f(1, 0) * f(2, 2);
  c(0, 2) = f(1, 0) * f(2, 1) - f(1, 1) * f(2, 0);
  c(1, 0) = f(0, 2) * f(2, 1) - f(0, 1) * f(2, 2);
  c(1, 1) = f(0, 0) * f(2, 2) - f(0, 2) * f(2, 0);
  c(1, 2) = f(0, 1) * f(2, 0) - f(0, 0) * f(2, 1);
  c(2, 0) = f(0, 1) * f(1, 2) - f(0, 2) * f(1, 1);
  c(2, 1) = f(0, 2) * f(1, 0) - f(0, 0) * f(1, 2);
  c(2, 2) = f(0, 0) * f(1, 1) - f(0, 1) * f(1, 0);
  return c;
}
template <class T> MPMPBD_HD constexpr T determinant(Mat3<T> const& f) {
  T const first = f(0, 0) * (f(1, 1) * f(2, 2) - f(1, 2) * f(2, 1));
  T const first_two = multiply_add(f(0, 1), f(1, 2) * f(2, 0) - f(1, 0) * f(2, 2), first);
  return multiply_add(f(0, 2), f(1, 0) * f(2, 1) - f(1, 1) * f(2, 0), first_two);
}
// Inverse by cofactors; the caller knows that the determinant is not zero.
template <class T> MPMPBD_HD constexpr Mat3<T> inverse(Mat3<T> const& f) {
  Mat3<T> const c = cofactor(f);
  T const first_two = multiply_add(f(0, 1), c(0, 1), f(0, 0) * c(0, 0));
  return T(1) / multiply_add(f(0, 2), c(0, 2), first_two) * transpose(c);
}
template <class T> MPMPBD_HD Mat3<T> deviator(Mat3<T> a) {
  T const sum = trace(a);
  for (int i = 0; i < 3; ++i) a(i, i) = multiply_add(T(-1) / 3, sum, a(i, i));
  return a;
}

}  // namespace mpmpbd
