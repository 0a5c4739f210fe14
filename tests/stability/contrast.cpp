// B14: a million times stiffer, a thousand times denser, in one body.
// seconds: 12
#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/per_particle.hpp>

#include "catch.hpp"
#include "stability/block.hpp"

using namespace test;

namespace {

using Varied = PerParticle<NeoHookean>;
struct Free : Scene<Mpm<Varied>> {};

constexpr double E = 2e3, nu = 0.3;
Lame<double> harder(double times) { return lame(times * E, nu); }
template <class S> void set_solid(Block<S>& block, std::int64_t p, Lame<double> const& k) {
  block.template set<Varied::Values>(p, Varied::pack<double>(k));
}

// Swings at about a tenth of the soft wave's speed for so many steps.
void check_swing(Block<Free>& block, int steps) {
  double const rate = 0.05 * mpmpbd::sqrt(E / block.c.density) / block.c.cell;
  block.stir({}, rate * Mat3<double>{{0.7, -0.9, 0.4, 0.3, -0.5, 0.8, -0.6, 0.2, -0.3}});
  block.stay();
  auto const start = block.sums();
  double most = 0;
  for (int s = 0; s < steps; ++s) {
    double const h = block.run.suggest_dt(0);
    if (s % 10)
      block.run.step(h);
    else
      most = max(most, block.step(h));
  }
  auto const end = block.sums();
  CAPTURE(most / start.energy(), norm(end.momentum - start.momentum) / start.momentum_size);
  CHECK(block.run.status(0) == 0);
  CHECK(end.finite);
  CHECK(end.inside);
  CHECK(end.least_volume > 0);
  CHECK(norm(end.momentum - start.momentum) <= 1e-12 * start.momentum_size);
  CHECK(most <= (1 + 1e-3) * start.energy());
}

}  // namespace

TEST_CASE("stiffness that varies a million times from particle to particle", "[stability][B14]") {
  testing::Samples random(17);
  Block<Free> block({.cells = {{2, 2, 2}}}, {});
  for (std::int64_t p = 0; p < block.size(); ++p)
    set_solid(block, p, harder(random.log_uniform(1, 1e6)));
  check_swing(block, 20'000);
}

TEST_CASE("a soft layer below one a million times stiffer", "[stability][B14]") {
  Block<Free> block({.cells = {{2, 2, 4}}}, {});
  for (std::int64_t p = 0; p < block.size(); ++p) {
    bool const upper = block.get<particle::Position>(p)[2] > block.c.middle()[2];
    set_solid(block, p, harder(upper ? 1e6 : 1));
  }
  check_swing(block, 20'000);
}

TEST_CASE("a light layer below one a thousand times denser", "[stability][B14]") {
  Block<Free> block({.cells = {{2, 2, 4}}}, {});
  for (std::int64_t p = 0; p < block.size(); ++p) {
    bool const upper = block.get<particle::Position>(p)[2] > block.c.middle()[2];
    set_solid(block, p, harder(1));
    if (upper) block.set<particle::Mass>(p, 1e3 * block.get<particle::Mass>(p));
  }
  check_swing(block, 20'000);
}

namespace {

struct Column : Scene<Mpm<Varied>, Gravity, Damping, Walls<Slip>> {};

// How far the boundary between a soft lower and a stiff upper part of a column sinks under the weight of
// both, over the exact way of two springs in series, after one and a half of its slowest swings, damped
// critically. The column is a cell wide between slip walls, so its strain is uniaxial.
double sinks(int soft, int stiff, double contrast) {
  int const high = soft + stiff;
  BlockCase const c{
      .low = vec(3.0, 3.0, 3.0), .cells = {{1, 1, high}}, .nodes = {{8, 8, high + 7}}};
  Block<Column> block(c, {});
  auto const wave_modulus = [](double times) {
    auto const k = harder(times);
    return k.lambda + 2 * k.mu;
  };
  double const g = 9.81, weight = c.density * g;  // per volume
  double const H = soft * c.cell, L = high * c.cell, M = wave_modulus(1),
               scale = 1e-4 * M / (weight * L);  // strains of 1e-4: linear
  auto const exact = [&](double z) {
    double const below = min(z, H), above = max(z - H, 0.0);
    return scale * weight *
           ((L * below - square(below) / 2) / M +
            ((L - H) * above - square(above) / 2) / wave_modulus(contrast));
  };
  block.run.set<Walls<Slip>>(
      {{3 * c.cell, 3 * c.cell, 3 * c.cell}, {4 * c.cell, 4 * c.cell, (high + 6) * c.cell}});
  block.run.set<Gravity>({{0.0, 0.0, -scale * g}});
  double const period = 4 * L * mpmpbd::sqrt(c.density / M);
  block.run.set<Damping>({4 * pi<double> / period});
  for (std::int64_t p = 0; p < block.size(); ++p) {
    double const z = block.get<particle::Position>(p)[2] - 3 * c.cell;
    set_solid(block, p, harder(z > H ? contrast : 1));
  }
  double const h = 0.98 * block.run.suggest_dt(0);
  for (double time = 0; time < 1.5 * period; time += h) block.run.step(h);
  CHECK(block.run.status(0) == 0);
  // Of the lowest stiff layer: its own strain is nothing.
  auto const p = static_cast<std::int64_t>(4 * 2 * soft);
  double const z = (soft + 0.25) * c.cell;
  CHECK(block.sums().finite);
  return (3 * c.cell + z - block.get<particle::Position>(p)[2]) / exact(z);
}

}  // namespace

// What is stiff holds the grid fast a little into what is soft, by less than a cell of the sixteen.
TEST_CASE("layers under their weight are springs in series", "[stability][B14]") {
  for (double const contrast : {1e2, 1e6}) {
    double const share = sinks(16, 2, contrast);
    CAPTURE(contrast, share);
    CHECK(std::abs(share - 1) < 0.05);
  }
}
