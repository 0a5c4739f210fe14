// A2.6 at sixteen cells in the radius: FLIP loses less of the spin than at eight.
// seconds: 60
// on a device
#include "physics/spinning_disc_checks.hpp"

using namespace test;

// Measured: 0.9961.
TEST_CASE("A disc in free flight loses half a percent of its spin with FLIP on finer cells") {
  CHECK_THAT((fly<16, Flip, WeightGradient>().spin), WithinAbs(0.996, 0.003));
}
