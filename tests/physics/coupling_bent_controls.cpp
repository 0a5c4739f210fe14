// The obvious ways to hold a taut bent thread, which fail, and the pull round the bend.
// seconds: 90
#include "physics/bent_thread_checks.hpp"

using namespace test;

TEST_CASE("contact first and XPBD after it cuts through the tissue", "[coupling][T90][control]") {
  for (double mass : {1.0, 100.0}) {
    BentCase const c{
        .tension = 4, .bead_mass = mass, .end = 200, .scheme = Scheme::contact_then_xpbd};
    BentResult const r = BentThread<double, Slippery>(c).run();
    CAPTURE(mass, r.ran_away, r.slip_end);
    CHECK((r.ran_away || r.slip_end > 0.2));
  }
}

TEST_CASE("without a warm start a loaded thread creeps", "[coupling][T90][control]") {
  BentCase const c{.tension = 4, .bead_mass = 1e-4, .end = 600, .scheme = Scheme::cold_start};
  BentResult const r = BentThread<double, Slippery>(c).run();
  CAPTURE(r.slip_early, r.slip_end);
  CHECK(r.slip_end - r.slip_early > 0.005);
}

TEST_CASE("a thread runs freely round a bend", "[coupling][capstan]") {
  BentCase c{.tension = 1, .bead_mass = 1e-2, .end = 380, .pull = 0.01};
  BentResult const r = BentThread<double, Slippery>(c).run();
  CAPTURE(r.pulled, r.held);
  CHECK_FALSE(r.ran_away);
  CHECK(std::abs(r.pulled / r.held - 1) < 0.01);
  CHECK(std::abs(r.held - 1) < 0.01);

  c.scheme = Scheme::chord_tangents;  // control: chords as tangents lock it
  BentResult const locked = BentThread<double, Slippery>(c).run();
  CAPTURE(locked.pulled, locked.held);
  CHECK(locked.pulled / locked.held > 1.5);
}
