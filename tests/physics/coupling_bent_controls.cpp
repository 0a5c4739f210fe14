// The obvious ways to hold a taut bent thread, or to draw it round its bend, which fail.
// seconds: 90
// on a device
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

TEST_CASE("chords as tangents lock a thread in its bend", "[coupling][capstan][control]") {
  BentCase const c{
      .tension = 1, .bead_mass = 1e-2, .end = 280, .scheme = Scheme::chord_tangents, .pull = 0.01};
  BentResult const r = BentThread<double, Slippery>(c).run();
  CAPTURE(r.pulled, r.held);
  CHECK(r.pulled / r.held > 1.5);
}

TEST_CASE("position bias pumps up the impulses of a warm start",
          "[coupling][T90][capstan][control]") {
  BentCase held{.tension = 4, .end = 200, .scheme = Scheme::position_bias};
  for (double mass : {1e-4, 1.0}) {
    held.bead_mass = mass;
    BentResult const r = run_bent<double>(held);
    CAPTURE(mass, r.energy_rise);
    CHECK(r.energy_rise > 0.005);
  }
  BentResult const r = run_bent<double>({.bead_mass = 1e-2,
                                         .friction = 0.2,
                                         .end = 280,
                                         .scheme = Scheme::position_bias,
                                         .pull = 0.01});
  CAPTURE(r.pulled, r.held);  // 5.5 is right
  CHECK(std::log(r.pulled / r.held) / 0.2 > 1.8);
}
