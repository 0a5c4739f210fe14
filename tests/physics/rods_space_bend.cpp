// A3.8 of verification.md: an arc of 45 degrees, clamped at one end, under a force out of its plane: bending and twist
// together (Bathe and Bolourchi 1979; the numbers are those of an inextensible Kirchhoff rod).
// seconds: 3
// on a device
#include "catch.hpp"
#include "physics/framed_at_rest.hpp"

using namespace rods;

namespace {
struct Body : Pbd<Cosserat, DirectFrames<3>> {};
double const R = 0.31, stiffness = 2.6e-5, line_density = 3.3e-3;  // [m], [N m^2], [kg/m]; GJ = EI

// The tip over R, for P R^2 / EI.
V3 tip_under(double load, int segments) {
  double const step = pi<double> / 4 / segments;
  Line points{{{-2 * R * std::sin(step / 2), 0, 0}}};  // the clamp, along the arc's first tangent
  for (int i = 0; i <= segments; ++i)
    points.push_back(vec(R * std::sin(step * i), R * (1 - std::cos(step * i)), 0.0));
  RodAssembly<Body> rod;
  add_framed_thread(rod, points, thin_wire(stiffness, stiffness, line_density, 1e-3 * R),
                    RestShape::as_placed);
  hold_segment(rod, 0, 0);
  Simulated<Body> rig(rod);
  keep_share(rig, 0, 0.5);

  double const unit = square(pi<double> / 4 * R) * std::sqrt(line_density / stiffness);
  V3 const force{{0, 0, load * stiffness / square(R)}};
  CHECK(settle(rig, 0.01 * unit, 7 / unit, 1e-8 * R / unit, 6000,
               [&](auto& r, double h) { push(r, segments + 1, force, h); }));
  CHECK(rig.faults == 0);
  return 1 / R * rig.x(segments + 1);
}
}  // namespace

TEST_CASE("A3.8: an arc bends and twists out of its plane", "[bend][frames][physics]") {
  struct Row {
    double load;
    V3 tip;
  };
  for (auto const& row :
       {Row{3.6, {{0.587797, 0.222450, 0.401883}}}, Row{5.4, {{0.522393, 0.185085, 0.484980}}},
        Row{7.2, {{0.471513, 0.156851, 0.534686}}}}) {
    auto const tip = tip_under(row.load, 32);
    CAPTURE(row.load, tip[0], tip[1], tip[2]);
    for (int a = 0; a < 3; ++a) CHECK(tip[a] == Approx(row.tip[a]).epsilon(1e-2));
  }
}

TEST_CASE("A3.8: its error falls with the square of the segment",
          "[bend][frames][physics][order]") {
  V3 const exact{{0.471513, 0.156851, 0.534686}};
  double const coarse = norm(tip_under(7.2, 8) - exact), fine = norm(tip_under(7.2, 16) - exact);
  CAPTURE(coarse, fine, std::log2(coarse / fine));
  CHECK(std::log2(coarse / fine) > 1.8);
}
