// B18: tissue crushed to a tenth of its height between plates, with 64 particles per cell, and let go.
// seconds: 10
#include <mpmpbd/effects/pinned_region.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>

#include "catch.hpp"
#include "stability/block.hpp"

using namespace test;

namespace {

using Table_ = Wall<Sticky, 2, Side::low>;
template <class Material> struct Pressed : Scene<Mpm<Material>, DrivenRegion, Table_> {};

// A column of 2 x 2 x 12 cells on a table, and a plate above it.
template <class Material> struct Press {
  Block<Pressed<Material>> block;
  double plate;  // height of its lower face above the table [cells]

  Press()
      : block({.low = vec(11.0, 11.0, 3.0),
               .cells = {{2, 2, 12}},
               .nodes = {{25, 25, 19}},
               .per_axis = 4},
              lame(1e4, 0.3)),
        plate(12) {
    block.run.template set<Table_>({3 * block.c.cell});
    drive(0);
  }
  double wave() const { return mpmpbd::sqrt(1e4 / block.c.density); }
  void drive(double velocity) {
    double const far = 100 * block.c.cell;
    block.run.template set<DrivenRegion>(
        {{-far, -far, (3 + plate) * block.c.cell}, {far, far, far}, {0, 0, velocity}});
  }
  // Of the tissue [cells]. The plate holds nodes, so almost a cell of it sticks out above.
  double height() const {
    double low = 1e300, high = -1e300;
    for (std::int64_t p = 0; p < block.size(); ++p) {
      double const z = block.template get<particle::Position>(p)[2] / block.c.cell;
      low = min(low, z), high = max(high, z);
    }
    return high - low + 1.0 / block.c.per_axis;
  }
  // A substep of the plate's way down at a tenth of the wave speed; its length [s].
  double press() {
    double const h = block.run.suggest_dt(0), speed = 0.1 * wave();
    drive(-speed);
    block.run.step(h);
    plate -= speed * h / block.c.cell;
    return h;
  }
};

template <class Material> void check_crush() {
  Press<Material> press;
  auto& block = press.block;
  double const at_rest = block.run.suggest_dt(0);
  double shortest = at_rest;
  while (press.height() > 0.1 * 12) {
    shortest = min(shortest, press.press());
    REQUIRE(block.run.status(0) == 0);
  }
  auto const crushed = block.sums();
  CAPTURE(shortest / at_rest, crushed.least_volume, press.height());
  CHECK(crushed.finite);
  CHECK(crushed.inside);
  CHECK(crushed.least_volume > 0);
  CHECK(shortest < 0.95 * at_rest);

  press.plate = 50;  // taken away
  press.drive(0);
  double most = 0;
  for (int s = 0; s < 1000; ++s) most = max(most, block.step(block.run.suggest_dt(0)));
  auto const end = block.sums();
  CAPTURE(most / crushed.energy(), end.energy() / crushed.energy(), end.least_volume,
          block.run.status(0));
  CHECK(end.finite);
  CHECK(end.inside);
  CHECK(most <= (1 + 1e-3) * crushed.energy());
  CHECK(end.least_volume > 0);
}

}  // namespace

TEST_CASE("neo-Hookean tissue survives being crushed to a tenth", "[stability][B18]") {
  check_crush<NeoHookean>();
}
TEST_CASE("stable neo-Hookean tissue survives being crushed to a tenth", "[stability][B18]") {
  check_crush<StableNeoHookean>();
}
TEST_CASE("fixed corotated tissue survives being crushed to a tenth", "[stability][B18]") {
  check_crush<FixedCorotated>();
}
