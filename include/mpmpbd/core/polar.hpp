// Polar decomposition F = R S = W R: the rotation in a deformation gradient.
#pragma once

#include <mpmpbd/core/svd.hpp>

namespace mpmpbd {

// R is a rotation (det R = 1) also for singular and inverted F; S is symmetric and carries the sign of
// det F in its smallest eigenvalue. Where two such rotations are equally near (S with eigenvalues s and
// -s) the choice is deterministic, but R is not continuous there.
template <class T> struct Polar {
  Mat3<T> R;
  Mat3<T> S;
};

template <class T> MPMPBD_HD Mat3<T> rotation_of(Mat3<T> const& F) {
  Svd<T> const d = svd(F);
  return detail::polished(d.U * transpose(d.V));
}

// A diag(s) A^T, symmetric to the last bit.
template <class T> MPMPBD_HD Mat3<T> spectral(Mat3<T> const& A, Vec3<T> const& s) {
  Mat3<T> r{};
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i <= j; ++i)
      r(i, j) = r(j, i) = multiply_add(
          A(i, 2) * s[2], A(j, 2), multiply_add(A(i, 1) * s[1], A(j, 1), A(i, 0) * s[0] * A(j, 0)));
  return r;
}

template <class T> MPMPBD_HD Polar<T> polar(Mat3<T> const& F) {
  Svd<T> const d = svd(F);
  return {detail::polished(d.U * transpose(d.V)), spectral(d.V, d.sigma)};
}

}  // namespace mpmpbd
