// Recomputes the references of T90 and of the bending test.
#include "physics/bent_rest.hpp"
#include "physics/bent_thread_checks.hpp"

using namespace test;

// The dead load itself is unstable with dt 0.2.
TEST_CASE("dead load of a line under tension", "[coupling][T90]") {
  for (BentReference const& reference : bent_references) {
    BentCase const c{
        .tension = reference.tension, .dt = 0.05, .end = 400, .scheme = Scheme::dead_load};
    BentResult const r = run_bent<double>(c);
    CAPTURE(reference.tension, r.tissue);
    CHECK(std::abs(r.tissue / reference.dead_load - 1) < 0.002);
  }
}

TEST_CASE("a quarter of the time step", "[coupling][T90]") {
  for (BentReference const& reference : bent_references) {
    BentResult const r = run_bent<double>({.tension = reference.tension, .dt = 0.025, .end = 400});
    CAPTURE(reference.tension, r.tissue);
    CHECK(std::abs(r.tissue / reference.quarter_step - 1) < 0.002);
  }
}

TEST_CASE("dead load of a bent line", "[coupling][bending]") {
  double const r =
      BentRest<double>({.stiffness = 16, .dt = 0.02, .how = Bend::dead_load}).run().straightened;
  CAPTURE(r);
  CHECK(std::abs(r / dead_load_straightens - 1) < 0.01);
}
