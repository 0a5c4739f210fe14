// Recomputes the references of T90 and of the bending test.
#include "physics/bent_rest.hpp"
#include "physics/bent_thread_checks.hpp"

using namespace test;

TEST_CASE("dead load of a line under tension", "[coupling][T90]") {
  BentCase const c{.tension = 4, .dt = 0.05, .end = 400, .scheme = Scheme::dead_load};
  BentResult const r = BentThread<double, Slippery>(c).run();
  CAPTURE(r.tissue);
  CHECK(std::abs(r.tissue / dead_load_displacement - 1) < 0.01);
}

TEST_CASE("a quarter of the time step", "[coupling][T90]") {
  BentCase const c{.tension = 4, .dt = 0.025, .end = 400};
  BentResult const r = BentThread<double, Slippery>(c).run();
  CAPTURE(r.tissue);
  CHECK(std::abs(r.tissue / quarter_step_displacement - 1) < 0.01);
}

TEST_CASE("dead load of a bent line", "[coupling][bending]") {
  double const r =
      BentRest<double>({.stiffness = 16, .dt = 0.02, .how = Bend::dead_load}).run().straightened;
  CAPTURE(r);
  CHECK(std::abs(r / dead_load_straightens - 1) < 0.01);
}

TEST_CASE("friction round the bend grows as a capstan's", "[coupling][capstan]") {
  for (double mu : {0.1, 0.2, 0.4}) {
    BentCase const c{.tension = 4, .bead_mass = 1e-2, .friction = mu, .end = 380, .pull = 0.002};
    BentResult const r = BentThread<double, Rough>(c).run();
    double const exponent = std::log(r.pulled / r.held) / mu;
    CAPTURE(mu, r.pulled, r.held, exponent);
    CHECK(exponent > 1.5);
    CHECK(exponent < 1.8);
  }
}
