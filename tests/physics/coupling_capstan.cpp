// A4.5 and, in tissue, A3.16: a thread pulled round a bend of 90 degrees: free without friction, a capstan with it,
// and with drag besides. See bent_thread.hpp.
// seconds: 15
// on a device
#include "physics/bent_thread_checks.hpp"

using namespace test;

namespace {

// T1/T2 while the thread runs, averaged over the last 0.84 cells of 1.8, which is one of 16 segments: the first 0.4
// turn the friction round from holding to resisting, after 2 cells the loose end would enter the tissue.
BentCase pulled(double friction, double speed = 0.01) {
  return {.bead_mass = 1e-2, .friction = friction, .end = 100 + 1.8 / speed, .pull = speed};
}

// The angle of wrap: pi/2 for a rigid track, a little more where soft tissue gives way at the bend.
double exponent(BentResult const& r, double friction) {
  return std::log(r.pulled / r.held) / friction;
}
// T1/T2 of a rigid bend.
double capstan(double friction) { return std::exp(friction * mpmpbd::pi<double> / 2); }

}  // namespace

TEST_CASE("a thread runs freely round a bend", "[coupling][capstan]") {
  for (double tension : {1.0, 4.0}) {
    BentCase c = pulled(0);
    c.tension = tension;
    BentResult const r = run_bent<double>(c);
    CAPTURE(tension, r.pulled, r.held);
    CHECK_FALSE(r.ran_away);
    CHECK(std::abs(r.pulled / r.held - 1) < 0.01);
    CHECK(std::abs(r.held / tension - 1) < 0.01);
  }
}

// Segments of half a cell, 12 in an angle of pi. The 16 that the page asks for are 0.39 cells here. The tissue
// hardly tells such neighbours apart: on the straights their lateral loads alternate in sign, friction adds up
// the sizes, and at mu = 0.3 and 0.4 it is 2.2 % and 4.0 % too large.
TEST_CASE("A3.16: friction round a bend grows as a capstan's", "[coupling][capstan]") {
  auto const check = [](double friction, int segments) {
    BentCase c = pulled(friction);
    c.segments = segments;
    BentResult const r = run_bent<double>(c);
    CAPTURE(friction, segments, r.pulled, r.held, exponent(r, friction));
    CHECK_FALSE(r.ran_away);
    CHECK(r.pulled / r.held == Approx(capstan(friction)).epsilon(0.02));
  };
  for (double friction : {0.1, 0.2, 0.3, 0.4}) check(friction, 26);
  for (double friction : {0.1, 0.2}) check(friction, 34);
}

// Coulomb's friction knows no speed. A cap taken from the lateral load of the stick trial, which a moving
// thread never has, gave 1.7 and 2.1 here.
TEST_CASE("friction round a bend does not depend on speed", "[coupling][capstan]") {
  double const slow = exponent(run_bent<double>(pulled(0.2, 0.004)), 0.2);
  double const fast = exponent(run_bent<double>(pulled(0.2, 0.02)), 0.2);
  CAPTURE(slow, fast);
  CHECK(std::abs(fast / slow - 1) < 0.03);
}

// With drag c v per length, dT/ds = c v on the straights and dT/dphi = mu T + c v R in the bend. What drag adds
// to the tension of the same thread without drag is compared: a fifth and three fifths of it.
TEST_CASE("A4.5: drag adds to friction round a bend", "[coupling][capstan][drag]") {
  using Dragged =
      mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::Friction, mpmpbd::Drag, false>;
  double const mu = 0.2, speed = 0.01, embedded = 3;  // cells of each straight in the tissue
  BentResult const bare = run_bent<double>(pulled(mu, speed));
  double const grown = bare.pulled / bare.held, R = bend_radius;
  for (double per_length : {0.1, 0.3}) {  // of a tension of 4
    BentCase c = pulled(mu, speed);
    c.drag = per_length / speed;
    BentResult const r = BentThread<double, Dragged>(c).run();
    double const added = per_length * ((embedded + R / mu) * grown - R / mu + embedded);
    CAPTURE(per_length, grown, r.held, r.pulled, added);
    CHECK_FALSE(r.ran_away);
    CHECK(r.pulled - r.held * grown == Approx(added).epsilon(0.03));
  }
}
