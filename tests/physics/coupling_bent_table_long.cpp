// The full table of T90, one line per row as it is done: docs/results/bent_thread.md.
#include <cstdio>
#include <string>

#include "physics/bent_thread_checks.hpp"

using namespace test;

namespace {

std::string unmet(std::vector<Demand> const& demands) {
  std::string names;
  for (auto const& d : demands)
    if (!d.met()) names += (names.empty() ? "" : ", ") + std::string(d.what);
  return names.empty() ? "-" : names;
}

template <class T> void row(BentCase const& c) {
  BentResult const r = run_bent<T>(c);
  auto const demands = bent_demands<T>(c, r);
  std::printf(
      "| %s | %g | %g | %g | %g | %.4f | %+.4f | %.4f | %.4f | %+.1f %% | %.5f | %.5f | %.2f %% | %s |\n",
      sizeof(T) == 4 ? "float" : "double", c.dt, c.tension, c.bead_mass, c.friction, r.slip_end,
      r.slip_end - r.slip_early, std::abs(r.slide_end - r.slide_early), r.tissue,
      100 * (r.tissue / bent_reference(c.tension).dead_load - 1), r.stretch, r.mean_stretch,
      100 * r.energy_rise, unmet(demands).c_str());
  std::fflush(stdout);
  CAPTURE(c.dt, c.tension, c.bead_mass, c.friction);
  CHECK(unmet(demands) == "-");
}

template <class T> void rows(double dt) {
  for (double tension : {1.0, 4.0, 8.0})
    for (double friction : {0.0, 0.2})
      for (double mass : {1e-4, 1e-2, 1.0, 100.0})
        row<T>({.tension = tension, .bead_mass = mass, .dt = dt, .friction = friction});
}

}  // namespace

TEMPLATE_TEST_CASE("a taut bent thread stays where it is at dt 0.2", "[coupling][T90]", double,
                   float) {
  rows<TestType>(0.2);
}
TEMPLATE_TEST_CASE("a taut bent thread stays where it is at dt 0.1", "[coupling][T90]", double,
                   float) {
  rows<TestType>(0.1);
}
TEMPLATE_TEST_CASE("a taut bent thread stays where it is at dt 0.05", "[coupling][T90]", double,
                   float) {
  rows<TestType>(0.05);
}
