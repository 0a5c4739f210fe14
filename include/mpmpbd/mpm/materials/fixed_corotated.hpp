// Fixed corotated solid: psi = mu |F - R|^2 + lambda/2 (J - 1)^2. Stomakhin et al. 2012, eq. 7.
// tau = 2 mu (F - R) F^T + lambda (J - 1) J I; in principal stretches 2 mu s_i (s_i - 1) + lambda (J-1) J.
#pragma once

#include <mpmpbd/core/polar.hpp>
#include <mpmpbd/mpm/concepts.hpp>
#include <mpmpbd/mpm/materials/lame.hpp>

namespace mpmpbd {

// Limits: a polar decomposition per evaluation (several times the cost of neo-Hookean); where two
// stretches are s and -s, R jumps, and with it the stress. Recovers from inversion.
struct FixedCorotated {
  using Role = role::Material;
  static constexpr FixedString name = "fixed corotated";
  using Reads = Fields<particle::Deformation>;
  using Writes = Fields<>;
  static constexpr bool needs_positive_volume = false;

  template <class T> using Parameters = Lame<T>;
  static constexpr auto parameter_info = lame_info;

  template <class P, class K> MPMPBD_HD static auto kirchhoff(P const& p, K const& k) {
    using T = typename P::Scalar;
    Svd<T> const d = svd(p[particle::Deformation{}]);
    Vec3<T> const s = d.sigma;
    T const J = s[0] * s[1] * s[2];
    T const volume = k.lambda * (J - T(1)) * J;
    Vec3<T> principal{};
    for (int i = 0; i < 3; ++i) principal[i] = 2 * k.mu * s[i] * (s[i] - T(1)) + volume;
    return spectral(d.U, principal);
  }

  template <class P, class K> MPMPBD_HD static auto energy(P const& p, K const& k) {
    using T = typename P::Scalar;
    Vec3<T> const s = svd(p[particle::Deformation{}]).sigma;
    T const dJ = s[0] * s[1] * s[2] - T(1);
    return k.mu * (square(s[0] - T(1)) + square(s[1] - T(1)) + square(s[2] - T(1))) +
           k.lambda / 2 * dJ * dJ;
  }

  // In the principal frame dtau[L] is 2 mu (2 s_i^2 - s_i) on stretches and
  // 2 mu (s_i^2 + s_j^2)(1 - 1/(s_i + s_j)) on shears, plus lambda J (2J - 1) tr L I. With s the largest
  // stretch both are at most 2 mu (2 s^2 - s), or 2 mu (2 s^2 + s) where a stretch is negative; the
  // part of dtau that is not symmetric adds at most 2 mu s where 1/(s_i + s_j) > 1.
  // A wave sees at most 2 mu n.b n + lambda J^2, as d2|F - R|^2 <= 2 |dF|^2.
  template <class P, class K> MPMPBD_HD static auto stiffness(P const& p, K const& k) {
    using T = typename P::Scalar;
    Mat3<T> const& F = p[particle::Deformation{}];
    T const J = determinant(F), stretch2 = largest_stretch_squared(F), stretch = sqrt(stretch2);
    T const shear = J < T(0) ? 2 * stretch2 + stretch : max(2 * stretch2 - stretch, stretch);
    return Stiffness<T>{2 * k.mu * stretch2 + k.lambda * J * J,
                        2 * k.mu * shear + max(T(0), 3 * k.lambda * J * (2 * J - T(1)))};
  }
};

}  // namespace mpmpbd
