// B28: a suture of 0.2 mm in segments of half a millimetre. What it pushes with does not depend on where its
// beads are, nor on the metre.
// seconds: 5
#include "catch.hpp"
#include "physics/held_line.hpp"

namespace {

using namespace test;
using Smooth =
    mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;

// Cells of 0.77 mm; a modulus of 3.6 kPa, or scales of metres for comparison.
Units const millimetres{7.6923e-4, 1050.0, 3.6e3}, metres{0.76923, 1.05, 3.6};

// A thread of 0.65 cells a segment that has moved sideways by 0.3 cells through the block, or through a strip of it.
struct Pushed {
  double share = 0;  // of a segment, by which the thread is shifted along itself
  double bend = 0;  // per cell of its length, towards where it moves [rad]; the shift then turns it
  int before = 7, after = 7;  // segments on either side of the middle
  double strip = 6;           // width [cells]
};
constexpr double segment = 0.65;

Vec3<double> place(Pushed const& c, double s) {  // in cells, at an arc length from the middle
  double const a = c.bend * s, x = 6.2, y = 5.7, z = 6;
  if (c.bend == 0) return mpmpbd::vec(x, y, z + s);
  return mpmpbd::vec(x - (1 - std::cos(a)) / c.bend, y, z + std::sin(a) / c.bend);
}

// Its lateral force, the mean over the last third of the way.
template <class T> double force(Units const& units, Pushed const& c) {
  HeldLine<T, Smooth> h(0.15, true, 0, units);
  std::erase_if(h.tissue.particles, [&](auto const& p) {
    return std::abs(double(p.x[2]) / units.length - 6) > c.strip / 2;
  });
  for (int k = -c.before; k <= c.after; ++k)
    h.rig.add_bead(mpmpbd::cast<T>(units.length * place(c, (k + c.share) * segment)),
                   T(0.01 * units.mass()));
  h.rig.stretch_compliance = T(1 / (1000 * units.force()));
  h.rig.allocate();
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
    double const f = force<TestType>(millimetres, {.share = i / 6.0});
    least = std::min(least, f), most = std::max(most, f);
  }
  CAPTURE(least, most, most / least - 1);
  CHECK(least > 0);
  CHECK(most - least < 0.05 * least);
  double const large = force<TestType>(metres, {});
  CHECK(std::abs(force<TestType>(millimetres, {}) / large - 1) <
        (sizeof(TestType) == 8 ? 1e-9 : 1e-3));
}

// Joints of up to 23 degrees, open or closed towards where the thread moves, pass a strip of two cells. One of a single
// cell is less than what a grid tells apart: it sees 13 % of where the beads are, bent or not.
TEST_CASE("a bent thread pushes the same with its joints and with its segments",
          "[stability][B28]") {
  for (double const radius : {4.0, 2.5, 1.6})
    for (double const side : {1.0, -1.0}) {
      double least = 1e300, most = 0;
      int const reach = std::min(7, static_cast<int>(1.45 * radius / segment));
      for (int i = 0; i < 6; ++i) {
        double const f = force<double>(millimetres, {.share = i / 6.0 - 0.5,
                                                     .bend = side / radius,
                                                     .before = reach,
                                                     .after = reach,
                                                     .strip = 2});
        least = std::min(least, f), most = std::max(most, f);
      }
      CAPTURE(radius, side, least, most, most / least - 1);
      CHECK(least > 0);
      CHECK(most - least < 0.05 * least);
    }
}

// Its end is drawn through the block by two segments, which takes away 1.3 of its 3.65 cells there: the force falls
// all the way, and nowhere by more than 5 % in a twelfth of a segment.
TEST_CASE("a thread that ends in the gel pushes the less the shorter it is", "[stability][B28]") {
  double before = 0, first = 0, steepest = 0, flattest = 1e300;
  for (int i = -12; i <= 12; ++i) {
    double const f = force<double>(millimetres, {.share = i / 12.0, .before = 0, .after = 10});
    if (i == -12) first = f;
    if (i > -12) {
      steepest = std::max(steepest, (before - f) / f);
      flattest = std::min(flattest, (before - f) / f);
    }
    before = f;
  }
  CAPTURE(first, before, steepest, flattest);
  CHECK(flattest > 0);
  CHECK(steepest < 0.05);
  CHECK(before < 0.8 * first);
}
