// seconds: 3
// on a device
// A3.5 and A3.14, small: a clamped 3-0 nylon thread, its static tip deflection and first period. Stiff bending is what
// the direct solver is for: h^2 w |grad turn|^2 / alpha is 350 and more.
#include "catch.hpp"
#include "physics/rods_on_back_end.hpp"

using namespace rods;

namespace {
RodMaterial const nylon{2e9, 0.115e-3, 1140};
template <int n> struct Body : Pbd<Constraints<Distance, Bend>, DirectBanded<n>> {};
int const segments = 40;
double const length = 0.098, l = length / segments;

// The clamp is the segment before x = 0; the joint at x = 0 stands for a length l.
template <class B> RodAssembly<B> clamped() {
  RodAssembly<B> rod;
  add_thread(rod, straight({{-l, 0, 0}}, {{length, 0, 0}}, segments + 2), nylon);
  rod.prescribe(0);
  rod.prescribe(1);
  return rod;
}
// Tip deflection of the same joints by hand: each turns by alpha M and moves the tip by its distance from it.
double discrete_tip(double g) {
  double tip = 0;
  for (int j = 0; j < segments; ++j) {
    double moment = 0;
    for (int b = j + 1; b <= segments; ++b)
      moment += nylon.line_density() * l * (b == segments ? 0.5 : 1.0) * g * (b - j) * l;
    tip += nylon.bend_compliance(l) * moment * (segments - j) * l;
  }
  return tip;
}
}  // namespace

TEMPLATE_TEST_CASE("a cantilever bends as its EI says", "[bend][physics]", float, double) {
  double const g = 0.01 * gravity, continuous = nylon.line_density() * g * std::pow(length, 4) /
                                                (8 * nylon.bending_stiffness());
  CHECK(discrete_tip(g) == Approx(continuous).epsilon(2.1 / segments));  // a hinge at the wall: 2/N
  for (double h : {1e-3, 1e-4}) {
    Simulated<Body<2>, TestType> rig(clamped<Body<2>>());
    for (int s = 0; s * h < 0.7; ++s) {
      rig.step(h, g);
      for (std::int64_t b = 2; b < rig.beads(); ++b)
        rig.store.template set<bead::Velocity>(0, b, TestType(1 - 60 * h) * rig.v(b));
    }
    INFO("h " << h << ": tip " << rig.x(segments + 1)[2] << ", joints by hand "
              << -discrete_tip(g));
    CHECK(-double(rig.x(segments + 1)[2]) ==
          Approx(discrete_tip(g)).epsilon(sizeof(TestType) == 8 ? 1e-4 : 2e-2));
    CHECK(rig.faults == 0);
  }
}

TEST_CASE("a cantilever swings with the period of its beam", "[bend][physics]") {
  // omega_1 = 3.51601527 sqrt(EI/(rho A L^4)); discrete joints are softer by about 1/N.
  double const omega = 3.51601527 * std::sqrt(nylon.bending_stiffness() /
                                              (nylon.line_density() * std::pow(length, 4)));
  Simulated<Body<2>> rig(clamped<Body<2>>());
  double const g = 0.01 * gravity, h = 1e-4;
  // Released from rest, the tip is lowest after half a period: the velocity changes sign.
  double before = 0, half = 0;
  for (int s = 0; s < 5000 && half == 0; ++s) {
    rig.step(h, g);
    double const v = rig.v(segments + 1)[2];
    if (s > 500 && before < 0 && v >= 0) half = (s + 1 - v / (v - before)) * h;
    before = v;
  }
  INFO("half a period " << half << " s, beam " << pi<double> / omega);
  CHECK(half == Approx(pi<double> / omega).epsilon(0.03));
}
