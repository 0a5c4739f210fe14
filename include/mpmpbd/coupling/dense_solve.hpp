// A small dense symmetric system: the six unknowns of a rigid body, and one link that ends on it.
#pragma once

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd {

// A = L D L^T in place, without pivoting: L below the diagonal, D on it. Right for a positive definite
// A bordered by links with negative diagonal (quasi-definite; Vanderbei 1995): every order of
// elimination works. Returns false when a pivot vanishes against the entry it came from.
template <class T, int N> MPMPBD_HD bool factor_ldlt(Mat<T, N, N>& a) {
  for (int j = 0; j < N; ++j) {
    T const original = abs(a(j, j));
    for (int k = 0; k < j; ++k) a(j, j) = multiply_add(-(a(j, k) * a(j, k)), a(k, k), a(j, j));
    if (!(abs(a(j, j)) > T(4) * epsilon<T> * original) || !is_finite(a(j, j))) return false;
    for (int i = j + 1; i < N; ++i) {
      for (int k = 0; k < j; ++k) a(i, j) = multiply_add(-(a(i, k) * a(j, k)), a(k, k), a(i, j));
      a(i, j) /= a(j, j);
    }
  }
  return true;
}

// x <- A^-1 x with the factors of factor_ldlt.
template <class T, int N> MPMPBD_HD void solve_ldlt(Mat<T, N, N> const& a, Vec<T, N>& x) {
  for (int i = 0; i < N; ++i)
    for (int k = 0; k < i; ++k) x[i] = multiply_add(-a(i, k), x[k], x[i]);
  for (int i = 0; i < N; ++i) x[i] /= a(i, i);
  for (int i = N - 1; i >= 0; --i)
    for (int k = i + 1; k < N; ++k) x[i] = multiply_add(-a(k, i), x[k], x[i]);
}

}  // namespace mpmpbd
