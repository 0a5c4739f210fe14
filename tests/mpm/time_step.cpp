// The step that a scene recommends (B2, B3): that of a lone particle, not that of a wave, and shorter for fast particles.
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include <cmath>
#include <vector>

#include "catch.hpp"

using namespace mpmpbd;

namespace {

constexpr double dx = 3.7e-3, density = 1050.0, modulus = 1.3e4;

struct Tissue : Mpm<NeoHookean> {};
struct Rest : Scene<Tissue> {};

Simulation<Rest, Serial, double> block(double poisson_ratio) {
  Simulation<Rest, Serial, double> run(
      {.cell_size = dx, .nodes = {9, 9, 9}, .capacity = {{"particle", 27}}});
  run.set<NeoHookean>(lame(modulus, poisson_ratio));
  std::vector<Vec3<double>> at;
  for (int i = 0; i < 27; ++i)
    at.push_back(dx *
                 (vec(3.3, 3.1, 3.7) + 0.5 * vec(double(i % 3), double(i / 3 % 3), double(i / 9))));
  run.add_particles(0, at, density, dx * dx * dx / 8);
  return run;
}

// A2.1 for MLS forces and APIC: the fastest mode of a lone particle has omega^2 = 4 (3 K) / (rho dx^2).
double limit(double poisson_ratio) {
  return dx * std::sqrt(density * (1 - 2 * poisson_ratio) / modulus);
}

}  // namespace

TEST_CASE("tissue at rest is stepped below the limit of a lone particle", "[mpm][time_step]") {
  for (double const nu : {0.0, 0.3, 0.4, 0.49}) {
    CAPTURE(nu);
    CHECK_THAT(block(nu).suggest_dt(0), WithinRel(time_step_safety * limit(nu), 1e-12));
  }
  // A wave would allow 1.5 times as much at nu = 0.4.
  auto const k = lame(modulus, 0.4);
  CHECK_THAT(dx * std::sqrt(density / (k.lambda + 2 * k.mu)) / limit(0.4), WithinRel(1.5275, 1e-4));
}

TEST_CASE("no particle crosses more than half a cell, or strains by more than a half",
          "[mpm][time_step]") {
  auto run = block(0.3);
  double const fast = 3 * dx / limit(0.3);
  run.state().set<particle::Velocity>(0, 7, vec(0.0, -fast, 0.0));
  CHECK_THAT(run.suggest_dt(0), WithinRel(time_step_safety * limit(0.3) / 6, 1e-12));
  run.state().set<particle::Velocity>(0, 7, {});
  Mat3<double> C{};
  C(0, 2) = 5 / limit(0.3);
  run.state().set<particle::Affine>(0, 26, C);
  CHECK_THAT(run.suggest_dt(0), WithinRel(time_step_safety * limit(0.3) / 10, 1e-12));
}
