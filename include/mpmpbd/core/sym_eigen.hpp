// Eigenvalues and eigenvectors of a small symmetric matrix by cyclic Jacobi rotations.
//
// Golub and Van Loan, Matrix Computations, 8.5. A fixed number of sweeps; NaN in gives NaN out.
#pragma once

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd {

// A = vectors diag(values) vectors^T, values in descending order.
template <class T, int N> struct SymmetricEigen {
  Vec<T, N> values;
  Mat<T, N, N> vectors;
};

// Reads the upper triangle of A. Error of values and residual: about N eps |A|.
template <class T, int N> MPMPBD_HD SymmetricEigen<T, N> symmetric_eigen(Mat<T, N, N> A) {
  constexpr int sweeps = N <= 3 ? 6 : 12;
  constexpr T tiny = sizeof(T) > sizeof(float) ? T(1e-300) : T(1e-37);
  T scale = T(0), sum = T(0);
  for (int i = 0; i < N * N; ++i) scale = max(scale, abs(A.m[i]));
  scale = max(scale, tiny);
  A *= T(1) / scale;
  for (int i = 0; i < N * N; ++i) sum += A.m[i];
  T const poison = sum * T(0);

  Mat<T, N, N> V = Mat<T, N, N>::identity();
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (int p = 0; p + 1 < N; ++p) {
      for (int q = p + 1; q < N; ++q) {
        T const half = (A(q, q) - A(p, p)) / 2, off = A(p, q);
        T const root = abs(half) + sqrt(half * half + off * off);
        T const t = root > T(0) ? (half < T(0) ? -off : off) / root : T(0);
        T const c = T(1) / sqrt(T(1) + t * t), s = c * t;
        A(p, p) -= t * off;
        A(q, q) += t * off;
        A(p, q) = T(0);
        for (int k = 0; k < N; ++k) {
          if (k != p && k != q) {
            T& kp = k < p ? A(k, p) : A(p, k);
            T& kq = k < q ? A(k, q) : A(q, k);
            T const x = kp, y = kq;
            kp = c * x - s * y;
            kq = s * x + c * y;
          }
          T const x = V(k, p), y = V(k, q);
          V(k, p) = c * x - s * y;
          V(k, q) = s * x + c * y;
        }
      }
    }
  }
  // Selection sort: N is small, and equal values keep their order.
  for (int i = 0; i + 1 < N; ++i) {
    int best = i;
    for (int j = i + 1; j < N; ++j)
      if (A(j, j) > A(best, best)) best = j;
    if (best == i) continue;
    T const value = A(i, i);
    A(i, i) = A(best, best);
    A(best, best) = value;
    for (int k = 0; k < N; ++k) {
      T const x = V(k, i);
      V(k, i) = V(k, best);
      V(k, best) = x;
    }
  }
  SymmetricEigen<T, N> r{};
  for (int i = 0; i < N; ++i) r.values[i] = scale * A(i, i) + poison;
  r.vectors = V;
  for (int i = 0; i < N * N; ++i) r.vectors.m[i] += poison;
  return r;
}

}  // namespace mpmpbd
