// B17: tissue that is pulled until its particles lose each other. Quadratic splines: particles less than two
// cells apart always share a node, three cells apart never; in between it depends on where the nodes are. A bar gives
// way earlier, when the particles along it are about a cell apart, and from there on the gap opens by itself.
// seconds: 20
#include <algorithm>

#include <mpmpbd/effects/pinned_region.hpp>
#include <mpmpbd/effects/stretch_limit.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>

#include "catch.hpp"
#include "stability/block.hpp"

using namespace test;

namespace {

Lame<double> const soft = lame(1e4, 0.3);
struct Free : Scene<Mpm<NeoHookean>> {};  // exactly no stress at rest

// Whether a strained particle moves another so many cells away, for any or for all of its places in a cell.
struct Reach {
  bool any = false, all = true;
};
Reach reach(double cells) {
  Reach r;
  for (int i = 0; i < 16; ++i) {
    BlockCase const c;
    auto const x = c.cell * vec(4.03 + i / 16.0, 5.2, 5.3);
    Block<Free> two(c, soft, {x, x + c.cell * vec(cells, 0.0, 0.0)});
    two.set<particle::Deformation>(0, testing::Samples::diagonal(1.5, 1, 1));
    two.run.step(1e-4);
    bool const felt = norm(two.get<particle::Velocity>(1)) > 0;
    r.any = r.any || felt;
    r.all = r.all && felt;
  }
  return r;
}

}  // namespace

TEST_CASE("particles feel each other up to two cells, and not beyond three", "[stability][B17]") {
  for (double const cells : {0.5, 1.0, 1.99}) CHECK(reach(cells).all);
  for (double const cells : {3.0, 3.01, 5.0}) CHECK_FALSE(reach(cells).any);
}

namespace {

template <class... Policies>
struct Pulled
    : Scene<Mpm<StableNeoHookean, Policies...>, StretchLimit, PinnedRegion, DrivenRegion> {};

// A bar of 8 x 2 x 2 cells along x, held at one end and drawn at the other with a share of the speed of sqrt(E / rho).
template <class Scene_> struct Bar {
  int per_axis = 2;
  double share = 0.2;
  Block<Scene_> block{{.low = vec(4.0, 5.13, 5.27),
                       .cells = {{8, 2, 2}},
                       .nodes = {{90, 12, 12}},
                       .per_axis = per_axis},
                      soft};
  double grip = 11;  // from here on the bar is drawn [cells]

  void hold(bool held) {
    block.run.template set<StretchLimit>(StretchLimit::of(block.c.spacing(), block.c.cell));
    double const dx = block.c.cell, far = 1e3 * dx, off = held ? 0 : far;
    block.run.template set<PinnedRegion>({{-far, -far, -far}, {5 * dx - off, far, far}});
    block.run.template set<DrivenRegion>(
        {{grip * dx + off, -far, -far}, {far + off, far, far}, {held ? speed() : 0.0, 0, 0}});
  }
  double speed() const { return share * mpmpbd::sqrt(1e4 / block.c.density); }
  void pull() {
    hold(true);
    double const h = block.run.suggest_dt(0);
    block.run.step(h);
    grip += speed() * h / block.c.cell;
  }
  double stretch() const { return (grip - 5) / 6; }  // of the part that nobody holds
  bool torn() const { return has(block.run.status(0), Fault::fracture); }
  // The widest gap along x, and where it is [cells].
  struct Gap {
    double width = 0, at = 0;
  };
  Gap widest() const {
    std::vector<double> x;
    for (std::int64_t p = 0; p < block.size(); ++p)
      x.push_back(block.template get<particle::Position>(p)[0] / block.c.cell);
    std::sort(x.begin(), x.end());
    Gap gap;
    for (std::size_t i = 1; i < x.size(); ++i)
      if (x[i] - x[i - 1] > gap.width) gap = {x[i] - x[i - 1], (x[i] + x[i - 1]) / 2};
    return gap;
  }
  Vec3<double> momentum_beyond(double x) const {
    Vec3<double> sum{};
    for (std::int64_t p = 0; p < block.size(); ++p)
      if (block.template get<particle::Position>(p)[0] > x * block.c.cell)
        sum += block.template get<particle::Mass>(p) * block.template get<particle::Velocity>(p);
    return sum;
  }
};

}  // namespace

TEST_CASE("a bar that is pulled apart ends in pieces that do not feel each other",
          "[stability][B17]") {
  Bar<Pulled<>> bar;
  while (bar.widest().width < 3 && bar.grip < 70) bar.pull();
  auto const gap = bar.widest();
  auto const torn = bar.block.sums();
  CAPTURE(bar.grip, gap.width, gap.at, torn.strain, bar.block.run.status(0));
  REQUIRE(gap.width >= 3);
  CHECK(torn.finite);
  CHECK(torn.inside);

  bar.hold(false);
  auto const before = bar.momentum_beyond(gap.at);
  double const h = 0.8 * bar.block.run.suggest_dt(0), first = bar.block.step(h);
  double most = first;
  // The pieces spring back from the gap, so it stays.
  for (int s = 0; s < 100; ++s) most = max(most, bar.block.step(h));
  auto const after = bar.momentum_beyond(gap.at);
  CAPTURE(most / first, norm(after - before) / norm(before));
  CHECK(norm(after - before) <= 1e-12 * torn.momentum_size);
  CHECK(most <= (1 + 1e-3) * first);
  CHECK(bar.block.sums().finite);
}

// Told before it has happened, and not before the bar is near it: its mean stretch is then at least 0.75 of a cell.
TEMPLATE_TEST_CASE("numerical fracture is reported while the bar is still whole",
                   "[stability][B17]", (Pulled<QuadraticBSpline, MlsApic>),
                   (Pulled<QuadraticBSpline, Apic, WeightGradient>),
                   (Pulled<QuadraticBSpline, Flip, WeightGradient>),
                   (Pulled<CubicBSpline, MlsApic>)) {
  for (int const per_axis : {1, 2, 3})
    for (double const share : {0.2, 0.02}) {
      Bar<TestType> bar{.per_axis = per_axis, .share = share};
      while (!bar.torn() && bar.widest().width < 3 && bar.grip < 30) bar.pull();
      double const spacing = 1.0 / per_axis, stretch = bar.stretch(), width = bar.widest().width;
      CAPTURE(per_axis, share, stretch, width);
      CHECK(bar.torn());
      CHECK(width < 2);  // so that both sides still feel each other
      CHECK(stretch * spacing > (per_axis == 1 ? 1.0 : 0.75));
      CHECK(bar.block.run.state().template get<environment::FaultCount>(0)[6] > 0);
    }
}
