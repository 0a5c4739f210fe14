// The code that docs/concepts/needle.md shows.
#include "catch.hpp"
#include "shown.hpp"

#include <mpmpbd/needle/arc_needle.hpp>
#include <mpmpbd/needle/kinematic.hpp>
#include <mpmpbd/needle/points.hpp>
#include <mpmpbd/needle/suture_path.hpp>

using namespace mpmpbd;

TEST_CASE("the example of the page on needles", "[needle][example]") {
  // Markers 12 mm apart, needle of 6.4 mm: drive for 6 s, then turn out and pull for 4 s.
  Arc<double> const arc{0.0064, 3.14159, 0.0004, 0.002};
  auto const path = SuturePath::between(vec(0.020, 0.016, 0.024), vec(0.032, 0.016, 0.024),
                                        vec(0.0, 0.0, 1.0), arc.radius);
  SutureMotion motion;
  motion.pull = vec(0.001, 0.0, 0.004);
  Script const script = suture_script(path, arc, motion);

  Table<float, Needles, needle::State> needles(1, 1);  // environments, needles in each
  auto const view = needles.view();
  kinematic::reset(view, 0, script);
  double const dt = 1e-4;
  for (int i = 0; i < 1000; ++i) {
    double const t0 = i * dt, t1 = (i + 1) * dt;
    kinematic::begin_scripted(view, 0, script, t0, t1);
    // ... contact reads needle::pose(view, 0) and needle::twist(view, 0) ...
    kinematic::finish_scripted(view, 0, script, t1);
  }

  REQUIRE(path.angle == Approx(2.431).epsilon(1e-3));
  REQUIRE(needle::pose(view, 0).position == cast<float>(path.centre));
}

TEST_CASE("the page shows this code", "[needle][example]") {
  CHECK(blocks_not_in(__FILE__, "concepts/needle.md") == std::vector<std::string>{});
}
