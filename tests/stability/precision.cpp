// B43: numbers too small for float's normal range. Float against double: physics/mpm_float.cpp.
// seconds: 1
#include <mpmpbd/mpm/materials/neo_hookean.hpp>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "catch.hpp"
#include "physics/swinging_block.hpp"

using namespace test;

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
