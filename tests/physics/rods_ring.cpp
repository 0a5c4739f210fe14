// A3.11 of verification.md: a straight rod bent into a ring leaves its plane when it is twisted by 2 pi sqrt(3) EI/GJ
// (Michell 1889, Zajac 1962).
// seconds: 4
// on a device
#include "catch.hpp"
#include "physics/framed_at_rest.hpp"

using namespace rods;

namespace {
struct Body : Pbd<Cosserat, DirectFrames<2>> {};
double const R = 0.27, stiffness = 2.6e-5, line_density = 3.3e-3;
int const segments = 64;

// A ring cut at its first segment: both sides of the cut are held there, one turned by `twist` [rad] against the other,
// which holds a ring in space and does nothing else to it.
Simulated<Body> ring(double nu, double twist) {
  double const step = 2 * pi<double> / segments;
  Line points;
  for (int i = 0; i <= segments + 1; ++i)
    points.push_back(R * vec(std::cos(step * i), std::sin(step * i), 0.0));
  RodAssembly<Body> rod;
  add_framed_thread(rod, points, twisted(frames_along(points), twist),
                    thin_wire(stiffness, stiffness / (1 + nu), line_density, 1e-3 * R));
  hold_segment(rod, 0, 0);
  hold_segment(rod, segments, segments);
  Simulated<Body> rig(rod);
  for (int b = 2; b < segments; ++b) {
    auto x = rig.x(b);
    x[2] = 1e-4 * R * std::sin(2 * step * (b - 0.5));
    rig.store.set<bead::Position>(0, b, x);
  }
  return rig;
}
// How far out of its plane the ring ever gets, in R. (Without contact it turns through itself in the end, loses two
// turns and lies down again.)
double out_of_plane(double nu, double twist) {
  auto rig = ring(nu, twist);
  double const unit = square(R) * std::sqrt(line_density / stiffness), h = 0.02 * unit;
  double most = 0;
  for (int s = 0; s < 6000; ++s) {
    rig.step(h, 0.0);
    slow_down(rig, std::exp(-h / unit));
    for (std::int64_t b = 0; b < rig.beads(); ++b) most = max(most, abs(rig.x(b)[2]));
  }
  CHECK(rig.faults == 0);
  return most / R;
}
}  // namespace

TEST_CASE("A3.11: a twisted ring leaves its plane at Michell's twist", "[frames][physics]") {
  struct Row {
    double nu, critical;
  };
  for (auto const& row : {Row{0.25, 13.6035}, Row{0.5, 16.3242}}) {
    CHECK(row.critical == Approx(2 * pi<double> * std::sqrt(3.0) * (1 + row.nu)).epsilon(1e-5));
    double const below = out_of_plane(row.nu, 0.95 * row.critical),
                 above = out_of_plane(row.nu, 1.05 * row.critical);
    CAPTURE(row.nu, below, above);
    CHECK(below < 3e-4);  // it begins at 1e-4
    CHECK(above > 0.1);
  }
}
