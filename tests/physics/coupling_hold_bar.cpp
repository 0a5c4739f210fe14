// A rigid bar that is pushed sideways for ten seconds does not creep through the tissue.
// seconds: 45
// on a device
#include "physics/held_line_checks.hpp"

using namespace test;

TEST_CASE("a rigid bar does not creep in ten seconds", "[coupling][hold]") {
  Held bar = held_bar(1e-2, 0.5);
  double const load = 8;
  Slip const slip = watch(
      bar, [&] { bar.push(0, mpmpbd::vec(load * ramp(bar.time), 0.0, 0.0)); }, 10 * second);
  CAPTURE(slip.settled, slip.growth, slip.reaction);
  CHECK(slip.growth < 1e-3);
  CHECK(std::abs(slip.reaction / load - 1) < 0.01);
}
