// A2.10: Hertz's law for a sphere of 8 cells: an exponent of 1.513 with a gap of 0, the least allowed (0.27 more per
// 0.1 dx of gap). With 16 cells it is 1.33 from 0.3 mm on, and 1.5 from 1 mm on: mpm_hertz_long. See hertz.hpp.
// seconds: 60
// processors: 2
// on a device
#include "physics/hertz.hpp"

using namespace test;

TEST_CASE("A2.10: the fit of a force finds the exponent that it has", "[mpm][contact]") {
  double const dx = Indentation::radius / 8;
  for (double const exponent : {1.0, 1.3, 1.5, 1.7, 2.0})
    for (double const gap : {0.0, 0.5 * dx, 1.0 * dx}) {
      Indentation::Curve made;
      for (int n = 0; n < 16; ++n) {
        made.depth.push_back(Indentation::deepest * (n + 0.5) / 16);
        made.force.push_back(2.7e3 * std::pow(made.depth.back() + gap, exponent));
      }
      auto const fit = fit_hertz(made, 0.3e-3, 1.5e-3, 1.5 * dx);
      CAPTURE(exponent, gap / dx, fit.gap / dx, fit.exponent);
      CHECK(fit.exponent == Approx(exponent).margin(1e-3));
      CHECK(fit.gap == Approx(gap).margin(1e-3 * dx));
      if (exponent != 1.5) CHECK_FALSE(std::abs(fit.exponent - 1.5) < 0.05);  // as demanded below
    }
}

TEST_CASE("A2.10: a sphere meets tissue with a force that grows as depth^1.5", "[mpm][contact]") {
  CHECK(Indentation::hertz(1e-3) == Approx(52.870e-3).epsilon(1e-4));
  double const dx = Indentation::radius / 8;
  auto const fit = fit_hertz(Indentation(8).press(16), 0.3e-3, 1.5e-3, 1.5 * dx);
  CAPTURE(fit.gap / dx, fit.stiffness, fit.exponent, fit.left);
  CHECK(fit.exponent == Approx(1.5).margin(0.05));
  CHECK(fit.left < 0.05);  // measured 0.028: the steps of nodes that come to touch the sphere
}
