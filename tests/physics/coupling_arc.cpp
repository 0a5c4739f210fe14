// A4.1, the parts that need no long way. How the compression of an open arc grows while it travels its own
// length, and falls with the cell, is in coupling_arc_long.cpp.
// seconds: 25
// on a device
#include "catch.hpp"

#include "physics/arc_in_gel.hpp"

using namespace test;

TEST_CASE("a ring that turns about its centre meets friction alone", "[coupling][embedded][arc]") {
  ArcInGel ring({.angle = 2 * pi<double>});
  ring.turn(4);
  double least = 1e300, most = 0;
  for (int i = 0; i < 8; ++i) {
    ring.turn(0.5);
    auto const f = ring.forces();
    CAPTURE(i, f.compression, f.radial, f.axial, f.moment, f.force);
    CHECK(f.radial < 0.05);  // at every point, not only in sum
    CHECK(f.axial < 0.05);
    CHECK(f.force < 0.01);
    // What is radial adds its own friction; nothing else makes the moment.
    CHECK(std::abs(f.moment - 1 - ArcInGel::friction * f.radial) < 0.005);
    least = std::min(least, f.moment);
    most = std::max(most, f.moment);
  }
  CHECK(most - least < 0.01 * least);
  CHECK(ring.run.status(0) == 0);
}

TEST_CASE("an arc that turns about its centre is not pressed by its way",
          "[coupling][embedded][arc]") {
  ArcInGel arc({.angle = pi<double>});
  arc.turn(2);
  double least = 1e300, most = 0;
  for (int i = 0; i < 5; ++i) {
    arc.turn(0.5);
    auto const f = arc.forces();
    CAPTURE(i, f.compression, f.axial, f.moment, f.along_chord);
    CHECK(std::abs(f.compression) < 0.05);
    CHECK(f.axial < 0.05);
    // The gel that friction carries along past the ends presses on them: less of it on a finer grid.
    CHECK(std::abs(f.along_chord - 1) < 0.1);
    CHECK(std::abs(f.moment - 1 - ArcInGel::friction * f.radial) < 0.005);
    least = std::min(least, f.moment);
    most = std::max(most, f.moment);
  }
  CHECK(most - least < 0.01 * least);
}

TEST_CASE("an arc that turns about another point is pressed",
          "[coupling][embedded][arc][control]") {
  ArcInGel arc({.angle = pi<double>, .pivot = 0.5});
  arc.turn(1);
  CHECK(arc.forces().compression > 0.5);
}
