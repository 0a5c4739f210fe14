// Stable neo-Hookean solid for nearly incompressible tissue: defined and stiff at any F, also inverted.
// Smith, de Goes, Kim 2018, eq. 14; with m, l their constants,
//   psi = m/2 (I - 3) + l/2 (J - alpha)^2 - m/2 ln(I + 1),  I = tr b,  alpha = 1 + 3 m / (4 l),
// and, so that small strains see mu and lambda, m = 4/3 mu, l = lambda + 5/6 mu. Written out,
//   tau = 4/3 mu (1 - 1/(I + 1)) b + J (l (J - 1) - mu) I.
#pragma once

#include <mpmpbd/mpm/concepts.hpp>
#include <mpmpbd/mpm/materials/lame.hpp>

namespace mpmpbd {

// Limits: resistance to inversion is finite (l/2 (J - alpha)^2 at J = 0), so a strong enough load
// inverts a particle; it recovers when the load is gone. No fault is raised.
struct StableNeoHookean {
  using Role = role::Material;
  static constexpr FixedString name = "stable neo-Hookean";
  using Reads = Fields<particle::Deformation>;
  using Writes = Fields<>;
  static constexpr bool needs_positive_volume = false;
  static constexpr bool branch_free = true;

  template <class T> using Parameters = Lame<T>;
  static constexpr auto parameter_info = lame_info;

  template <class P, class K> MPMPBD_HD static auto kirchhoff(P const& p, K const& k) {
    using T = typename P::Scalar;
    Mat3<T> const& F = p[particle::Deformation{}];
    T const I = dot(F, F), J = determinant(F);
    T const shear = T(4) / 3 * k.mu * (I / (I + T(1)));
    T const volume = J * (volumetric<T>(k) * (J - T(1)) - k.mu);
    Mat3<T> tau{};
    for (int i = 0; i < 3; ++i) tau(i, i) = volume;
    return add_product(tau, shear, F * transpose(F));
  }

  // The constant of the original is dropped: zero at rest.
  template <class P, class K> MPMPBD_HD static auto energy(P const& p, K const& k) {
    using T = typename P::Scalar;
    Mat3<T> const& F = p[particle::Deformation{}];
    T const I = dot(F, F), dJ = determinant(F) - T(1);
    return T(2) / 3 * k.mu * ((I - T(3)) - log((I + T(1)) / 4)) + volumetric<T>(k) / 2 * dJ * dJ -
           k.mu * dJ;
  }

  // With g = m I/(I+1): dtau[L] = g (L b + b L^T) + 2 m/(I+1)^2 (b:L) b + J (l (2J - 1) - mu) tr L I;
  // each term by its largest eigenvalue, b:b <= b_max I. A wave a along n sees
  // g n.b n + 2 m/(I+1)^2 (a.b n)^2 + l J^2 (a.n)^2.
  template <class P, class K> MPMPBD_HD static auto stiffness(P const& p, K const& k) {
    using T = typename P::Scalar;
    Mat3<T> const& F = p[particle::Deformation{}];
    T const I = dot(F, F), J = determinant(F), l = volumetric<T>(k);
    T const m = T(4) / 3 * k.mu, g = m * (I / (I + T(1)));
    T const stretch2 = largest_stretch_squared(F);
    T const part = stretch2 / (I + T(1));
    return Stiffness<T>{g * stretch2 + 2 * m * part * part + l * J * J,
                        2 * g * stretch2 + 2 * m * part * (I / (I + T(1))) +
                            3 * max(T(0), J * (l * (2 * J - T(1)) - k.mu))};
  }

 private:
  template <class T, class K> MPMPBD_HD static T volumetric(K const& k) {
    return k.lambda + T(5) / 6 * k.mu;
  }
};

}  // namespace mpmpbd
