// B1, B3: below the limit of the step a block stays calm for 1e5 steps; beyond it the library says so
// before the first step; and the limit follows the state. The limit itself is measured in time_limit.cpp.
// seconds: 32
#include <utility>

#include <mpmpbd/effects/viscosity.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/pic.hpp>

#include "catch.hpp"
#include "stability/block.hpp"

using namespace test;

namespace {

Lame<double> const tissue = lame(5e4, 0.4);

BlockCase const pair_of_cells{.cells = {{2, 2, 2}}};
BlockCase const lone{.cells = {{1, 1, 1}}, .nodes = {{9, 9, 9}}, .per_axis = 1};

template <class Transfer, class Form> struct Free : Scene<Mpm<NeoHookean, Transfer, Form>> {};
using Default = Free<Apic, Mls>;

// Strains of about 1e-3 and a slow turn.
Mat3<double> stirring(double limit) {
  return 1e-3 / limit * Mat3<double>{{0.7, -0.9, 0.4, 0.3, -0.5, 0.8, -0.6, 0.2, -0.3}};
}

// 1e5 steps at a share of the limit: numbers are finite, momentum stays to rounding, energy does not grow.
template <class S, class T = double> void check_calm(BlockCase const& c, double share) {
  Block<S, T> block(c, tissue);
  double const limit = block.limit(), h = share * limit;
  block.stir({}, stirring(limit));
  auto const start = block.sums();
  double const energy = block.step(h);
  double most = energy, least = energy;
  for (int s = 1; s < 100'000; ++s) {
    if (s % 10) {
      block.run.step(h);
      continue;
    }
    double const now = block.step(h);
    most = max(most, now), least = min(least, now);
  }
  auto const end = block.sums();
  double const rounding = sizeof(T) == 4 ? 2e-5 : 1e-12;  // eps times the root of so many steps
  CAPTURE(sizeof(T), share, most / energy - 1, least / energy,
          norm(end.momentum) / start.momentum_size);
  CHECK(block.run.status(0) == 0);
  CHECK(end.finite);
  CHECK(end.inside);
  CHECK(norm(end.momentum - start.momentum) <= rounding * start.momentum_size);
  CHECK(most <= (1 + 1e-3) * energy);
  CHECK(least >= -1e-3 * energy);
}

}  // namespace

TEST_CASE("a block stays calm for 1e5 steps up to 0.98 of the limit", "[stability][B1]") {
  for (double const share : {0.5, 0.9, 0.98}) {
    check_calm<Default>({.cells = {{2, 2, 2}}}, share);
    check_calm<Free<Flip, WeightGradient>>({.cells = {{2, 2, 2}}}, share);
  }
}

namespace {
// The largest rise from one step to the next, over the energy at the start.
template <class S> double largest_rise(double share, double strains) {
  Block<S> block(pair_of_cells, tissue);
  double const limit = block.limit(), h = share * limit;
  block.stir({}, strains * stirring(limit));
  double const start = block.step(h);
  double previous = start, rise = 0;
  for (int s = 1; s < 2000; ++s) {
    double const now = block.step(h);
    rise = max(rise, now - previous);
    previous = now;
  }
  return rise / start;
}
}  // namespace

// The energy that symplectic Euler keeps is that of a linear system: strains of 1e-3 move it by 7e-6 in a step at
// 0.98 of the limit. So strains are 3e-5 here: smaller ones drown in what F = 1 + strain rounds.
TEMPLATE_TEST_CASE("transfers that damp let no step raise the energy", "[stability][B1]",
                   (Free<Apic, Mls>), (Free<Pic, WeightGradient>)) {
  for (double const share : {0.5, 0.9, 0.98}) {
    double const rise = largest_rise<TestType>(share, 0.03);
    CAPTURE(share, rise, largest_rise<TestType>(share, 1.0));
    CHECK(rise <= 1e-6);
  }
}

TEST_CASE("a block stays calm in float too", "[stability][B1]") {
  check_calm<Default, float>({.cells = {{2, 2, 2}}}, 0.98);
  check_calm<Free<Flip, WeightGradient>, float>({.cells = {{2, 2, 2}}}, 0.98);
}

// It neither gains nor loses energy: no part of its motion is hidden from the grid.
TEST_CASE("a lone particle swings for 1e5 steps up to 0.98 of the limit", "[stability][B1]") {
  for (double const share : {0.5, 0.9, 0.98}) {
    Block<Default> one({.cells = {{1, 1, 1}}, .nodes = {{9, 9, 9}}, .per_axis = 1}, tissue);
    double const h = share * one.limit();
    one.set<particle::Deformation>(
        0, Mat3<double>::identity() + 1e-5 * Mat3<double>{{1, 2, 0, 2, -1, 1, 0, 1, 3}});
    double const energy = one.step(h);
    double most = energy, least = energy;
    for (int s = 1; s < 100'000; ++s) {
      double const now = one.step(h);
      most = max(most, now), least = min(least, now);
    }
    CAPTURE(share, most / energy - 1, least / energy - 1);
    CHECK(one.run.status(0) == 0);
    CHECK(most <= (1 + 1e-3) * energy);
    CHECK(least >= (1 - 1e-3) * energy);
  }
}

