// Singular value decomposition of a 3x3 matrix, F = U diag(sigma) V^T, with rotations U and V.
//
// One-sided Jacobi (Hestenes 1958; Demmel and Veselic 1992): columns of F V are turned until they are
// orthogonal. A fixed number of sweeps, no branch that depends on convergence: the same text gives the
// same bits everywhere, and NaN cannot hang it.
#pragma once

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd {

// sigma[0] >= sigma[1] >= |sigma[2]|, to rounding; sigma[2] carries the sign of det F, so det U = det V = 1.
template <class T> struct Svd {
  Mat3<T> U;
  Vec3<T> sigma;
  Mat3<T> V;
};

namespace detail {

// Sweeps until the worst of 1e6 random, nearly equal and badly scaled matrices stops improving.
template <class T> inline constexpr int svd_sweeps = sizeof(T) > sizeof(float) ? 5 : 4;

template <class T> MPMPBD_HD constexpr Vec3<T> column(Mat3<T> const& a, int j) {
  return {{a(0, j), a(1, j), a(2, j)}};
}
template <class T> MPMPBD_HD constexpr void set_column(Mat3<T>& a, int j, Vec3<T> const& v) {
  for (int i = 0; i < 3; ++i) a(i, j) = v[i];
}

// Turns columns p and q of B, and with them V, so that they become orthogonal.
template <class T> MPMPBD_INLINE void turn_columns(Mat3<T>& B, Mat3<T>& V, int p, int q) {
  T alpha = T(0), beta = T(0), gamma = T(0);
  for (int i = 0; i < 3; ++i) {
    alpha = multiply_add(B(i, p), B(i, p), alpha);
    beta = multiply_add(B(i, q), B(i, q), beta);
    gamma = multiply_add(B(i, p), B(i, q), gamma);
  }
  // tan of the angle, |tan| <= 1; written so that 0/0 cannot occur.
  T const half = (beta - alpha) / 2;
  T const root = abs(half) + sqrt(multiply_add(gamma, gamma, half * half));
  T const t = root > T(0) ? (half < T(0) ? -gamma : gamma) / root : T(0);
  T const c = T(1) / sqrt(multiply_add(t, t, T(1)));
  T const s = c * t;
  for (int i = 0; i < 3; ++i) {
    T const b = B(i, p), v = V(i, p);
    B(i, p) = multiply_add(-s, B(i, q), c * b);
    B(i, q) = multiply_add(c, B(i, q), s * b);
    V(i, p) = multiply_add(-s, V(i, q), c * v);
    V(i, q) = multiply_add(c, V(i, q), s * v);
  }
}

// Puts the longer of columns p and q first; a turn by 90 degrees, so V stays a rotation.
template <class T> MPMPBD_INLINE void order_columns(Mat3<T>& B, Mat3<T>& V, int p, int q) {
  Vec3<T> const bp = column(B, p), bq = column(B, q);
  if (!(dot(bp, bp) < dot(bq, bq))) return;
  Vec3<T> const vp = column(V, p), vq = column(V, q);
  set_column(B, p, bq);
  set_column(B, q, -bp);
  set_column(V, p, vq);
  set_column(V, q, -vp);
}

// One Newton step towards the nearest rotation: takes an error of 1e-6 to that of rounding.
template <class T> MPMPBD_HD Mat3<T> polished(Mat3<T> const& R) {
  return add_product(R, T(0.5), R * (Mat3<T>::identity() - transpose(R) * R));
}

// A unit vector orthogonal to the unit vector a.
template <class T> MPMPBD_HD Vec3<T> any_orthogonal(Vec3<T> const& a) {
  T const x = abs(a[0]), y = abs(a[1]), z = abs(a[2]);
  Vec3<T> const e = x <= y && x <= z ? vec(T(1), T(0), T(0))
                    : y <= z         ? vec(T(0), T(1), T(0))
                                     : vec(T(0), T(0), T(1));
  return direction(cross(a, e));
}

}  // namespace detail

// Errors: |U^T U - I|, |V^T V - I| and |U S V^T - F| / |F| stay below 1e-6 (float), 1e-14 (double)
// for any finite F, singular and inverted ones and those from 1e-20 to 1e10 included.
// A NaN or infinity in F makes every number of the result NaN.
template <class T> MPMPBD_HD Svd<T> svd(Mat3<T> const& F) {
  constexpr T tiny = sizeof(T) > sizeof(float) ? T(1e-300) : T(1e-37);
  T scale = T(0);
  for (int i = 0; i < 9; ++i) scale = max(scale, abs(F.m[i]));
  T const inverse_scale = T(1) / max(scale, tiny);
  Mat3<T> B = inverse_scale * F;
  Mat3<T> V = Mat3<T>::identity();
  T sum = T(0);
  for (int i = 0; i < 9; ++i) sum += B.m[i];
  T const poison = sum * T(0);  // 0, or NaN when F holds a NaN or infinity

  for (int sweep = 0; sweep < detail::svd_sweeps<T>; ++sweep) {
    detail::turn_columns(B, V, 0, 1);
    detail::turn_columns(B, V, 0, 2);
    detail::turn_columns(B, V, 1, 2);
  }
  // A dozen turns have stretched V by some 10 ulp.
  V = detail::polished(V);
  B = (inverse_scale * F) * V;
  detail::order_columns(B, V, 0, 1);
  detail::order_columns(B, V, 0, 2);
  detail::order_columns(B, V, 1, 2);

  // Directions of U one after the other: what rounding left of a vanishing column is no direction.
  Vec3<T> const b0 = detail::column(B, 0), b1 = detail::column(B, 1), b2 = detail::column(B, 2);
  T const s0 = norm(b0);
  Vec3<T> const u0 = s0 > T(0) ? T(1) / s0 * b0 : vec(T(1), T(0), T(0));
  Vec3<T> const across = add_product(b1, -dot(u0, b1), u0);
  T const width = norm(across);
  Vec3<T> u1 = width > 4 * epsilon<T> * s0 ? T(1) / width * across : detail::any_orthogonal(u0);
  u1 = direction(add_product(u1, -dot(u0, u1), u0));
  Vec3<T> const u2 = cross(u0, u1);

  Svd<T> r{};
  detail::set_column(r.U, 0, u0);
  detail::set_column(r.U, 1, u1);
  detail::set_column(r.U, 2, u2);
  r.U = detail::polished(r.U);
  r.V = V;
  T const s1 = dot(u1, b1), s2 = dot(u2, b2);
  T const unit = max(scale, tiny);
  r.sigma = {{multiply_add(unit, s0, poison), multiply_add(unit, s1, poison),
              multiply_add(unit, s2, poison)}};
  for (int i = 0; i < 9; ++i) {
    r.U.m[i] += poison;
    r.V.m[i] += poison;
  }
  return r;
}

}  // namespace mpmpbd
