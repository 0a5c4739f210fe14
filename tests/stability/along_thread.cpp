// B28: a suture of 0.2 mm in segments of half a millimetre. What it pushes with does not depend on where its
// beads are, nor on the metre.
// seconds: 1
#include "catch.hpp"
#include "physics/held_line.hpp"

namespace {

using namespace test;
using Smooth =
    mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;

// Cells of 0.77 mm; a modulus of 3.6 kPa, or scales of metres for comparison.
Units const millimetres{7.6923e-4, 1050.0, 3.6e3}, metres{0.76923, 1.05, 3.6};

// The lateral force on a straight thread across the block that has moved sideways by 0.3 cells: its mean over
// the last third of the way. The thread is shifted along itself by a share of a segment.
template <class T> double force(Units const& units, double share) {
  constexpr int segments = 12;
  HeldLine<T, Smooth> h(0.15, true, -0.9, units);
  double const shift = share * (h.top - h.bottom) / segments;
  h.bottom += shift;
  h.top += shift;
  h.add_thread(segments, 0.01, 1000);
  h.tissue.damping = T(0.05 / units.time());
  auto const v = mpmpbd::cast<T>(units.speed() * mpmpbd::vec(0.02, 0.0, 0.0));
  for (std::size_t k = 0; k < h.rig.bead.size(); ++k) {
    h.rig.known[k] = 1;
    h.rig.bead_velocity[k] = v;
  }
  double sum = 0;
  for (int n = 0; n < 100; ++n) {
    auto const keep = [&] {  // the tissue's damping is not the thread's
      for (auto& u : h.rig.bead_velocity) u = v;
    };
    REQUIRE(h.step(keep) == 0u);
    for (auto& x : h.rig.bead) x += h.rig.dt * v;
    if (n < 67) continue;
    for (auto const& p : h.rig.points)
      sum += double(p.impulse[0]) / (double(h.rig.dt) * units.force());
  }
  return sum / 33;
}

}  // namespace

TEMPLATE_TEST_CASE("a thread pushes the same wherever its beads are", "[stability][B28]", double,
                   float) {
  double least = 1e300, most = 0;
  for (int i = 0; i < 6; ++i) {
    double const f = force<TestType>(millimetres, i / 6.0);
    least = std::min(least, f), most = std::max(most, f);
  }
  CAPTURE(least, most, most / least - 1);
  CHECK(least > 0);
  CHECK(most - least < 0.05 * least);
  double const large = force<TestType>(metres, 0);
  CHECK(std::abs(force<TestType>(millimetres, 0) / large - 1) <
        (sizeof(TestType) == 8 ? 1e-9 : 1e-3));
}
