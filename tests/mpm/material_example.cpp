// The material of docs/concepts/material.md: what is shown there is compiled and tested here.
#include "catch.hpp"

// [example]
#include <mpmpbd/mpm/concepts.hpp>
#include <mpmpbd/mpm/materials/lame.hpp>
#include <mpmpbd/testing/material_laws.hpp>

// psi = mu/2 (tr b - 3 - 2 ln J) + lambda/2 (J - 1)^2
struct Gel {
  using Role = mpmpbd::role::Material;
  static constexpr mpmpbd::FixedString name = "gel";
  using Reads = mpmpbd::Fields<mpmpbd::particle::Deformation>;
  using Writes = mpmpbd::Fields<>;
  static constexpr bool needs_positive_volume = true;

  template <class T> using Parameters = mpmpbd::Lame<T>;
  static constexpr auto parameter_info = mpmpbd::lame_info;

  template <class P, class K> MPMPBD_HD static auto kirchhoff(P const& p, K const& k) {
    using T = typename P::Scalar;
    auto const& F = p[mpmpbd::particle::Deformation{}];
    T const J = determinant(F);
    if (!(J > T(0))) return T(0) * F;
    return k.mu * (F * transpose(F)) +
           (k.lambda * J * (J - T(1)) - k.mu) * mpmpbd::Mat3<T>::identity();
  }
  template <class P, class K> MPMPBD_HD static auto energy(P const& p, K const& k) {
    using T = typename P::Scalar;
    auto const& F = p[mpmpbd::particle::Deformation{}];
    T const J = determinant(F);
    if (!(J > T(0))) return T(0);
    return k.mu / 2 * (dot(F, F) - T(3)) - k.mu * mpmpbd::log(J) +
           k.lambda / 2 * (J - T(1)) * (J - T(1));
  }
  // dtau[L] = mu (L b + b L^T) + lambda J (2J - 1) tr L I; waves see mu n.b n + mu + lambda J^2.
  template <class P, class K> MPMPBD_HD static auto stiffness(P const& p, K const& k) {
    using T = typename P::Scalar;
    auto const& F = p[mpmpbd::particle::Deformation{}];
    T const J = determinant(F), stretch2 = mpmpbd::largest_stretch_squared(F);
    return mpmpbd::Stiffness<T>{
        k.mu * (stretch2 + T(1)) + k.lambda * J * J,
        2 * k.mu * stretch2 + mpmpbd::max(T(0), 3 * k.lambda * J * (2 * J - T(1)))};
  }
};

TEST_CASE("gel keeps the laws of a material", "[material][example]") {
  for (auto const& law : mpmpbd::material_laws<Gel, double>(mpmpbd::lame(20e3, 0.45))) {
    INFO(law.text());
    CHECK(law.holds());
  }
}
// [example]

TEST_CASE("gel keeps the laws of a material in float", "[material][example]") {
  for (auto const& law : mpmpbd::material_laws<Gel, float>(mpmpbd::lame(20e3, 0.45))) {
    INFO(law.text());
    CHECK(law.holds());
  }
}
