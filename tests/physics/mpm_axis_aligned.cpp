// A2.4: a vibrating cube, manufactured (Wallstedt and Guilkey 2008): the orders of A2.2 in 3-D.
// seconds: 40
// on a device
#include <mpmpbd/mpm/transfer/tpic.hpp>

#include "physics/axis_aligned.hpp"

using namespace test;

namespace {

template <class... Policies> using Body = Mpm<NeoHookean, QuadraticBSpline, Policies...>;

// At 16 cells a side a wave of the cube is 32 cells long. Bounds: 1.5 times what was measured.
template <class Body> void check(double most) {
  double const coarse = MirroredCube<Body>(8).error(), fine = MirroredCube<Body>(16).error();
  double const order = std::log2(coarse / fine);
  CAPTURE(Body::Transfer::name.view(), Body::Form::name.view(), coarse, fine, order);
  CHECK(fine <= most);
  CHECK(order >= 1.6);
}

}  // namespace

TEST_CASE("The error of a vibrating cube falls with the cells", "[mpm][order]") {
  check<Body<Flip, WeightGradient>>(1.2e-3);  // measured 7.8e-4, order 1.87
  check<Body<Apic, WeightGradient>>(6e-4);    // measured 4.0e-4, order 1.80
  check<Body<Tpic, WeightGradient>>(6e-4);    // measured 4.1e-4, order 1.84
  check<Body<Apic, Mls>>(4.5e-4);             // measured 3.0e-4, order 1.99
}
