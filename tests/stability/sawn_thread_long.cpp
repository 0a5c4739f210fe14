// B33: a hundred strokes of a suture through gel.
// seconds: 60
#include "stability/sawn_thread.hpp"

using namespace test;

TEST_CASE("a suture saws through gel a hundred times", "[stability][B33][long]") {
  saw(straight_saw(), 100, 10, clamp_friction(straight_saw()));
}
