// B43: float against double, and numbers too small for float's normal range.
// seconds: 1
#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "catch.hpp"
#include "stability/block.hpp"

using namespace test;

namespace {

template <class Material, class... Policies>
struct Swinging : Scene<Mpm<Material, Policies...>, Gravity, Wall<Sticky, 2, Side::low>> {};

// A block on a floor that swings under gravity, for about three of its periods.
template <class S, class T> Block<S, T> swung(double amplitude) {
  BlockCase const c{.low = vec(4.13, 4.27, 3.0)};
  Block<S, T> block(c, lame(1e4, 0.4));
  block.run.template set<Gravity>({{amplitude * 3.0, 0.0, amplitude * -9.81}});
  block.run.template set<Wall<Sticky, 2, Side::low>>({3 * c.cell});
  for (int s = 0; s < 600; ++s) block.run.step(3e-4);
  return block;
}

// Largest difference of the places in float and double, over the largest way.
template <class S> double difference(double amplitude) {
  auto const fine = swung<S, double>(amplitude);
  auto const coarse = swung<S, float>(amplitude);
  CHECK(fine.run.status(0) == 0);
  CHECK(coarse.run.status(0) == 0);
  auto const start = fine.c.positions();
  double worst = 0, way = 0;
  for (std::int64_t p = 0; p < fine.size(); ++p) {
    auto const x = fine.template get<particle::Position>(p);
    worst = max(worst, norm(coarse.template get<particle::Position>(p) - x));
    way = max(way, norm(x - start[static_cast<std::size_t>(p)]));
  }
  return worst / way;
}

template <class S> void check_float(double amplitude) {
  double const share = difference<S>(amplitude);
  CAPTURE(amplitude, share);
  CHECK(share < 1e-3);
}

}  // namespace

// Places are rounded to about 1e-7 of the domain, so a way of a hundredth of a cell is known to 1e-4.
TEST_CASE("float is double to a thousandth of the motion", "[stability][B43]") {
  for (double const amplitude : {5.0, 0.5}) {
    check_float<Swinging<NeoHookean>>(amplitude);
    check_float<Swinging<NeoHookean, Flip, WeightGradient>>(amplitude);
    check_float<Swinging<StableNeoHookean, CubicBSpline>>(amplitude);
    check_float<Swinging<FixedCorotated, Tpic, WeightGradient>>(amplitude);
  }
}

namespace {

struct Free : Scene<Mpm<NeoHookean>> {};

// A block that moves at a speed of subnormal numbers while it swings with such rates.
Block<Free, float> creeping() {
  Block<Free, float> block({}, lame(1e4, 0.4));
  testing::Samples random(3);
  for (std::int64_t p = 0; p < block.size(); ++p) {
    block.set<particle::Velocity>(p, random.matrix<3>(-1e-40, 1e-40));
    block.set<particle::Affine>(p, random.matrix<3, 3>(-1e-38, 1e-38));
  }
  for (int s = 0; s < 200; ++s) block.run.step(3e-4);
  return block;
}

void check_still(Block<Free, float> const& block) {
  auto const start = block.c.positions();
  CHECK(block.run.status(0) == 0);
  CHECK(block.sums().finite);
  for (std::int64_t p = 0; p < block.size(); ++p) {
    CHECK(norm(block.get<particle::Velocity>(p)) < 1e-38);
    CHECK(block.get<particle::Deformation>(p) == Mat3<double>::identity());
    CHECK(block.get<particle::Position>(p) ==
          cast<double>(cast<float>(start[static_cast<std::size_t>(p)])));
  }
}

}  // namespace

TEST_CASE("speeds below the normal range of float move nothing", "[stability][B43]") {
  check_still(creeping());
}

#if defined(__SSE2__)
TEST_CASE("and nothing else changes where the machine flushes them to zero", "[stability][B43]") {
  auto const kept = swung<Swinging<NeoHookean>, float>(5.0);
  unsigned int const mode = _mm_getcsr();
  _mm_setcsr(mode | 0x8040u);  // flush to zero, subnormals are zero
  auto const still = creeping();
  auto const flushed = swung<Swinging<NeoHookean>, float>(5.0);
  _mm_setcsr(mode);
  check_still(still);
  for (std::int64_t p = 0; p < kept.size(); ++p)
    CHECK(norm(flushed.get<particle::Position>(p) - kept.get<particle::Position>(p)) <
          1e-6 * kept.c.cell);
}
#endif
