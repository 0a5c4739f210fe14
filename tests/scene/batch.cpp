// Batches: N environments equal N separate runs, bit for bit (B6, B41, B44), and what goes wrong in one
// sets its own bit and nothing else.
// seconds: 5
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/testing/batch_laws.hpp>
#include <mpmpbd/testing/samples.hpp>

#include "catch.hpp"

#include <new>

using namespace mpmpbd;

namespace {

constexpr double dx = 3.7e-3;
using Floor = Wall<Sticky, 2, Side::low>;
struct Tissue : Mpm<NeoHookean> {};
struct Block : Scene<Tissue, Gravity, Floor> {};

// Variants differ in stiffness (so in substeps), gravity, number of particles and motion. 1300 particles
// are two chunks of work.
struct Fill {
  template <class R> void operator()(R& run, std::int64_t env, int which) const {
    run.template set<NeoHookean>(env, lame(2e4 * (1 << (2 * which)), 0.3 + 0.04 * which));
    run.template set<Gravity>(env, {{0.1 * which, 0.0, -9.81}});
    run.template set<Floor>(env, {2.5 * dx});
    std::vector<Vec3<double>> at;
    testing::Samples random(static_cast<std::uint64_t>(which) + 1);
    for (int p = 0; p < 1000 + 100 * which; ++p)
      at.push_back(dx * (vec(3.0, 3.0, 2.6) + 5.0 * random.matrix<3>(0.0, 1.0)));
    run.add_particles(env, at, 1050.0, dx * dx * dx / 8);
    for (std::size_t p = 0; p < at.size(); ++p)
      run.state().template set<particle::Velocity>(
          env, static_cast<std::int64_t>(p), cast<typename R::Scalar>(random.matrix<3>(-0.2, 0.2)));
  }
};

SimulationOptions options(int substeps = 0) {
  return {.environments = 1,
          .cell_size = dx,
          .nodes = {12, 12, 12},
          .capacity = {{"particle", 1400}},
          .substeps = substeps};
}

// Memory runs out in the third substep of a step.
struct Exhausting {
  using Role = role::Effect;
  static constexpr FixedString name = "exhausting";
  static constexpr Slot slot = Slot::on_grid;
  using Reads = Fields<node::Velocity>;
  using Writes = Fields<node::Velocity>;
  template <class Node, class K, class T> static void apply(Node&, K const&, Tick<T> const& tick) {
    if (tick.substep == 2) throw std::bad_alloc();
  }
};

}  // namespace

TEMPLATE_TEST_CASE("Environments of a batch do not know of each other", "", float, double) {
  for (auto const& law :
       batch_laws<Block, TestType>(testing::BatchCase<Fill>{options(), Fill{}, 6e-4, 3})) {
    INFO(law.text());
    CHECK(law.holds());
  }
}

TEST_CASE("Environments choose their own substeps") {
  testing::BatchProbe<Block, float, Fill> probe({options(), Fill{}, 6e-4, 3});
  auto const& state = probe.reference().state();
  std::int64_t previous = 0;
  for (int e = 0; e < 4; ++e) {
    auto const substeps = state.get<environment::Substeps>(e);
    CHECK(substeps > previous);
    CHECK(state.get<environment::Dt>(e) <= state.get<environment::DtLimit>(e) * 1.000001f);
    CHECK(probe.reference().status(e) == 0);
    previous = substeps;
  }
}

