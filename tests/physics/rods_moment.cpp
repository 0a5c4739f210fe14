// A3.6 of verification.md: a pure moment at the end bends a rod into an arc, and 2 pi EI/L closes the circle.
// seconds: 1
// on a device
#include "catch.hpp"
#include "physics/framed_at_rest.hpp"

using namespace rods;

namespace {
struct Body : Pbd<Cosserat, DirectFrames<2>> {};
double const length = 0.37, EI = 2.3e-5, GJ = 1.7e-5,
             line_density = 4.1e-3;  // [m], [N m^2], [kg/m]
int const segments = 32;

double const l = length / segments, unit = square(length) * std::sqrt(line_density / EI);

RodAssembly<Body> clamped() {
  RodAssembly<Body> rod;
  add_framed_thread(rod, straight({{-l, 0, 0}}, {{length, 0, 0}}, segments + 2),
                    thin_wire(EI, GJ, line_density, 1e-4));
  hold_segment(rod, 0, 0);
  return rod;
}
}  // namespace

TEST_CASE("A3.6: a moment bends a rod into an arc", "[bend][frames][physics]") {
  Simulated<Body> rig(clamped());
  keep_share(rig, 0, 0.5);
  // The moment turns a flywheel, so that a step turns it little; at rest its inertia does not count.
  rig.store.set<frame::InverseInertia>(0, segments,
                                       1 / (0.05 * line_density * std::pow(length, 3)));
  V3 const moment{{0, 0, pi<double> * EI / (2 * length)}};
  CHECK(settle(rig, 1e-3 * unit, 5 / unit, 1e-8 * length / unit, 40000,
               [&](auto& r, double h) { twist(r, segments, moment, h); }));
  CHECK(rig.faults == 0);
  auto const tip = 1 / length * rig.x(segments + 1);
  CAPTURE(tip[0], tip[1]);
  CHECK(tip[0] == Approx(2 / pi<double>).epsilon(2e-3));
  CHECK(tip[1] == Approx(2 / pi<double>).epsilon(2e-3));
  CHECK(std::abs(tip[2]) < 2e-3);
}

// The same, led: the last frame turns to where the moment would hold it, and the moment is read from the joints. (A
// free end under a moment of fixed axis leaves the plane long before the circle closes, from rounding.)
TEST_CASE("A3.6: four times the moment closes the circle", "[bend][frames][physics]") {
  auto rod = clamped();
  double const turn = 2 * pi<double> * (segments - 0.5) / segments, h = 1e-3 * unit;
  int const leading = 2000;
  rod.prescribe_frame(segments, {{0, 0, turn / (leading * h)}});
  Simulated<Body> rig(rod);
  keep_share(rig, 0, 0.5);
  for (int s = 0; s < 3 * leading; ++s) {
    if (s == leading) rig.store.set<frame::AngularVelocity>(0, segments, {});
    rig.step(h, 0.0);
    slow_down(rig, std::exp(-10 * h / unit));
  }
  CHECK(rig.faults == 0);
  auto const tip = 1 / length * rig.x(segments + 1);
  CAPTURE(tip[0], tip[1], tip[2]);
  CHECK(norm(tip) < 5e-3);
  for (std::int64_t i = 0; i < rig.store.table<Instances<BendTwist>>().live(0); ++i)
    CHECK(norm(rig.store.get<instance<BendTwist>::Multiplier>(0, i)) ==
          Approx(2 * pi<double> * EI / length).epsilon(2e-3));
}
