// Weakly compressible fluid: p = K/gamma (J^-gamma - 1), tau = -J p I. Murnaghan 1944; as used for
// water (gamma = 7) by Monaghan 1994 and in MPM by Tampubolon et al. 2017.
#pragma once

#include <array>

#include <mpmpbd/core/tick.hpp>
#include <mpmpbd/mpm/concepts.hpp>
#include <mpmpbd/mpm/materials/lame.hpp>

namespace mpmpbd {

namespace detail {
MPMPBD_HD inline float rough_cube_root(float a) { return ::cbrtf(a); }
MPMPBD_HD inline double rough_cube_root(double a) { return ::cbrt(a); }
// One Newton step more than the library: its last bit is biased, and a volume that is rooted and cubed
// at every step would creep.
template <class T> MPMPBD_HD T cube_root(T a) {
  T const c = rough_cube_root(a), c2 = c * c;
  return c2 > T(0) ? c - (c2 * c - a) / (3 * c2) : c;
}
}  // namespace detail

// A fluid has no shape to remember: after every update F is set to J^(1/3) I, so shear cannot pile up
// in it. Inviscid; add effects/viscosity.hpp for a viscous one.
// Limits: needs det F > 0. A free surface holds suction up to K/gamma (no cavitation). Below
// gamma ln(1/J) = 20 (J = 0.057 for gamma = 7) pressure grows with ln J only, so that it stays finite.
// Take K >= 100 rho v^2 for density changes below 1 %.
struct WeaklyCompressibleFluid {
  using Role = role::Material;
  static constexpr FixedString name = "weakly compressible fluid";
  using Reads = Fields<particle::Deformation>;
  using Writes = Fields<particle::Deformation>;
  static constexpr bool needs_positive_volume = true;

  template <class T> struct Parameters {
    T bulk_modulus;  // K = rho c^2 [Pa]
    T gamma;         // exponent [1]
  };
  static constexpr std::array<ParameterInfo, 2> parameter_info{
      {bound::positive("bulk_modulus", "Pa"), {"gamma", "1", 1.0, 20.0, false, true}}};

  // Small strains see no shear modulus, and K.
  template <class T> MPMPBD_HD static Lame<T> at_rest(Parameters<T> const& k) {
    return {T(0), k.bulk_modulus};
  }

  template <class P, class K> MPMPBD_HD static auto kirchhoff(P const& p, K const& k) {
    using T = typename P::Scalar;
    T const J = determinant(p[particle::Deformation{}]);
    if (!(J > T(0))) return T(0) * p[particle::Deformation{}];
    T const x = -k.gamma * log(J);
    T const pressure =
        k.bulk_modulus / k.gamma *
        (x < steepest<T> ? expm1(x) : expm1(steepest<T>) + slope<T>() * (x - steepest<T>));
    Mat3<T> tau{};
    for (int i = 0; i < 3; ++i) tau(i, i) = -J * pressure;
    return tau;
  }

  // psi = -integral of p dJ from 1.
  template <class P, class K> MPMPBD_HD static auto energy(P const& p, K const& k) {
    using T = typename P::Scalar;
    T const J = determinant(p[particle::Deformation{}]);
    if (!(J > T(0))) return T(0);
    T const c = k.bulk_modulus / k.gamma, n = k.gamma - T(1);
    T const log_J = log(J), bend = -steepest<T> / k.gamma;  // ln J where the continuation begins
    T const reached = max(log_J, bend);
    T psi = c * (expm1(-n * reached) / n + expm1(reached));
    if (log_J < bend) {
      T const J0 = exp(bend);
      // p/c = a - gamma s (ln J - bend), integrated from J to J0.
      psi += c * (expm1(steepest<T>) * (J0 - J) +
                  slope<T>() * k.gamma * ((J0 - J) + J * (log_J - bend)));
    }
    return psi;
  }

  // dtau[L] = -J d(J p)/dJ tr L I = K ((1 - 1/gamma) J^(1-gamma) + J/gamma) tr L I; a wave sees -J^2 p'.
  template <class P, class K> MPMPBD_HD static auto stiffness(P const& p, K const& k) {
    using T = typename P::Scalar;
    T const J = determinant(p[particle::Deformation{}]);
    if (!(J > T(0))) return Stiffness<T>{k.bulk_modulus, 3 * k.bulk_modulus};
    T const x = -k.gamma * log(J);
    T const wave = k.bulk_modulus * J * exp(min(x, steepest<T>));
    T const c = k.bulk_modulus / k.gamma;
    T const beyond = x > steepest<T> ? T(0) : wave / k.gamma;  // there p > 0 only lowers it
    return Stiffness<T>{wave, 3 * max(T(0), wave - beyond + c * J)};
  }

  template <class P, class K, class T>
  MPMPBD_HD static void after_update(P& p, K const&, Tick<T> const&) {
    auto& F = p[particle::Deformation{}];
    F = detail::cube_root(determinant(F)) * Mat3<T>::identity();
  }

 private:
  template <class T> static constexpr T steepest = T(20);
  template <class T> MPMPBD_HD static constexpr T slope() { return T(485165195.40979028); }  // e^20
};

}  // namespace mpmpbd
