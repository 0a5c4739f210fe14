// B17: tissue drawn by a suture until it tears out. How far it goes is a matter of the particles along the bar: about
// a cell apart they part.
// seconds: 12
#include "stability/tear_out.hpp"

using namespace test;

TEST_CASE("a suture that tears out is told before, and pulls on nothing after",
          "[stability][B17]") {
  check_tear_out({.along = 2}, 1.8);
  check_tear_out({.along = 4}, 3);
  check_tear_out({.along = 10, .beyond = 3}, 5);
}
