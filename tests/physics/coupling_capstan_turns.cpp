// A3.16: a thread drawn round half a turn in gel, 16 segments of 0.79 cells. A full turn: coupling_capstan_turns_long.cpp.
// seconds: 6
// on a device
#include "catch.hpp"
#include "physics/wound_thread.hpp"

using namespace test;

TEST_CASE("A3.16: friction round half a turn grows as a capstan's", "[coupling][capstan]") {
  for (double const friction : {0.1, 0.2, 0.3}) {
    auto const w = draw_round(half_turn(friction), 0.02);
    CAPTURE(friction, w.ratio, w.angle, w.track);
    CHECK(w.ratio == Approx(std::exp(friction * w.track)).epsilon(0.02));
    CHECK(w.status == 0);
  }
}
