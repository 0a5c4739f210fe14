// A3.19 of verification.md: a joint that is bent by 1e-5 rad gives the right torque in float.
// on a device
#include "catch.hpp"
#include "physics/rods_on_back_end.hpp"

using namespace rods;

namespace {
RodMaterial const nylon{2e9, 0.115e-3, 1140};  // 3-0

struct Body : Pbd<Constraints<Bend>, Xpbd<1>> {};

// Torque of a joint between two segments of 2 mm, in one step of a constraint so soft that nothing moves.
template <class T> double torque(double turn) {
  double const l = 2e-3;
  Line const points{{{-l, 0, 0}}, {{0, 0, 0}}, {{l * std::cos(turn), l * std::sin(turn), 0}}};
  RodAssembly<Body> rod;
  add_thread(rod, points, nylon);
  Simulated<Body, T> rig(rod);
  rig.step(1e-9, 0.0);
  return -double(rig.store.template get<instance<Bend>::Multiplier>(0, 0));
}
}  // namespace

TEST_CASE("A3.19: torque of a small angle in float", "[bend][physics]") {
  double const stiffness = nylon.bending_stiffness() / 2e-3;
  for (double turn : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    double const in_float = torque<float>(turn) / (stiffness * turn) - 1,
                 in_double = torque<double>(turn) / (stiffness * turn) - 1;
    INFO("turn " << turn << ": float " << in_float << ", double " << in_double);
    CHECK(std::abs(in_float) < 1e-2);
    CHECK(std::abs(in_double) < 1e-8);
  }
  // The control: the arc cosine of the same unit edges does not see the angle at all.
  float const c = static_cast<float>(std::cos(1e-5));
  CHECK(std::acos(c) == 0.0f);
}

TEST_CASE("a 3-0 thread has the stiffness of its wire", "[constraint][physics]") {
  CHECK(nylon.bending_stiffness() == Approx(2.75e-7).epsilon(2e-3));
  CHECK(nylon.axial_stiffness() == Approx(83).epsilon(2e-3));
}
