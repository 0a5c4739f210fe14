// A2.4: a vibrating cube, manufactured (Wallstedt and Guilkey 2008): the orders of A2.2 in 3-D.
// seconds: 26
#include "physics/axis_aligned.hpp"

using namespace test;

namespace {

template <class... Policies> using Body = Mpm<NeoHookean, QuadraticBSpline, Policies...>;

// With as many cells an axis has no more error than the periodic bar, times the half that A2.2 leaves.
template <class Body> void check(double of_bar_at_16) {
  double const coarse = MirroredCube<Body>(8).error(), fine = MirroredCube<Body>(16).error();
  double const order = std::log2(coarse / fine);
  CAPTURE(Body::Transfer::name.view(), Body::Form::name.view(), coarse, fine, order);
  CHECK(fine <= 1.5 * of_bar_at_16);
  CHECK(order >= 1.3);
}

}  // namespace

TEST_CASE("The error of a vibrating cube falls with the cells", "[mpm][order]") {
  check<Body<Flip, WeightGradient>>(1.9e-3);  // measured 7.8e-4, order 1.87
  check<Body<Apic, Mls>>(3.5e-4);             // measured 3.0e-4, order 1.99
}
