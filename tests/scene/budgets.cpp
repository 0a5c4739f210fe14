// Budgets: what a body has in all, and where its energy goes.
// seconds: 5
#include "catch.hpp"

#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/prony.hpp>
#include <mpmpbd/effects/viscosity.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/flip.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/scene/totals.hpp>
#include <mpmpbd/testing/samples.hpp>

using namespace mpmpbd;

namespace {

constexpr double dx = 5.3e-3, density = 1050.0;

// A cube of six cells, 1728 points, that floats free.
template <class Scene_> Simulation<Scene_, Serial, double> cube() {
  Simulation<Scene_, Serial, double> run({.environments = 1,
                                          .cell_size = dx,
                                          .nodes = {18, 18, 18},
                                          .capacity = {{"particle", 1728}}});
  run.template set<NeoHookean>(lame(2e4, 0.3));
  std::vector<Vec3<double>> at;
  for (int n = 0; n < 1728; ++n)
    at.push_back(dx *
                 (vec(6.0, 6.0, 6.0) + 0.5 * vec(n % 12 + 0.5, n / 12 % 12 + 0.5, n / 144 + 0.5)));
  run.add_particles(0, at, density, dx * dx * dx / 8);
  return run;
}
// Its first breathing motion: v = rate (x - centre), with its own stretching along z.
template <class Run> void kick(Run& run, double rate) {
  using Body = typename Run::Scene::Body;
  Mat3<double> A{};
  A(0, 0) = A(1, 1) = -0.5 * rate;
  A(2, 2) = rate;
  for (std::int64_t p = 0; p < 1728; ++p) {
    auto const x = run.state().template get<particle::Position>(0, p);
    run.state().template set<particle::Velocity>(0, p, A * (x - dx * vec(9.0, 9.0, 9.0)));
    if constexpr (Body::Transfer::carries_affine)
      run.state().template set<particle::Affine>(0, p, A);
  }
}

struct Elastic : Scene<Mpm<NeoHookean, Flip, WeightGradient>, StrainWork> {};
struct Viscous : Scene<Mpm<NeoHookean>, Viscosity, StrainWork> {};
struct Relaxing : Scene<Mpm<NeoHookean>, Prony<1>, StrainWork> {};
struct Falling : Scene<Mpm<NeoHookean>, Gravity> {};

}  // namespace

TEST_CASE("a moving body has the momentum, spin and energy of its particles", "[scene][totals]") {
  auto run = cube<Falling>();
  run.set<Gravity>({{0.0, 0.0, 0.0}});
  Vec3<double> const v = vec(0.3, -0.2, 0.1), w = vec(1.0, 2.0, -3.0), c = dx * vec(9.0, 9.0, 9.0);
  for (std::int64_t p = 0; p < 1728; ++p) {
    auto const x = run.state().get<particle::Position>(0, p);
    run.state().set<particle::Velocity>(0, p, v + cross(w, x - c));
    run.state().set<particle::Affine>(0, p, skew(w));
  }
  auto const t = tissue_totals(run, 0);
  double const side = 6 * dx, mass = density * side * side * side;
  // A continuous cube has m a^2 / 6 about each axis; points at the middles of their parts lack h^2 / 6 of it, the
  // affine particles have 2 D = dx^2 / 2 of it in addition.
  double const inertia = mass * (side * side - 0.25 * dx * dx + 3 * dx * dx) / 6.0;
  CHECK(t.mass == Approx(mass));
  CHECK(norm(t.momentum - mass * v) < 1e-12 * mass);
  CHECK(norm(t.angular_momentum - (mass * cross(c, v) + inertia * w)) < 1e-12 * mass * norm(w));
  CHECK(t.kinetic == Approx(0.5 * mass * dot(v, v) + 0.5 * inertia * dot(w, w)));
  CHECK(t.strain == Approx(0.0).margin(1e-18));
  CHECK(t.strain_work == 0.0);
}

TEST_CASE("momentum grows by the weight", "[scene][totals]") {
  auto run = cube<Falling>();
  run.set<Gravity>({{0.0, 0.0, -9.81}});
  auto const before = tissue_totals(run, 0);
  for (int n = 0; n < 20; ++n) run.step(4e-4);
  auto const after = tissue_totals(run, 0);
  CHECK(norm(after.momentum - before.momentum - before.mass * 20 * 4e-4 * vec(0.0, 0.0, -9.81)) <
        1e-12 * before.mass);
}

TEST_CASE("an elastic body dissipates nothing: its strain work is its strain energy",
          "[scene][totals][strain_work]") {
  auto run = cube<Elastic>();
  run.set<Flip>({1.0});
  kick(run, 12.0);
  double const start = tissue_totals(run, 0).kinetic;
  double most = 0.0, before = 0.0;
  for (int n = 0; n < 60; ++n) {
    run.step(2.5e-4);
    REQUIRE(run.state().get<environment::Substeps>(0) == 1);
    auto const t = tissue_totals(run, 0);
    CAPTURE(n, t.strain);
    CHECK(std::abs(t.strain_work - before) < 1e-3 * start);  // until the substep began
    before = t.strain;
    most = std::max(most, t.strain);
  }
  CHECK(most > 0.3 * start);
  CHECK(run.status(0) == 0);
}

TEST_CASE("what viscosity and relaxation take from a body is what its material dissipates",
          "[scene][totals][strain_work]") {
  auto lost = [](auto run, bool always) {
    kick(run, 12.0);
    auto const start = tissue_totals(run, 0);
    double before = 0.0;
    for (int n = 0; n < 200; ++n) {
      run.step(2.5e-4);
      double const now = tissue_totals(run, 0).dissipated();
      if (always) CHECK(now > before - 0.05 * start.kinetic);
      before = now;
    }
    return before / start.kinetic;
  };
  auto viscous = cube<Viscous>();
  viscous.set<Viscosity>({30.0});
  double const by_viscosity = lost(viscous, true);
  CHECK(by_viscosity > 0.5);
  CHECK(by_viscosity < 1.0);
  auto relaxing = cube<Relaxing>();
  relaxing.set<Prony<1>>({{0.6}, {0.01}});
  // The energy that a material reports is that of its instantaneous modulus: only at rest is all of it seen.
  double const by_relaxation = lost(relaxing, false);
  CHECK(by_relaxation > 0.3);
  CHECK(by_relaxation < 1.0);
  viscous.set<Viscosity>({0.0});
  CHECK(std::abs(lost(viscous, true)) < 0.05);
}
