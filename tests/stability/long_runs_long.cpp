// B39: a million steps.
// seconds: 900
#include "stability/long_runs.hpp"

using namespace test::long_runs;

TEST_CASE("a block spins for a million steps", "[stability][B39]") {
  check_spin<double>(1'000'000, 1e-16);
  check_spin<float>(1'000'000, 0.5 * double(mpmpbd::epsilon<float>));
}
TEST_CASE("a thread hangs for a million steps", "[stability][B39]") { check_hanging(1'000'000); }
TEST_CASE("stitched gel rests for a million steps", "[stability][B39]") {
  check_stitched(1'000'000);
}
