// A3.18 of verification.md: a clamped beam under a force at its tip that is too short for bending alone. Timoshenko's
// beam moves by P L^3/3EI + P L/kGA. The joints, half a one at the wall, integrate the bending moment by the trapezoidal
// rule, which adds 1/(2 n^2) of the first part; every segment shears by the same P l/kGA.
// seconds: 1
// on a device
#include "catch.hpp"
#include "physics/framed_at_rest.hpp"

using namespace rods;

namespace {
struct Body : Pbd<Cosserat, DirectFrames<3>> {};

struct Beam {
  double length;  // [m]
  int segments;
  RodMaterial material{3e6, 2.3e-3, 1100};

  // Of the tip under a force P [N]: what is bent and what is sheared [m].
  double bent(double P) const {
    return P * square(length) * length / (3 * material.bending_stiffness());
  }
  double sheared(double P) const { return P * length / material.shear_stiffness(); }

  double deflection(double P) const {
    double const l = length / segments;
    RodAssembly<Body> rod;
    add_framed_thread(rod, straight({{-l, 0, 0}}, {{length, 0, 0}}, segments + 2), material);
    hold_segment(rod, 0, 0);
    Simulated<Body> rig(rod);
    keep_share(rig, 0, 0.5);
    double const unit =
        square(length) * std::sqrt(material.line_density() / material.bending_stiffness());
    CHECK(settle(rig, 0.02 * unit, 4 / unit, 1e-9 * bent(P) / unit, 6000, [&](auto& r, double h) {
      push(r, segments + 1, {{0, 0, P}}, h);
    }));
    CHECK(rig.faults == 0);
    return rig.x(segments + 1)[2];
  }
};
}  // namespace

TEST_CASE("A3.18: a short beam shears as much as Timoshenko says", "[bend][frames][physics]") {
  double const r = Beam{}.material.radius;
  double before = 0;
  for (double const slenderness : {30.0, 6.0, 2.5}) {
    Beam const beam{slenderness * r, 12};
    double const P = 1e-4 * beam.length / beam.bent(1.0);  // so small that the beam stays linear
    double const moved = beam.deflection(P), timoshenko = beam.bent(P) + beam.sheared(P);
    CAPTURE(slenderness, moved / timoshenko - 1, beam.sheared(P) / beam.bent(P));
    CHECK(moved == Approx(timoshenko).epsilon(1e-2));
    CHECK(moved == Approx((1 + 0.5 / 144) * beam.bent(P) + beam.sheared(P)).epsilon(1e-5));
    CHECK(moved / beam.bent(P) > before);  // the shorter, the more of it is shear
    before = moved / beam.bent(P);
  }
  CHECK(before > 1.3);
}
