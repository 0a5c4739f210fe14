// B18: tissue crushed to a tenth of its height between plates, with 64 particles per cell, and let go.
// seconds: 10
#include <mpmpbd/effects/pinned_region.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>
#include <mpmpbd/testing/transfer_laws.hpp>

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
    double const now = push(h, speed);
    // Half of a push belongs to the velocity before it: Block::step.
    double const more = block.step(h) - (start + work + 0.5 * now);
    gained = max(gained, more);
    work += now;
    plate -= speed * h / block.c.cell;
    return h;
  }
  double start = 0, work = 0;  // energy at rest, and of the plate since [J]
  double gained = -1e300;      // the most that there was beyond these [J]

 private:
  // Work of the plate in a substep [J]: it gives nodes of mass m and velocity v, after the forces of the tissue, its own
  // velocity V, by a push of m (V - v) along a way of V h. The grid of the substep is made here once more.
  double push(double h, double speed) const {
    using Body = Mpm<Material>;
    testing::DenseGrid<double> grid(block.run.lattice());
    for (std::int64_t p = 0; p < block.size(); ++p) {
      typename testing::TransferProbe<Body, double>::Item item{};
      auto const take = [&]<class F>(F f) { item[f] = block.template get<F>(p); };
      take(particle::Position{}), take(particle::Velocity{}), take(particle::Affine{});
      take(particle::Deformation{}), take(particle::Mass{}), take(particle::Volume{});
      item[particle::Stress{}] =
          Material::kirchhoff(item, block.run.state().template parameters<Material>(0));
      Scatter<Body>::run(item, grid.writer(), grid.lattice, h);
    }
    grid.divide();
    double sum = 0;
    grid.for_each_node([&](Vec3<double> const& at, std::size_t n) {
      if (at[2] >= (3 + max(plate, 0.5)) * block.c.cell)  // the table has its nodes to itself
        sum += grid.sums[n][3] * (speed + grid.sums[n][2]) * speed;
    });
    return sum;
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
  // Under the load: nothing beyond the work of the plate, and most of that.
  CAPTURE(press.gained / crushed.energy(), crushed.energy() / press.work);
  CHECK(press.gained <= 1e-3 * crushed.energy());
  CHECK(crushed.energy() > 0.9 * press.work);

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