TEST_CASE("Trouble sets the bit of its own environment and nothing else") {
  testing::BatchProbe<Block, double, Fill> probe({options(), Fill{}, 6e-4, 2});
  auto const contained = [&](Fault bit, auto&& spoil) { return probe.contained(bit, spoil); };

  SECTION("a particle that leaves is held at the border") {
    for (int axis = 0; axis < 3; ++axis)
      for (double const side : {-1.0, 1.0}) {
        if (axis == 2 && side < 0.0) continue;  // the floor holds it
        auto r = probe.make({0, 1, 2, 3});
        auto x = vec(5.5 * dx, 5.5 * dx, 5.5 * dx);
        x[axis] = side < 0.0 ? 0.52 * dx : 10.48 * dx;
        auto v = Vec3<double>{};
        v[axis] = side * 8.0;
        r.state().set<particle::Position>(1, 0, x);
        r.state().set<particle::Velocity>(1, 0, v);
        r.step(6e-4);
        CHECK(has(r.status(1), Fault::escape));
        auto const held = r.state().get<particle::Position>(1, 0);
        CHECK(held[axis] >= 0.5 * dx);
        CHECK(held[axis] <= 10.5 * dx);
        CHECK(r.status(0) == 0);
      }
    CHECK(contained(Fault::escape, [](auto& r) {
            r.state().template set<particle::Position>(1, 0, vec(0.52 * dx, 5 * dx, 5 * dx));
            r.state().template set<particle::Velocity>(1, 0, vec(-8.0, 0.0, 0.0));
          }) == 0.0);
  }
  SECTION("a position set outside of the domain") {
    for (auto const& x : {vec(-3 * dx, 5 * dx, 5 * dx), vec(5 * dx, 40 * dx, 5 * dx),
                          vec(5 * dx, 5 * dx, 1e300), vec(5 * dx, -1e300, 5 * dx)})
      CHECK(contained(Fault::escape, [&](auto& r) {
              r.state().template set<particle::Position>(1, 0, x);
            }) == 0.0);
  }
  SECTION("an inverted particle") {
    CHECK(contained(Fault::inversion, [](auto& r) {
            r.state().template set<particle::Deformation>(
                1, 7, Mat3<double>{{-1, 0, 0, 0, 1, 0, 0, 0, 1}});
          }) == 0.0);
  }
  SECTION("an infinite velocity and a NaN deformation") {
    CHECK(contained(Fault::not_finite, [](auto& r) {
            r.state().template set<particle::Velocity>(1, 3, vec(1e308 * 10, 0.0, 0.0));
          }) == 0.0);
    CHECK(contained(Fault::not_finite, [](auto& r) {
            auto const nan = std::numeric_limits<double>::quiet_NaN();
            r.state().template set<particle::Deformation>(
                1, 3, Mat3<double>{{nan, 0, 0, 0, 1, 0, 0, 0, 1}});
          }) == 0.0);
  }
}

namespace {
using Run = Simulation<Block, Serial, double>;
using Probe = testing::BatchProbe<Block, double, Fill>;

// One environment some steps from its start; `fresh`: built with the new value, then given that state.
template <class P> void check_change(parameters_t<P, double> const& value) {
  Probe const probe({options(), Fill{}, 6e-4, 3});
  auto changed = probe.run({1});
  auto unchanged = changed;
  Run fresh(changed.options());
  Fill{}(fresh, 0, 1);
  fresh.restore(changed.state());
  for (auto* r : {&changed, &fresh}) r->template set<P>(value);
  for (auto* r : {&changed, &fresh, &unchanged}) probe.advance(*r);
  CHECK(testing::same_bits(changed.state(), 0, fresh.state(), 0));
  // What a particle is at now is another thing than without the change.
  CHECK(changed.state().get<particle::Velocity>(0, 7) !=
        unchanged.state().get<particle::Velocity>(0, 7));
  CHECK(changed.status(0) == 0);
}
}  // namespace

TEST_CASE("Stiffness, gravity and a wall that change in a run are those of a fresh build",
          "[B44]") {
  check_change<NeoHookean>(lame(3e5, 0.45));  // other substeps too
  check_change<NeoHookean>(lame(1e4, 0.2));
  check_change<Gravity>({{3.0, -2.0, 9.0}});
  check_change<Floor>({3.1 * dx});
}

// A gas of lone particles without a floor: 0 leaves by a face, an edge or a corner; the rest are more than four
// cells away, so nothing of it may reach them.
namespace {
struct Loose : Scene<Tissue> {};
struct Leaver {
  static constexpr int rest = 64;
  Vec3<double> at, v;
  void operator()(Simulation<Loose, Serial, double>& r, std::int64_t env) const {
    r.set<NeoHookean>(env, lame(2e4, 0.3));
    std::vector<Vec3<double>> x{at};
    testing::Samples random(7);
    for (int p = 0; p < rest; ++p)
      x.push_back(dx * (vec(8.5, 8.5, 8.5) + 3.0 * random.matrix<3>(0.0, 1.0)));
    r.add_particles(env, x, 1050.0, dx * dx * dx / 8);
    r.state().set<particle::Velocity>(env, 0, v);
    for (int p = 1; p <= rest; ++p)
      r.state().set<particle::Velocity>(env, p, random.matrix<3>(-0.2, 0.2));
  }
};
constexpr int far_nodes = 21;  // the middle is at 10 cells, the border 0.5 cells inside

// All particles but the first hold the same bits in both environments.
bool same_rest(Simulation<Loose, Serial, double> const& r, std::int64_t a, std::int64_t b) {
  bool same = true;
  auto const& s = r.state();
  for (int p = 1; p <= Leaver::rest; ++p)
    same = same && s.get<particle::Position>(a, p) == s.get<particle::Position>(b, p) &&
           s.get<particle::Velocity>(a, p) == s.get<particle::Velocity>(b, p) &&
           s.get<particle::Affine>(a, p) == s.get<particle::Affine>(b, p) &&
           s.get<particle::Deformation>(a, p) == s.get<particle::Deformation>(b, p);
  return same;
}
}  // namespace

