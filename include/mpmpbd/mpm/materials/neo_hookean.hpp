// Compressible neo-Hookean solid: psi = mu/2 (tr b - 3 - 2 ln J) + lambda/2 (ln J)^2.
// Bonet and Wood, Nonlinear Continuum Mechanics, eq. 6.27; tau = mu (b - I) + lambda ln J I.
#pragma once

#include <mpmpbd/mpm/concepts.hpp>
#include <mpmpbd/mpm/materials/lame.hpp>

namespace mpmpbd {

// Limits: needs det F > 0 (ln J); an inverted particle raises Fault::inversion, gives no stress and
// counts no energy. The volume term is soft: crushing to J costs lambda/2 (ln J)^2, and in uniaxial strain
// beyond stretch e = 2.7 the force falls again when lambda > 101 mu (nu > 0.495).
struct NeoHookean {
  using Role = role::Material;
  static constexpr FixedString name = "neo-Hookean";
  using Reads = Fields<particle::Deformation>;
  using Writes = Fields<>;
  static constexpr bool needs_positive_volume = true;
  static constexpr bool branch_free = true;

  template <class T> using Parameters = Lame<T>;
  static constexpr auto parameter_info = lame_info;

  template <class P, class K> MPMPBD_HD static auto kirchhoff(P const& p, K const& k) {
    using T = typename P::Scalar;
    Mat3<T> const& F = p[particle::Deformation{}];
    T const J = determinant(F);
    auto const positive = J > T(0);
    // Inverted: zero, and NaN stays NaN.
    T const mu = select(positive, T(k.mu), T(0));
    T const pressure =
        select(positive, multiply_add(T(k.lambda), log(select(positive, J, T(1))), -T(k.mu)), T(0));
    Mat3<T> tau{};
    for (int i = 0; i < 3; ++i) tau(i, i) = pressure;
    return add_product(tau, mu, F * transpose(F));
  }

  template <class P, class K> MPMPBD_HD static auto energy(P const& p, K const& k) {
    using T = typename P::Scalar;
    Mat3<T> const& F = p[particle::Deformation{}];
    T const J = determinant(F);
    if (!(J > T(0))) return T(0);
    T const log_J = log(J);
    return k.mu / 2 * (dot(F, F) - T(3)) - k.mu * log_J + k.lambda / 2 * log_J * log_J;
  }

  // dtau[L] = mu (L b + b L^T) + lambda tr L I: the first part is at most 2 mu b_max (shear in the plane
  // of the two largest stretches and stretch along the largest), the second at most 3 lambda.
  // Along n with amplitude a: a.(dtau[a x n] - tau n x a) n = mu n.b n + (a.n)^2 (mu + lambda (1 - ln J)):
  // in compression waves are faster than at rest.
  template <class P, class K> MPMPBD_HD static auto stiffness(P const& p, K const& k) {
    using T = typename P::Scalar;
    Mat3<T> const& F = p[particle::Deformation{}];
    T const J = determinant(F);
    T const stretch2 = largest_stretch_squared(F);
    T const volume = J > T(0) ? k.lambda * (T(1) - log(J)) : k.lambda;
    return Stiffness<T>{multiply_add(T(k.mu), stretch2, max(T(0), k.mu + volume)),
                        multiply_add(T(2 * k.mu), stretch2, T(3 * k.lambda))};
  }
};

}  // namespace mpmpbd
