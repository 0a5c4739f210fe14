// Shape functions: partition of unity and its moments, and what the order of the kernel buys (A1.3, A1.8).
#include <mpmpbd/mpm/shape/bspline.hpp>
#include <mpmpbd/testing/shape_laws.hpp>

#include "catch.hpp"

using namespace mpmpbd;

TEMPLATE_TEST_CASE("Shape functions keep their laws anywhere in a cell", "", LinearBSpline,
                   QuadraticBSpline, CubicBSpline) {
  for (auto const& law : shape_laws<TestType, double>()) {
    INFO(law.text());
    CHECK(law.holds());
  }
  for (auto const& law : shape_laws<TestType, float>()) {
    INFO(law.text());
    CHECK(law.holds());
  }
}

// Table A1.8 gives 0.55, 0.0545 and 0.0037 for s = 0.55, over the phases of one lattice; the suprema
// over all phases are s, 2 s (s - 1/2) and 0.00367. MLS forces keep less than half of them.
TEST_CASE("A stretched lattice shows what the order of the shape function buys") {
  double const s = 0.55;
  CHECK_THAT(stretched_lattice_residual<LinearBSpline>(s, false), WithinAbs(s, 1e-12));
  CHECK_THAT(stretched_lattice_residual<QuadraticBSpline>(s, false), WithinRel(0.055, 1e-3));
  CHECK_THAT(stretched_lattice_residual<CubicBSpline>(s, false), WithinRel(0.00367, 1e-3));
  CHECK_THAT(stretched_lattice_residual<QuadraticBSpline>(s, true), WithinRel(0.019074, 1e-3));
  CHECK_THAT(stretched_lattice_residual<CubicBSpline>(s, true), WithinRel(0.0017605, 1e-3));
  for (double const even : {0.5, 1.0}) {
    for (bool const mls : {false, true}) {
      CHECK_THAT(stretched_lattice_residual<QuadraticBSpline>(even, mls), WithinAbs(0.0, 1e-12));
      CHECK_THAT(stretched_lattice_residual<CubicBSpline>(even, mls), WithinAbs(0.0, 1e-12));
    }
  }
}
