// B39 over 1e5 steps and fewer; over a million in long_runs_long.cpp.
// seconds: 12
#include "stability/long_runs.hpp"

using namespace test::long_runs;

TEST_CASE("a block spins for 1e5 steps", "[stability][B39]") {
  check_spin<double>(100'000, 1e-15);
  check_spin<float>(100'000, 0.5 * double(mpmpbd::epsilon<float>));
}
TEST_CASE("a thread hangs for 1e5 steps", "[stability][B39]") { check_hanging(100'000); }
TEST_CASE("stitched gel rests for 2e4 steps", "[stability][B39]") { check_stitched(20'000); }
