// The code of docs/tutorials/write_a_material.md, and a wrong material that the law suite has to catch.
#include "catch.hpp"
#include "shown.hpp"

#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/mpm/concepts.hpp>
#include <mpmpbd/mpm/materials/lame.hpp>
#include <mpmpbd/mpm/materials/per_particle.hpp>
#include <mpmpbd/scene/simulation.hpp>
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

struct Pudding : mpmpbd::Mpm<Gel> {};
struct Wobbling : mpmpbd::Scene<Pudding> {};

namespace {
using namespace mpmpbd;

// Kirchhoff stress where Cauchy stress was derived: wrong by the factor J.
struct CauchyGel : Gel {
  template <class P, class K> MPMPBD_HD static auto kirchhoff(P const& p, K const& k) {
    return (1 / determinant(p[particle::Deformation{}])) * Gel::kirchhoff(p, k);
  }
};

bool slope_law_fails() {
  for (auto const& law : material_laws<CauchyGel, double>(lame(20e3, 0.45)))
    if (!law.holds() && law.text().find("slope") != std::string::npos) return true;
  return false;
}
}  // namespace

TEST_CASE("gel keeps the laws of a material", "[material][tutorial]") {
  for (auto const& law : mpmpbd::material_laws<Gel, double>(mpmpbd::lame(20e3, 0.45))) {
    INFO(law.text());
    CHECK(law.holds());
  }
  for (auto const& law : mpmpbd::material_laws<Gel, float>(mpmpbd::lame(20e3, 0.45))) {
    INFO(law.text());
    CHECK(law.holds());
  }
}

TEST_CASE("Cauchy stress in place of Kirchhoff stress is found by the laws", "[material][laws]") {
  CHECK(slope_law_fails());
}

TEST_CASE("a stretched gel springs back through its rest state", "[material][tutorial]") {
  double const cell = 0.02, spacing = cell / 2;  // [m]
  std::vector<Vec3<double>> points;
  for (int i = 0; i < 512; ++i)
    points.push_back(vec(0.2, 0.2, 0.2) + spacing * vec<double>(i % 8, i / 8 % 8, i / 64));

  Simulation<Wobbling, Serial, double> sim(
      {.cell_size = cell, .nodes = {26, 26, 26}, .capacity = {{"particle", 512}}});
  sim.set<Gel>(lame(20e3, 0.4));
  sim.add_particles(0, points, 1000.0, spacing * spacing * spacing);
  Mat3<double> F = Mat3<double>::identity();
  F(2, 2) = 1.05;
  for (std::int64_t p = 0; p < 512; ++p) sim.state().set<particle::Deformation>(0, p, F);

  double shortest = 1.0;
  for (int s = 0; s < 100; ++s) {
    sim.step(5e-4);
    shortest = std::min(shortest, sim.state().get<particle::Deformation>(0, 219)(2, 2));
  }
  CHECK(sim.status(0) == 0);
  CHECK(shortest < 0.99);
  CHECK(shortest > 0.94);
}

TEST_CASE("the tutorial shows this material", "[material][tutorial]") {
  CHECK(blocks_not_in(__FILE__, "tutorials/write_a_material.md") == std::vector<std::string>{});
}
