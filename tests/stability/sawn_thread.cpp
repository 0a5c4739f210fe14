// B33: a few strokes of a suture through gel, straight and round a bend. A hundred, straight: sawn_thread_long.cpp.
// seconds: 12
#include "stability/sawn_thread.hpp"

using namespace test;

TEST_CASE("a suture saws through gel and leaves it where it was", "[stability][B33]") {
  saw(straight_saw(), 6, 2, clamp_friction(straight_saw()));
}

TEST_CASE("a suture saws round a bend and leaves the gel where it was", "[stability][B33]") {
  saw(bent_saw(), 8, 4);
}