TEST_CASE("a step beyond the limit is known before it is taken, reported or cut into substeps",
          "[stability][B1]") {
  // Also of a lone particle: it damps nothing, and its limit is the one of every scene.
  for (auto const& [c, share] : {std::pair(pair_of_cells, 1.02), std::pair(pair_of_cells, 2.0),
                                 std::pair(lone, 1.02), std::pair(lone, 2.0)}) {
    auto chosen = c;
    chosen.substeps = 0;
    Block<Default> strict(c, tissue), automatic(chosen, tissue);
    CAPTURE(share, c.cells[0]);
    double const limit = strict.limit(), h = share * limit;
    CHECK(strict.run.suggest_dt(0) < h);

    strict.stir({}, stirring(limit));
    strict.run.step(h);
    CHECK(strict.run.status(0) == static_cast<std::uint32_t>(Fault::time_step));

    automatic.stir({}, stirring(limit));
    double const energy = automatic.sums().energy();
    double most = energy;
    for (int s = 0; s < 2000; ++s) {
      automatic.run.step(h);
      most = max(most, automatic.sums().energy());
    }
    CAPTURE(most / energy, automatic.sums().energy() / energy);
    CHECK(automatic.run.state().get<environment::Substeps>(0) ==
          static_cast<int>(::ceil(share / time_step_safety)));
    CHECK(automatic.run.status(0) == 0);
    CHECK(automatic.sums().finite);
    // With strain of one time and speed of half a step earlier it swings by 1 / (1 - w dt / 2) where nothing
    // damps; at the start there is no strain.
    double const swing = share / ::ceil(share / time_step_safety);
    CHECK(most <= (1 + 1e-3) * energy / (1 - swing));
    if (automatic.size() > 1) CHECK(automatic.sums().energy() <= energy);
  }
}

TEST_CASE("a fast particle and a fast strain bound the step", "[stability][B3]") {
  Block<Default> block({}, tissue);
  double const elastic = block.limit();
  double const speed = 10 * block.c.cell / elastic;
  block.stir(vec(0.6 * speed, 0.0, 0.8 * speed), {});
  CHECK_THAT(block.limit(), WithinRel(0.5 * block.c.cell / speed, 1e-12));

  double const rate = 10 / elastic;
  for (std::int64_t p = 0; p < block.size(); ++p) block.set<particle::Velocity>(p, {});
  block.set<particle::Affine>(5, Mat3<double>{{rate, 0, 0, 0, 0, 0, 0, 0, 0}});
  CHECK_THAT(block.limit(), WithinRel(0.5 / rate, 1e-12));
}

// A block that implodes by four times its size in a step. In one step of that length every det F would be
// (1 - 4)^3; in steps that the library chooses none turns over.
TEST_CASE("no particle turns over while the block implodes", "[stability][B3]") {
  double const h = 1e-5;
  auto implode = [h](int substeps) {
    Block<Default> block({.nodes = {{16, 16, 16}}, .substeps = substeps}, tissue);
    block.stir({}, -4 / h * Mat3<double>::identity());
    double least = 1;
    for (int s = 0; s < 50; ++s) {
      block.run.step(h);
      least = min(least, block.sums().least_volume);
    }
    return std::pair(least, block.run.status(0));
  };
  auto const [one_step, strict] = implode(1);
  CHECK(one_step < 0);
  CHECK(has(strict, Fault::time_step));
  CHECK(has(strict, Fault::inversion));
  auto const [least, automatic] = implode(0);
  CAPTURE(least, automatic);
  CHECK(least > 0);
  CHECK(automatic == 0);
}

namespace {

// Stretched to twice its length along x, sideways as an incompressible one would.
template <class S> Block<S> stretched(BlockCase const& c) {
  Block<S> block(c, tissue);
  Mat3<double> const F = testing::Samples::diagonal(2.0, 0.7, 0.7);
  for (std::int64_t p = 0; p < block.size(); ++p) {
    auto const x = block.template get<particle::Position>(p) - c.middle();
    block.template set<particle::Position>(p, c.middle() + F * x);
    block.template set<particle::Deformation>(p, F);
  }
  return block;
}

}  // namespace

