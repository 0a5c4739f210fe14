// A2.9: a beam of four cells sags under its own weight by as much as the elastica, and some percent more.
// seconds: 48
// on a device
#include "physics/sagging_beam.hpp"

using namespace test;

namespace {
template <class... Policies> using Body = Mpm<NeoHookean, Policies...>;

template <class Body> void check(double at_2, double at_5) {
  double const two = sag_ratio<Body>(heavy, 4), five = sag_ratio<Body>(heavier, 4);
  CAPTURE(Body::Shape::name.view(), Body::Transfer::name.view(), Body::Form::name.view(), two,
          five);
  CHECK(two <= at_2);
  CHECK(two >= 1.0);
  CHECK(five <= at_5);
  CHECK(five >= 1.0);
}
}  // namespace

TEST_CASE("A beam sags", "[mpm]") {
  check<Body<Apic, QuadraticBSpline, WeightGradient>>(1.06, 1.07);
  check<Body<Flip, QuadraticBSpline, WeightGradient>>(1.06, 1.07);
  check<Body<Apic, CubicBSpline, WeightGradient>>(1.06, 1.07);
  check<Body<Apic, QuadraticBSpline, Mls>>(1.12, 1.10);
}
