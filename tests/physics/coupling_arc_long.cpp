// A4.1 in the steady state of an open arc, which begins when it has gone its own length: gel ahead of the tip
// is carried along straight by friction, is met again beside the arc, and presses on it. Measured share of
// friction then: 0.133, 0.086, 0.055, 0.038 at a radius of 5, 8, 13, 16 cells, 0.6 to 0.7 cells / radius.
// The limit of 5 % therefore takes some 14 cells.
// seconds: 900
// on a device
#include "catch.hpp"

#include "physics/arc_in_gel.hpp"

using namespace test;

TEST_CASE("the compression of an arc by its own wake falls with the cell",
          "[coupling][embedded][arc][long]") {
  for (double radius : {5.0, 8.0, 16.0}) {
    ArcInGel arc({.radius = radius, .angle = pi<double>});
    arc.turn(pi<double> * radius);
    auto const f = arc.forces();
    CAPTURE(radius, f.compression, f.radial, f.moment, f.along_chord);
    CHECK(f.compression < 0.8 / radius);
    CHECK(std::abs(f.along_chord - 1) < 0.6 / radius);
    CHECK(std::abs(f.moment - 1 - ArcInGel::friction * f.radial) < 0.005);
    if (radius == 16.0) CHECK(f.compression < 0.05);
    CHECK(arc.run.status(0) == 0);
  }
}