// Let go, it snaps back: the limit is short at first and rises as it relaxes.
TEST_CASE("the limit follows stretch and is written down", "[stability][B3]") {
  BlockCase const c{.nodes = {{14, 12, 12}}};
  double const at_rest = Block<Default>(c, tissue).limit();
  auto block = stretched<Default>({.low = vec(5.13, 4.27, 4.41), .nodes = {{14, 12, 12}}});
  double const start = block.sums().energy();
  double shortest = 1e300, longest = 0, most = 0;
  for (int s = 0; s < 3000; ++s) {
    double const h = block.run.suggest_dt(0);
    shortest = min(shortest, h), longest = max(longest, h);
    most = max(most, block.step(h));
    REQUIRE(block.run.state().get<environment::DtLimit>(0) == h);
  }
  CAPTURE(shortest / at_rest, longest / at_rest, most / start);
  // 3 lambda + 2 mu b, with b = 4 for the largest stretch.
  double const stiffer = (3 * tissue.lambda + 8 * tissue.mu) / (3 * tissue.lambda + 2 * tissue.mu);
  CHECK(shortest <= (1 + 1e-9) * time_step_safety * at_rest / mpmpbd::sqrt(stiffer));
  CHECK(longest > 0.95 * time_step_safety * at_rest);
  CHECK(most <= (1 + 1e-3) * start);
  CHECK(block.run.status(0) == 0);

  // The limit at rest is no limit here, and that is said.
  auto unaware = stretched<Default>({.low = vec(5.13, 4.27, 4.41), .nodes = {{14, 12, 12}}});
  unaware.run.step(at_rest);
  CHECK(has(unaware.run.status(0), Fault::time_step));
}

// Sixteen times as viscous as elastic: stable at its own limit, not at the elastic one.
TEST_CASE("viscosity bounds the step", "[stability][B3]") {
  struct Viscous : Scene<Mpm<NeoHookean>, Viscosity> {};
  auto energy_after = [](double share) {
    Block<Viscous> block({.cells = {{2, 2, 2}}}, tissue);
    double const elastic = block.limit();  // eta is 0 so far
    block.run.set<Viscosity>({16 * block.c.density * square(block.c.cell) / (8 * elastic)});
    CHECK(block.limit() < 0.2 * elastic);
    double const h = share * block.limit();
    block.stir({}, stirring(elastic));
    double const start = block.sums().energy();
    for (int s = 0; s < 2000; ++s) block.run.step(h);
    return block.sums().energy() / start;
  };
  CHECK(energy_after(0.98) < 1);
  CHECK_FALSE(energy_after(2.02) < 1e3);
}

namespace {

// Largest energy of a lone particle that swings in strains of 0.3, over that at the start, in steps of 0.4 of
// the limit: of that at the start, or of that of the moment.
double fed(bool follows) {
  Block<Default> one({.cells = {{1, 1, 1}}, .nodes = {{9, 9, 9}}, .per_axis = 1}, tissue);
  Mat3<double> const L{{0.3, 0.1, 0.05, 0.1, -0.25, 0.2, 0.05, 0.2, 0.1}};
  one.stir({}, 1 / one.limit() * L);
  double const at_start = 0.4 * one.limit();
  double start = 0, most = 0;
  for (int s = 0; s < 1200; ++s) {
    double const energy = one.step(follows ? 0.4 * one.limit() : at_start);
    if (s == 0) start = energy;
    most = max(most, energy);
  }
  return most / start;
}

}  // namespace

// A step that is shorter in every crest is no longer symplectic. Nothing of a lone particle is hidden from the
// grid, so nothing damps it either; in a block the transfer does.
TEST_CASE("a step that follows the swings of a lone particle feeds them",
          "[stability][B3][control]") {
  double const steady = fed(false), following = fed(true);
  CAPTURE(steady, following);
  CHECK(steady < 1.05);  // 1.035, of the measure in large strains
  CHECK(following > 1.2);
}

// So chosen substeps do not follow it (scene/held_limit.hpp). All six of these rows did, and ended in NaN. Nothing
// derives how much a held limit may feed: these rows were measured to take 1.2 to 9.0 times their energy, and docs/
// decisions/0010 measured up to 12 in 16 times as many substeps. So 10 tells a swing that stays from one that ends
// in NaN, and no more.
TEST_CASE("substeps that are chosen do not feed the swings of a lone particle", "[stability][B3]") {
  for (double const strain : {0.3, 0.6})
    for (double const limits : {1.5, 4.3, 20.0}) {
      Block<Default> one({.cells = {{1, 1, 1}}, .nodes = {{9, 9, 9}}, .per_axis = 1, .substeps = 0},
                         tissue);
      Mat3<double> const L{{1, 0.33, 0.17, 0.33, -0.83, 0.67, 0.17, 0.67, 0.33}};
      one.stir({}, strain / one.limit() * L);
      double const h = limits * one.limit(), start = one.sums().energy();
      double most = start;
      bool finite = true;  // max() passes a NaN over
      for (int s = 0; s * limits < 1e4; ++s) {
        one.run.step(h);
        auto const now = one.sums();
        finite = finite && now.finite && is_finite(now.energy());
        most = max(most, now.energy());
      }
      CAPTURE(strain, limits, most / start, one.run.status(0));
      CHECK(finite);
      CHECK(one.run.status(0) == 0);
      CHECK(most < 10 * start);
    }
}
