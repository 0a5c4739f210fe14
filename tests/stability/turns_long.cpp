// B31: an arc beyond half a circle turns fifty times about its centre.
// seconds: 60
#include "catch.hpp"
#include "physics/arc_in_gel.hpp"

using namespace test;

// The gel must not store the work of the turns. In fifty its energy grew by 13 %, 1.5e-4 of the work of one.
TEST_CASE("an arc of 240 degrees turns fifty times with the same force", "[stability][B31][long]") {
  ArcInGel arc({.radius = 2, .angle = 4.2, .speed = 0.5});
  double const around = 2 * pi<double> * 2;
  arc.turn(2 * around);
  double const start = gel_energy(arc.run, 0);
  double least = 1e300, most = 0, energy = 0, moment = 0;
  for (int turn = 2; turn < 50; ++turn)
    for (int quarter = 0; quarter < 4; ++quarter) {
      arc.turn(around / 4);
      auto const f = arc.forces();
      least = std::min(least, f.moment);
      most = std::max(most, f.moment);
      moment = std::max(moment, std::abs(arc.run.state().get<needle::Moment>(0, 0)[2]));
      energy = std::max(energy, gel_energy(arc.run, 0));
    }
  double const work = 2 * pi<double> * moment;  // of a turn
  CAPTURE(least, most, start, energy, work, (energy - start) / work);
  CHECK(most - least < 0.05 * least);
  CHECK(energy - start < 1e-3 * work);
  CHECK(energy < 1.25 * start);
  CHECK(arc.run.status(0) == 0);
}
