// B39: tissue at rest on a floor, undamped, shakes in float no more than one rounding makes it.
// seconds: 2
// on a device
#include <cmath>
#include <vector>

#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include "catch.hpp"
#include "physics/back_end.hpp"

using namespace mpmpbd;

namespace {

constexpr double dx = 3.7e-3, h = 1.25e-4, density = 1050.0;
constexpr int edge = 8, particles = edge * edge * edge;

struct AtRest : Scene<Mpm<NeoHookean>, Gravity, Damping, Walls<Sticky>> {};
using Run = Simulation<AtRest, test::BackEnd, float>;

// A cube of four cells that the floor holds half a cell deep.
Run cube() {
  Run run({.environments = 1,
           .cell_size = dx,
           .nodes = {11, 11, 11},
           .capacity = {{"particle", particles}},
           .substeps = 1});
  run.set<NeoHookean>(lame(2e4, 0.4));
  run.set<Gravity>({{0.0, 0.0, -9.81}});
  run.set<Walls<Sticky>>({{-1.0, -1.0, 2.5 * dx}, {1.0, 1.0, 1.0}});
  std::vector<Vec3<double>> at;
  for (int k = 0; k < edge; ++k)
    for (int j = 0; j < edge; ++j)
      for (int i = 0; i < edge; ++i)
        at.push_back(dx * vec(3.25 + 0.5 * i, 3.25 + 0.5 * j, 2.25 + 0.5 * k));
  run.add_particles(0, at, density, dx * dx * dx / 8);
  return run;
}

// Root of the mean square of a component of velocity [cells per substep].
double shaking(Run const& run) {
  double sum = 0.0;
  for (std::int64_t p = 0; p < particles; ++p) {
    auto const v = cast<double>(run.state().get<particle::Velocity>(0, p));
    sum += dot(v, v);
  }
  return std::sqrt(sum / (3 * particles)) * h / dx;
}

}  // namespace

// A substep rounds by up to half a count of sums (one standard deviation) and half a rounding of numbers near 1. Did that add
// up, the speed would be 27 times the bound after 3000 substeps; transfers smooth it, and the floor takes momentum.
TEST_CASE("Tissue at rest shakes by a rounding and no more as time goes on",
          "[mpm][stability][B39]") {
  auto run = cube();
  run.set<Damping>({300.0});
  for (int s = 0; s < 3000; ++s) run.step(h);
  run.set<Damping>({0.0});
  double const rounding = test::quantum<float> + double(epsilon<float>);
  double most = 0.0;
  for (int s = 0; s < 3000; ++s) {
    run.step(h);
    if (s % 50 == 49) most = std::fmax(most, shaking(run));
  }
  CAPTURE(rounding, most / rounding);
  CHECK(run.status(0) == 0);
  CHECK(most < rounding);
  CHECK(most > 0.0);  // it is not held
  auto const top = run.state().get<particle::Position>(0, particles - 1);
  CHECK(top[2] < (2.25 + 0.5 * (edge - 1)) * dx);  // and has sunk
}
