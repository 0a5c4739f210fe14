// A4.2: the force on a straight needle that is pushed into gel and drawn out again, against its depth.
// seconds: 25
// on a device
#include "catch.hpp"

#include "physics/pushed_needle.hpp"

using namespace test;

TEST_CASE("friction and drag grow with the depth of a needle and turn with its motion",
          "[coupling][embedded][friction][drag]") {
  Stroke<> s({});
  s.move_to(s.way.deepest, 1, s.in);
  double const pushed = s.work;
  s.move_to(-s.clear, -1, s.out);
  double const drawn = s.work - pushed;

  CAPTURE(s.in.slope() / s.slope(), s.out.slope() / s.slope());
  CHECK(std::abs(s.in.slope() / s.slope() - 1) < 0.03);
  CHECK(std::abs(s.out.slope() / s.slope() - 1) < 0.03);
  CHECK(std::abs(s.out.slope() / s.in.slope() - 1) < 0.03);
  // On a surface that lies on nodes coverage is 1/4 at 0.515 cells above it, and weights need no more than 8 times
  // their correction from 0.468 cells on: contact begins there, within a step of the needle. It is compliant up to
  // the surface, where coverage is 1/2: the offset of the force is between.
  double const margin = s.in.offset() / s.slope();
  CAPTURE(margin, s.out.offset() / s.slope());
  CHECK(s.touched == Approx(-0.468).margin(0.25 * s.way.speed));
  CHECK(margin > 0);
  CHECK(margin < -s.touched);

  CAPTURE(pushed / drawn, s.work / s.cycle());
  CHECK(std::abs(pushed / drawn - 1) < 0.03);
  CHECK(std::abs(s.work / s.cycle() - 1) < 0.03);
  double const left = s.displacement();
  CAPTURE(left);
  CHECK(left < 0.01);
  CHECK(norm(s.run.state().get<needle::Force>(0, 0)) == 0);
  CHECK(s.run.status(0) == 0);
}

// The same constant for a needle that goes less deep, faster, or in cells of half the size: a scene without
// dimensions knows of these only by what a cell's length of needle resists, over the cell and the modulus of the gel.
TEST_CASE("contact goes as far beyond the surface at any depth, speed and cell",
          "[coupling][embedded][friction][drag]") {
  for (Way const& way : {Way{5, 0.1, 1}, Way{5, 0.05, 2}}) {
    Stroke<> s(way);
    s.move_to(way.deepest, 1, s.in);
    s.move_to(-s.clear, -1, s.out);
    double const own = std::sqrt(s.work / (s.slope() * gel_cell)) - way.deepest;
    CAPTURE(way.speed, way.per_cell, own, s.work / s.cycle());
    CHECK(std::abs(s.work / s.cycle() - 1) < 0.03);
    CHECK(own < 0.468);
  }
}