TEST_CASE("A particle that leaves by any face, edge or corner is held, counted and alone in it",
          "[B6]") {
  auto o = options(2);
  o.environments = 3;
  for (int& n : o.nodes) n = far_nodes;
  for (int d = 0; d < 27; ++d) {
    Vec3<double> const way = vec(d % 3 - 1.0, d / 3 % 3 - 1.0, d / 9 - 1.0);
    if (norm(way) == 0) continue;
    Simulation<Loose, Serial, double> r(o);
    auto const middle = dx * vec(10.0, 10.0, 10.0);
    auto const border = middle + 9.4 * dx * way;
    double const h = 2e-4;
    // It leaves; it stays; it leaves faster.
    Leaver{border, 0.3 * dx / h * way}(r, 0);
    Leaver{border, {}}(r, 1);
    Leaver{border, 0.5 * dx / h * way}(r, 2);
    int const steps = 3;
    for (int s = 0; s < steps; ++s) r.step(h);
    CAPTURE(d);
    auto const bit = static_cast<std::uint32_t>(Fault::escape);
    CHECK(r.status(0) == bit);
    CHECK(r.status(1) == 0);
    CHECK(r.status(2) == bit);
    CHECK(r.state().get<environment::FaultCount>(0)[3] == 2 * steps);  // in each substep
    CHECK(r.state().get<environment::FaultCount>(1)[3] == 0);
    auto const held = r.state().get<particle::Position>(0, 0);
    for (int a = 0; a < 3; ++a) CHECK(mpmpbd::abs(held[a] - middle[a]) <= 9.5 * dx);
    CHECK(same_rest(r, 0, 1));
    CHECK(same_rest(r, 2, 1));
  }
}

// Strict mode: a fixed number of substeps.
TEST_CASE("A step beyond its limit sets the bit in strict mode") {
  testing::BatchProbe<Block, double, Fill> probe({options(1), Fill{}, 1e-5, 1});
  auto r = probe.make({0, 1, 2, 3});
  double const margin = r.suggest_dt(3) / time_step_safety;
  r.step(0.999 * margin);
  CHECK(r.status(3) == 0);
  r.step(r.suggest_dt(3) / time_step_safety * 1.001);
  CHECK(r.status(3) == static_cast<std::uint32_t>(Fault::time_step));
  CHECK(r.status(0) == 0);

  SECTION("and faster than a cell per substep sets another") {
    r.state().set<particle::Velocity>(0, 0, vec(1.2 * dx / 1e-5, 0.0, 0.0));
    for (std::int64_t p = 0; p < 1000; ++p)
      r.state().set<particle::Velocity>(0, p, vec(1.2 * dx / 1e-5, 0.0, 0.0));
    r.step(1e-5);
    CHECK(has(r.status(0), Fault::speed));
    CHECK(!has(r.status(1), Fault::speed));
  }
}

TEST_CASE("Empty environments run") {
  Simulation<Block, Serial, float> run(options());
  run.set<NeoHookean>(lame(1e4, 0.3));
  run.step(1e-3);
  CHECK(run.status(0) == 0);
  CHECK(run.state().get<environment::Substeps>(0) == 1);
}

TEST_CASE("A step that breaks off leaves a clock that tells what is done") {
  Simulation<Scene<Tissue, Exhausting>> run(options(4));
  run.set<NeoHookean>(lame(1e4, 0.3));
  std::vector<Vec3<double>> const at{dx * vec(5.0, 5.0, 5.0)};
  run.add_particles(0, at, 1050.0, dx * dx * dx / 8);
  CHECK_THROWS_AS(run.step(4e-5), std::bad_alloc);
  CHECK(run.state().get<environment::Step>(0) == 2);
  CHECK(run.state().get<environment::Time>(0) == 20'000'000);  // [ps]
}
