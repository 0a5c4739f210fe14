// A family of collagen fibres in an isotropic solid: psi = psi_matrix + k1/(2 k2) (exp(k2 <e>^2) - 1),
// e = |F a0|^2 - 1, <e> = max(e, 0). Holzapfel, Gasser, Ogden 2000, eq. 65 (without the isochoric split).
#pragma once

#include <mpmpbd/core/joined.hpp>
#include <mpmpbd/mpm/materials/forwards_update.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>

namespace mpmpbd {

// Fibres carry tension only. Their direction at rest is the particle's field particle::Fibre (unit
// vector; zero: no fibre there).
// Limits: above k2 e^2 = 20 the force is continued by its tangent: exp() would overflow there, and
// tissue would have torn long before. One family; two need two directions.
template <class Matrix = StableNeoHookean>
struct FibreReinforced : detail::ForwardsUpdate<FibreReinforced<Matrix>, Matrix> {
  using Role = role::Material;
  static constexpr FixedString name = joined(FixedString("fibre-reinforced "), Matrix::name);
  using Reads = union_t<typename Matrix::Reads, Fields<particle::Deformation, particle::Fibre>>;
  using Writes = typename Matrix::Writes;
  static constexpr bool needs_positive_volume = Matrix::needs_positive_volume;

  template <class T> struct Parameters {
    parameters_t<Matrix, T> matrix;
    T k1;  // fibre stiffness [Pa]
    T k2;  // how fast fibres stiffen [1]
  };
  static constexpr auto parameter_info = [] {
    std::array<ParameterInfo, parameter_count<Matrix> + 2> info{};
    for (std::size_t i = 0; i < parameter_count<Matrix>; ++i) info[i] = Matrix::parameter_info[i];
    info[parameter_count<Matrix>] = bound::not_negative("k1", "Pa");
    info[parameter_count<Matrix> + 1] = bound::not_negative("k2", "1");
    return info;
  }();

  template <class P, class K> MPMPBD_HD static auto kirchhoff(P const& p, K const& k) {
    using T = typename P::Scalar;
    Mat3<T> tau = Matrix::kirchhoff(p, k.matrix);
    Vec3<T> const a = p[particle::Deformation{}] * p[particle::Fibre{}];
    Tension<T> const f = tension(dot(a, a) - T(1), T(k.k1), T(k.k2));
    // Without tension nothing is added: 0 times an overflowing a x a would be NaN.
    return f.force > T(0) ? tau + 2 * f.force * outer(a, a) : tau;
  }

  template <class P, class K> MPMPBD_HD static auto energy(P const& p, K const& k) {
    using T = typename P::Scalar;
    Vec3<T> const a = p[particle::Deformation{}] * p[particle::Fibre{}];
    return Matrix::energy(p, k.matrix) + tension(dot(a, a) - T(1), T(k.k1), T(k.k2)).energy;
  }

  // With f = dpsi/de and i = |F a0|^2, dtau[L] = 4 f' (a x a : L) a x a + 2 f (L a x a + a x L a): at most
  // 4 f' i^2 + 4 f i. A wave sees 4 f' (a.m)^2 (n.m)^2 + 2 f (n.m)^2. At rest f' = k1 is counted.
  template <class P, class K> MPMPBD_HD static auto stiffness(P const& p, K const& k) {
    using T = typename P::Scalar;
    Stiffness<T> s = Matrix::stiffness(p, k.matrix);
    Vec3<T> const a = p[particle::Deformation{}] * p[particle::Fibre{}];
    T const i = dot(a, a);
    Tension<T> const f = tension(i - T(1), T(k.k1), T(k.k2));
    s.longitudinal += 4 * f.slope * i * i + 2 * f.force * i;
    s.bulk3 += 4 * f.slope * i * i + 4 * f.force * i;
    return s;
  }

  template <class P, class K> MPMPBD_HD static auto const& inner(P const&, K const& k) {
    return k.matrix;
  }

 private:
  template <class T> struct Tension {
    T energy;  // [J/m^3]
    T force;   // d energy / d e [Pa]
    T slope;   // d force / d e [Pa]
  };
  template <class T> MPMPBD_HD static Tension<T> tension(T e, T k1, T k2) {
    constexpr T steepest = T(20);
    // A slack fibre near rest may be stretched within the step: its slope counts, its force does not.
    if (e < T(0)) return {T(0), T(0), e > T(-1e-3) ? k1 : T(0)};
    T const limit = k2 > T(0) ? sqrt(steepest / k2) : e;
    T const within = min(e, limit), beyond = e - within;
    T const x = k2 * within * within;
    T const rise = x > T(1e-6) ? expm1(x) / x : T(1) + x / 2;
    T const force = k1 * within * exp(x);
    T const slope = k1 * (T(1) + 2 * x) * exp(x);
    return {k1 / 2 * within * within * rise + (force + slope * beyond / 2) * beyond,
            force + slope * beyond, slope};
  }
};

}  // namespace mpmpbd
