// A2.7: two elastic discs meet and part (Sulsky, Chen and Schreyer 1994), in plane strain: how much of the
// kinetic energy each transfer gives back.
// seconds: 45
// on a device
#include <mpmpbd/mpm/transfer/pic.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>

#include "catch.hpp"
#include "physics/colliding_discs.hpp"

using namespace test;

namespace {

template <class... Policies> using Quadratic = Mpm<NeoHookean, QuadraticBSpline, Policies...>;

template <class Body> DiscOutcome collide(int cells) {
  auto const o = Discs<Body>(cells).collide();
  CAPTURE(Body::Transfer::name.view(), Body::Form::name.view(), cells, o.kinetic, o.least, o.when,
          o.most);
  // 2 pi R^2 rho v^2 / 2. The edge is made of squares: 3.5 % and 1 % more at 20 and 40 cells.
  CHECK_THAT(o.start, WithinRel(2.513274, 0.04));
  CHECK(o.status == 0);
  CHECK(o.most <= 1.001);
  CHECK(o.momentum <= o.rounding);
  return o;
}
// What is left of the kinetic energy at 20 and 40 cells.
template <class Body> void check(double coarse, double fine) {
  double const at_20 = collide<Body>(20).kinetic, at_40 = collide<Body>(40).kinetic;
  CAPTURE(Body::Transfer::name.view(), Body::Form::name.view());
  CHECK_THAT(at_20, WithinAbs(coarse, 0.05));
  CHECK_THAT(at_40, WithinAbs(fine, 0.05));
  CHECK(at_40 > at_20);
}

}  // namespace

TEST_CASE("Colliding discs keep most with FLIP", "[mpm][energy]") {
  check<Quadratic<Flip, WeightGradient>>(0.859, 0.888);
}

TEST_CASE("Colliding discs lose what affine transfers cannot carry", "[mpm][energy]") {
  check<Quadratic<Apic, WeightGradient>>(0.307, 0.614);
  check<Quadratic<Tpic, WeightGradient>>(0.334, 0.614);
  check<Quadratic<Apic, Mls>>(0.287, 0.609);
}

TEST_CASE("Colliding discs stay together with PIC", "[mpm][energy]") {
  check<Quadratic<Pic, WeightGradient>>(0.004, 0.115);
}

TEST_CASE("Colliding discs are slowest when they are closest", "[mpm][energy]") {
  CHECK_THAT((collide<Quadratic<Flip, WeightGradient>>(20).when), WithinAbs(1.93, 0.05));
}

TEST_CASE("Colliding discs gain nothing with cubic shapes", "[mpm][energy]") {
  collide<Mpm<NeoHookean, CubicBSpline, Flip, WeightGradient>>(20);
  collide<Mpm<NeoHookean, CubicBSpline, Apic, Mls>>(20);
}
