// B29: a needle that moves by several cells in a step does not pass through tissue unnoticed. Substeps follow
// its speed: at most half a cell each. Where their number is fixed, a status bit says that it is too small.
// seconds: 25
// on a device
#include "catch.hpp"

#include "physics/needle_in_gel.hpp"

using namespace test;

namespace {

enum class Way { lengthwise, sideways };

struct Pass {
  Way way = Way::lengthwise;
  double speed = 0.2;      // of shear waves
  double per_step = 0.05;  // [cells]
  int substeps = 0;        // 0: chosen
};
struct Passed {
  double work = 0;  // of the needle, in those of friction over a cell of depth and way
  std::uint32_t status = 0;
};

// Twelve cells down through a slab of four that is held at its sides.
Passed pass(Pass const& c) {
  GelBlock slab{.low = {3, 3, 8}, .high = {13, 13, 12}, .substeps = c.substeps};
  for (int a = 0; a < 2; ++a) slab.held_high[a] = slab.high[a];
  slab.held_low[2] = -100;
  slab.held_high[2] = 100;
  bool const lengthwise = c.way == Way::lengthwise;
  double const friction = 0.05, pressure = 4e3, wire = 3e-4;
  auto const needle = straight_needle((lengthwise ? 22 : 4.3) * gel_cell, wire);
  auto run = gel_scene<NeedleInGel<Friction>, double>(slab, needle);
  run.set<Friction>({friction, pressure});
  auto const x = vec(1.0, 0.0, 0.0), y = vec(0.0, 1.0, 0.0), down = vec(0.0, 0.0, -1.0);
  place_needle(run, 0,
               lengthwise ? straight_pose(needle, gel_cell * vec(8.13, 7.9, 14.0), down, x)
                          : straight_pose(needle, gel_cell * vec(10.1, 8.13, 14.0), x, y));
  double const v = c.speed * gel_shear_speed(), h = c.per_step * gel_cell / v;
  Passed p;
  for (auto n = std::lround(12 / c.per_step); n > 0; --n) {
    drive_needle(run, 0, v * down, {});
    run.step(h);
    p.work += run.state().get<needle::Force>(0, 0)[2] * v * h;
  }
  p.work /= friction * pressure * 2 * pi<double> * wire * gel_cell * gel_cell;
  p.status = run.status(0);
  return p;
}

}  // namespace

TEST_CASE("a needle does the same work in long steps as in short ones",
          "[coupling][embedded][fast]") {
  for (Way way : {Way::lengthwise, Way::sideways}) {
    double const reference = pass({.way = way}).work;
    REQUIRE(reference > 0);
    for (double cells : {0.2, 1.0, 3.0, 12.0}) {
      auto const p = pass({.way = way, .per_step = cells});
      CAPTURE(int(way), cells, p.work, reference, p.work / reference);
      CHECK(std::abs(p.work / reference - 1) < 0.2);
      CHECK(p.status == 0);
    }
  }
}

// Twelve times as fast as shear waves: in a stable step of the gel at rest it goes three cells. Friction does
// not depend on speed, so the work is known. Without substeps of its own it was 14 % and more below, and a
// needle that moved sideways tore the gel.
TEST_CASE("a needle faster than any wave does not skip tissue", "[coupling][embedded][fast]") {
  double const slow = pass({}).work;
  for (double cells : {0.2, 1.0, 3.0, 12.0}) {
    auto const p = pass({.speed = 12, .per_step = cells}),
               q = pass({.way = Way::sideways, .speed = 12, .per_step = cells});
    CAPTURE(cells, p.work, q.work, slow, p.work / slow);
    // Its points are a cell apart and it moves half a cell in a substep, so these see two phases of the points in
    // the slab only: half a point of 4.7 more or less on average.
    CHECK(std::abs(p.work / slow - 1) < 0.5 / 4.7);
    CHECK(q.work > 100 * slow);
    CHECK(p.status == 0);
    CHECK(q.status == 0);
  }
}

TEST_CASE("too few substeps for a fast needle set a status bit", "[coupling][embedded][fast]") {
  for (Way way : {Way::lengthwise, Way::sideways}) {
    auto const p = pass({.way = way, .speed = 100, .per_step = 12, .substeps = 1});
    CAPTURE(int(way), p.work, p.status);
    CHECK(has(p.status, Fault::time_step));
  }
}
