// B39: tissue at rest on a floor, undamped, shakes in float no more than one rounding makes it.
// seconds: 2
// on a device
#include <cmath>

#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>

#include "catch.hpp"
#include "physics/back_end.hpp"
#include "stability/block.hpp"

using namespace test;

namespace {

constexpr double h = 1.25e-4;  // [s]

struct AtRest : Scene<Mpm<NeoHookean>, Gravity, Damping, Wall<Sticky, 2, Side::low>> {};
using Cube = Block<AtRest, float, BackEnd>;

// Four cells high; the floor holds half a cell of it.
Cube cube() {
  BlockCase const c{.low = vec(3.0, 3.0, 2.0), .cells = {{4, 4, 4}}, .nodes = {{11, 11, 11}}};
  Cube block(c, lame(2e4, 0.4));
  block.run.set<Gravity>({{0.0, 0.0, -9.81}});
  block.run.set<Wall<Sticky, 2, Side::low>>({2.5 * c.cell});
  return block;
}

// Root of the mean square of a component of velocity [cells per substep].
double shaking(Cube const& block) {
  double sum = 0.0;
  for (std::int64_t p = 0; p < block.size(); ++p) {
    auto const v = block.get<particle::Velocity>(p);
    sum += dot(v, v);
  }
  return std::sqrt(sum / (3.0 * static_cast<double>(block.size()))) * h / block.c.cell;
}

}  // namespace

// A substep rounds by up to half a count of sums (one standard deviation) and half a rounding of numbers near 1. Did that add
// up, the speed would be 27 times the bound after 3000 substeps; transfers smooth it, and the floor takes momentum.
TEST_CASE("Tissue at rest shakes by a rounding and no more as time goes on",
          "[mpm][stability][B39]") {
  auto block = cube();
  block.run.set<Damping>({300.0});
  for (int s = 0; s < 3000; ++s) block.run.step(h);
  block.run.set<Damping>({0.0});
  double const rounding = quantum<float> + double(epsilon<float>);
  double most = 0.0;
  for (int s = 0; s < 3000; ++s) {
    block.run.step(h);
    if (s % 50 == 49) most = std::fmax(most, shaking(block));
  }
  CAPTURE(rounding, most / rounding);
  CHECK(block.run.status(0) == 0);
  CHECK(most < rounding);
  CHECK(most > 0.0);  // it is not held
  auto const last = block.size() - 1;
  CHECK(block.get<particle::Position>(last)[2] < block.c.positions().back()[2]);  // and has sunk
}
