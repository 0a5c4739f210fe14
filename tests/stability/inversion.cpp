// B16: particles that are turned inside out, or pressed together, and let go.
//
// F <- (I + dt C) F with dt |C| <= 1/2 multiplies det F by a positive number: no particle of a run ever turns
// inside out (time_step.cpp), and one that is put in so stays so for ever, as a flat one stays flat. What can
// be asked is that it spoils nothing; and that what was pressed but not inverted comes back.
// seconds: 1
#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>

#include "catch.hpp"
#include "stability/block.hpp"

using namespace test;

namespace {

constexpr double E = 1e4, nu = 0.3;
template <class Material> struct Damped : Scene<Mpm<Material>, Damping> {};
using testing::Samples;

template <class Material> Block<Damped<Material>> block_of(int cells) {
  BlockCase const c{.low = vec(8.63, 8.77, 8.41),
                    .cells = {{cells, cells, cells}},
                    .nodes = {{21, 21, 21}},
                    .per_axis = 1};
  Block<Damped<Material>> block(c, lame(E, nu));
  block.run.template set<Damping>({0.5 * mpmpbd::sqrt(E / c.density) / c.cell});
  return block;
}

// Mean of |(F^T F - I) / 2| in the root mean square.
template <class B> double strain(B const& block) {
  double sum = 0;
  for (std::int64_t p = 0; p < block.size(); ++p) {
    auto const F = block.template get<particle::Deformation>(p);
    auto const e = 0.5 * (transpose(F) * F - Mat3<double>::identity());
    sum += dot(e, e);
  }
  return mpmpbd::sqrt(sum / double(block.size()));
}

// Lets go for so many transits of a wave through the block: finite, and never more energy than was stored.
template <class B> void let_go(B& block, double transits) {
  auto const start = block.sums();
  double const transit = block.c.cells[0] * block.c.cell / mpmpbd::sqrt(E / block.c.density);
  double most = 0, time = 0, h = 1e300;
  while (time < transits * transit) {
    h = min(h, block.run.suggest_dt(0));
    most = max(most, block.step(h));
    time += h;
  }
  CAPTURE(most / start.energy());
  CHECK(block.run.status(0) == 0);
  CHECK(block.sums().finite);
  CHECK(most <= (1 + 1e-3) * start.energy());
}

template <class B> void turn_inside_out(B& block, double share) {
  Samples random(23);
  for (std::int64_t p = 0; p < block.size(); ++p) {
    if (random.uniform(0, 1) > share) continue;
    block.template set<particle::Deformation>(
        p, random.deformation(0.7, 1.4) * Samples::diagonal(1, -1, 1));
  }
}

template <class B> void press(B& block, Mat3<double> const& F) {
  for (std::int64_t p = 0; p < block.size(); ++p) {
    auto const x = block.template get<particle::Position>(p) - block.c.middle();
    block.template set<particle::Position>(p, block.c.middle() + F * x);
    block.template set<particle::Deformation>(p, F);
  }
}

}  // namespace

TEMPLATE_TEST_CASE("three of ten particles inside out stay so and harm nobody", "[stability][B16]",
                   StableNeoHookean, FixedCorotated) {
  auto block = block_of<TestType>(4);
  turn_inside_out(block, 0.3);
  std::vector<double> sign;
  for (std::int64_t p = 0; p < block.size(); ++p)
    sign.push_back(determinant(block.template get<particle::Deformation>(p)));
  let_go(block, 20);
  auto const end = block.sums();
  CHECK(end.kinetic < 1e-3 * end.strain);  // at rest under the strains that are left
  for (std::int64_t p = 0; p < block.size(); ++p)
    CHECK(sign[static_cast<std::size_t>(p)] *
              determinant(block.template get<particle::Deformation>(p)) >
          0);
}

TEMPLATE_TEST_CASE("a block pressed to a tenth, or to a hundredth of its volume, comes back",
                   "[stability][B16]", NeoHookean, StableNeoHookean, FixedCorotated) {
  for (auto const& F : {Samples::diagonal(1, 1, 0.1), Samples::diagonal(0.22, 0.22, 0.22)}) {
    auto block = block_of<TestType>(4);
    press(block, F);
    let_go(block, 20);
    CAPTURE(determinant(F), block.sums().least_volume, strain(block));
    CHECK(block.sums().least_volume > 0.5);
    CHECK(strain(block) < 0.05);
  }
}

// Exactly flat: there is nothing to multiply. It neither spoils its neighbours nor becomes a NaN.
TEMPLATE_TEST_CASE("flat particles stay flat and finite", "[stability][B16]", StableNeoHookean,
                   FixedCorotated) {
  auto block = block_of<TestType>(4);
  for (std::int64_t p = 0; p < block.size(); p += 3)
    block.template set<particle::Deformation>(
        p, p % 2 ? Samples::diagonal(1, 1, 0) : Samples::diagonal(0, 0, 0));
  for (int s = 0; s < 1000; ++s) block.run.step(block.run.suggest_dt(0));
  CHECK(block.run.status(0) == 0);
  CHECK(block.sums().finite);
  for (std::int64_t p = 0; p < block.size(); ++p) {
    double const J = determinant(block.template get<particle::Deformation>(p));
    if (p % 3 == 0)
      CHECK(mpmpbd::abs(J) < 1e-12);
    else
      CHECK(J > 0.5);
  }
}

TEST_CASE("a logarithm of an inverted volume is reported, that of a small one is not cut off",
          "[stability][B16]") {
  auto block = block_of<NeoHookean>(4);
  turn_inside_out(block, 0.3);
  block.run.step(block.run.suggest_dt(0));
  CHECK(block.run.status(0) == static_cast<std::uint32_t>(Fault::inversion));
  CHECK(block.sums().finite);

  auto const k = lame(E, nu);
  mpmpbd::detail::Archetype<NeoHookean, double> crushed{};
  crushed[particle::Deformation{}] = Samples::diagonal(0.01, 0.01, 0.01);
  auto const tau = NeoHookean::kirchhoff(crushed, k);
  CHECK_THAT(tau(0, 0), WithinRel(k.mu * (1e-4 - 1) + k.lambda * std::log(1e-6), 1e-12));
}
