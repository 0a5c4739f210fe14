// St. Venant-Kirchhoff solid: psi = mu E:E + lambda/2 (tr E)^2, E = (F^T F - I)/2.
// Bonet and Wood, eq. 6.28; tau = F (2 mu E + lambda tr E I) F^T = mu (b^2 - b) + lambda tr E b.
#pragma once

#include <mpmpbd/mpm/concepts.hpp>
#include <mpmpbd/mpm/materials/lame.hpp>

namespace mpmpbd {

// Limits: for comparison only. It softens in compression: in uniaxial strain the force has its turning
// point at stretch 1/sqrt(3) = 0.577 and vanishes at zero; it does not notice inversion.
struct StVenantKirchhoff {
  using Role = role::Material;
  static constexpr FixedString name = "St. Venant-Kirchhoff";
  using Reads = Fields<particle::Deformation>;
  using Writes = Fields<>;
  static constexpr bool needs_positive_volume = false;
  static constexpr bool branch_free = true;

  template <class T> using Parameters = Lame<T>;
  static constexpr auto parameter_info = lame_info;

  template <class P, class K> MPMPBD_HD static auto kirchhoff(P const& p, K const& k) {
    using T = typename P::Scalar;
    Mat3<T> const& F = p[particle::Deformation{}];
    Mat3<T> S = 2 * k.mu * green(F);
    T const volume = k.lambda * trace_of_green(F);
    for (int i = 0; i < 3; ++i) S(i, i) += volume;
    return symmetric_part(F * S * transpose(F));
  }

  template <class P, class K> MPMPBD_HD static auto energy(P const& p, K const& k) {
    using T = typename P::Scalar;
    Mat3<T> const& F = p[particle::Deformation{}];
    Mat3<T> const E = green(F);
    return k.mu * dot(E, E) + k.lambda / 2 * square(trace_of_green(F));
  }

  // With e = tr E and db = L b + b L^T: dtau[L] = mu (db b + b db - db) + lambda e db + lambda (b:L) b.
  // On stretches 2 b_i (mu (2 b_i - 1) + lambda e), on shears the same with b_i + b_j for 2 b_i and up to
  // (sqrt(2) - 1)/2 b_max (mu - lambda e) from the part that is not symmetric; the last term is
  // lambda b:b. A wave sees at most n.tau n + (lambda + 2 mu) b_max^2.
  template <class P, class K> MPMPBD_HD static auto stiffness(P const& p, K const& k) {
    using T = typename P::Scalar;
    Mat3<T> const& F = p[particle::Deformation{}];
    T const e = trace_of_green(F), s = largest_stretch_squared(F);
    Mat3<T> const b = F * transpose(F);
    T const shear = max(2 * s * (k.mu * (2 * s - T(1)) + k.lambda * e),
                        T(0.20710679) * s * (k.mu - k.lambda * e));
    T const tension = s * (k.mu * (s - T(1)) + k.lambda * e);
    return Stiffness<T>{max(T(0), tension) + (k.lambda + 2 * k.mu) * s * s,
                        max(T(0), shear) + k.lambda * dot(b, b)};
  }

 private:
  template <class T> MPMPBD_HD static Mat3<T> green(Mat3<T> const& F) {
    return T(0.5) * (transpose(F) * F - Mat3<T>::identity());
  }
  template <class T> MPMPBD_HD static T trace_of_green(Mat3<T> const& F) {
    return (dot(F, F) - T(3)) / 2;
  }
  template <class T> MPMPBD_HD static Mat3<T> symmetric_part(Mat3<T> const& a) {
    return T(0.5) * (a + transpose(a));
  }
};

}  // namespace mpmpbd
