// A bent thread straightens soft tissue as its EI says, whatever it weighs. See bent_rest.hpp and
// docs/decisions/0003.
// seconds: 60
// on a device
#include "catch.hpp"

#include "physics/bent_rest.hpp"

using namespace test;

TEMPLATE_TEST_CASE("bending reaches the tissue whole", "[coupling][bending]", double, float) {
  // In float a thread may not be too light for its stiffness: dt^2 EI / (l^3 m) < 1e3.
  for (double mass : {sizeof(TestType) == 4 ? 1e-2 : 1e-4, 0.05, 1.0}) {
    BendResult const r = BentRest<TestType>({.stiffness = 16, .bead_mass = mass}).run();
    CAPTURE(mass, r.straightened, r.slip);
    CHECK_FALSE(r.ran_away);
    CHECK(std::abs(r.straightened / dead_load_straightens - 1) < 0.1);
    CHECK(r.slip < 0.02);
  }
}

namespace {

// Loss of sag by the thread, over that by its forces alone.
double share_of_dead_load(BendCase c) {
  c.bead_mass = 1e-2;
  c.rest = Rest::wave;
  double const thread = BentRest<double>(c).run().straightened;
  c.how = Bend::dead_load;
  c.dt = 0.05;
  return thread / BentRest<double>(c).run().straightened;
}

}  // namespace

TEST_CASE("a wave straightens the tissue as its EI says", "[coupling][bending]") {
  for (double stiffness : {0.25, 1.0, 4.0, 16.0}) {
    double const share = share_of_dead_load({.stiffness = stiffness, .segments = 14});
    CAPTURE(stiffness, share);
    CHECK(std::abs(share - 1) < 0.03);
  }
}

// With a joint or a segment at the crest, and with segments of half a cell.
TEST_CASE("it does so in small substeps and for any segments", "[coupling][bending]") {
  for (int segments : {13, 14, 27}) {
    double const share = share_of_dead_load({.stiffness = 1, .dt = 0.03, .segments = segments});
    CAPTURE(segments, share);
    CHECK(std::abs(share - 1) < 0.03);
  }
}

TEST_CASE("two points per segment keep a part of the bending", "[coupling][bending][control]") {
  double const share =
      share_of_dead_load({.stiffness = 1, .dt = 0.03, .segments = 13, .how = Bend::two_points});
  CAPTURE(share);
  CHECK(share < 0.8);
}

TEST_CASE("heavy beads bent by explicit forces say the same", "[coupling][bending]") {
  double const in_solve = BentRest<double>({.stiffness = 4, .bead_mass = 1}).run().straightened;
  double const explicit_force =
      BentRest<double>({.stiffness = 4, .bead_mass = 1, .how = Bend::explicit_before})
          .run()
          .straightened;
  CAPTURE(in_solve, explicit_force);
  CHECK(std::abs(in_solve / explicit_force - 1) < 0.02);
}

TEST_CASE("bending solved before the coupling is lost in a light thread",
          "[coupling][bending][control]") {
  double const r = BentRest<double>({.stiffness = 16, .bead_mass = 1e-4, .how = Bend::before_solve})
                       .run()
                       .straightened;
  CAPTURE(r);
  CHECK(r < 0.05 * dead_load_straightens);
}
