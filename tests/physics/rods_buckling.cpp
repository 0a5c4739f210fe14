// A3.10 of verification.md: a clamped column stands at 0.95 and falls at 1.05 of its critical length, under an end
// load (Euler) and under its own weight (Greenhill).
// seconds: 2
// on a device
#include "catch.hpp"
#include "physics/rods_at_rest.hpp"

using namespace rods;

namespace {
struct Body : Pbd<Constraints<Distance, Bend>, DirectBanded<2>> {};
double const length = 0.43, stiffness = 3.1e-5, line_density = 2.9e-3;
Cantilever const column{
    thin_wire(stiffness, line_density, 1e-4), length, 32, {{0, 0, 1}}, 0.5, 0.0};

// Lets a column go that leans by 1e-4 of its length; the slope of its tip [rad] after a time (in units of bending).
double slope_after(double time, double tip_load, double g) {
  auto loaded = column;
  loaded.tip_weight = tip_load > 0 ? 0.25 : 0.0;
  auto rig = loaded.build<Body>();
  for (int b = 2; b <= column.tip(); ++b) {
    double const s = double(b - 1) / column.segments;
    rig.store.set<bead::Position>(0, b, {{1e-4 * length * s * s, 0, length * s}});
  }
  double const unit = column.unit(), h = 4e-3 * unit;
  for (int s = 0; s * h < time * unit; ++s) {
    push(rig, column.tip(), {{0, 0, -tip_load}}, h);
    rig.step(h, g);
    slow_down(rig, std::exp(-2 / unit * h));
  }
  CHECK(rig.faults == 0);
  auto const last = rig.x(column.tip()) - rig.x(column.tip() - 1);
  return std::atan2(last[0], last[2]);
}
double const start = 2e-4;  // slope of the tip

// The slope at the tip of a clamped elastica under an axial load of `ratio` critical ones:
// K(sin(slope/2)) = pi/2 sqrt(ratio).
double elastica_slope(double ratio) {
  double low = 0, high = pi<double>;
  for (int i = 0; i < 60; ++i) {
    double const middle = 0.5 * (low + high);
    bool const above = std::comp_ellint_1(std::sin(middle / 2)) > pi<double> / 2 * std::sqrt(ratio);
    (above ? high : low) = middle;
  }
  return low;
}
}  // namespace

TEST_CASE("A3.10: Euler's column", "[bend][physics]") {
  double const critical = square(pi<double>) * stiffness / (4 * square(length));
  double const stands = slope_after(60, square(0.95) * critical, 0),
               falls = slope_after(60, square(1.05) * critical, 0);
  CAPTURE(stands, falls);
  CHECK(std::abs(stands) < 0.1 * start);
  // The joints' own critical load is (pi / 4N)^2 / 3 = 2e-4 below the beam's: 1e-3 of the slope.
  CHECK(falls == Approx(elastica_slope(square(1.05))).epsilon(5e-3));
}

TEST_CASE("A3.10: Greenhill's column", "[bend][physics]") {
  double const critical = 7.8373 * stiffness / (line_density * std::pow(length, 3));
  double const stands = slope_after(60, 0, std::pow(0.95, 3) * critical),
               falls = slope_after(60, 0, std::pow(1.05, 3) * critical);
  CAPTURE(stands, falls);
  CHECK(std::abs(stands) < 0.1 * start);
  CHECK(falls > 0.5);
}
