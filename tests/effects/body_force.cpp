// A force per mass on particles: its laws, a uniform one is gravity, momentum, and what FLIP may not keep.
#include "catch.hpp"

#include <mpmpbd/effects/body_force.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/flip.hpp>
#include <mpmpbd/mpm/transfer/pic.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/testing/effect_laws.hpp>

#include <vector>

namespace {
using namespace mpmpbd;

constexpr double dx = 3.7e-3, dt = 1.25e-4;
constexpr int count = 216;

template <class... Policies> using Solid = Mpm<NeoHookean, Policies...>;
template <class Body, class Effect> struct Flight : Scene<Body, Effect> {};

// A block in free flight whose particles move at random.
template <class Body, class Effect, class T = double>
Simulation<Flight<Body, Effect>, Serial, T> block(Kernels kernels = Kernels::widest) {
  Simulation<Flight<Body, Effect>, Serial, T> run({.environments = 1,
                                                   .cell_size = dx,
                                                   .nodes = {12, 12, 12},
                                                   .capacity = {{"particle", count}},
                                                   .substeps = 1},
                                                  Serial{kernels});
  run.template set<NeoHookean>(lame(1.3e4, 0.4));
  if constexpr (std::is_same_v<typename Body::Transfer, Flip>) run.template set<Flip>({1.0});
  std::vector<Vec3<double>> at;
  at.reserve(count);
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i)
        at.push_back(dx * vec(4.1 + 0.5 * i, 3.9 + 0.5 * j, 4.3 + 0.5 * k));
  run.add_particles(0, at, 1050.0, dx * dx * dx / 8);
  testing::Samples random(5);
  for (int p = 0; p < count; ++p)
    run.state().template set<particle::Velocity>(0, p, cast<T>(random.matrix<3>(-0.1, 0.1)));
  return run;
}

template <class T, class Sim> Vec3<double> momentum(Sim const& run) {
  Vec3<double> sum{};
  for (int p = 0; p < count; ++p)
    sum += double(run.state().template get<particle::Mass>(0, p)) *
           cast<double>(run.state().template get<particle::Velocity>(0, p));
  return sum;
}

template <class Body> void check_gravity() {
  auto const g = vec(0.7, -1.3, -9.81);
  auto falls = block<Body, Gravity>();
  auto pulled = block<Body, BodyForce>();
  falls.template set<Gravity>({{g[0], g[1], g[2]}});
  for (int p = 0; p < count; ++p) pulled.state().template set<particle::BodyForce>(0, p, g);
  for (int n = 0; n < 40; ++n) {
    falls.step(dt);
    pulled.step(dt);
  }
  double apart = 0.0;
  for (int p = 0; p < count; ++p)
    apart = max(apart, norm(falls.state().template get<particle::Position>(0, p) -
                            pulled.state().template get<particle::Position>(0, p)));
  CHECK(pulled.status(0) == 0);
  CHECK(apart <= 1e-13);  // [m]; a few roundings per step
}

// Random forces: the sum of m dt b, whatever the transfer, is what the body gains.
template <class Body, class T> void check_momentum() {
  auto run = block<Body, BodyForce, T>();
  testing::Samples random(6);
  auto const before = momentum<T>(run);
  double const m = 1050.0 * dx * dx * dx / 8;
  Vec3<double> impulse{};
  for (int p = 0; p < count; ++p) {
    auto const b = random.matrix<3>(-90, 110);
    impulse += (m * dt) * b;
    run.state().template set<particle::BodyForce>(0, p, cast<T>(b));
  }
  run.step(dt);
  double const size = count * m * (0.1 + 100 * dt);
  CHECK(norm(momentum<T>(run) - before - impulse) <= 10 * double(epsilon<T>) * size);
}
}  // namespace

TEMPLATE_TEST_CASE("a body force passes its laws", "[effect][laws][force]", float, double) {
  auto const laws = effect_laws<BodyForce, TestType>({});
  REQUIRE(laws.size() >= 2);
  for (auto const& law : laws) {
    INFO(law.text());
    CHECK(law.holds());
  }
}

// Forgets what other effects gave.
struct Overwrites : BodyForce {
  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& p, K const&, Tick<T> const&) {
    p[particle::Acceleration{}] = p[particle::BodyForce{}];
  }
};
TEST_CASE("an acceleration that overwrites does not keep the laws", "[effect][laws][force]") {
  CHECK_FALSE(find_law(effect_laws<Overwrites, double>({}), "adds to the acceleration").holds());
}

TEST_CASE("a uniform body force is gravity", "[effect][force]") {
  check_gravity<Solid<Apic, Mls>>();
  check_gravity<Solid<Apic, WeightGradient, CubicBSpline>>();
  check_gravity<Solid<Tpic, WeightGradient>>();
  check_gravity<Solid<Flip, WeightGradient>>();
  check_gravity<Solid<Pic, LinearBSpline>>();
}

TEMPLATE_TEST_CASE("body forces give their impulse", "[effect][force]", float, double) {
  check_momentum<Solid<Apic, Mls>, TestType>();
  check_momentum<Solid<Tpic, WeightGradient, CubicBSpline>, TestType>();
  check_momentum<Solid<Flip, WeightGradient>, TestType>();
  check_momentum<Solid<Pic, Mls>, TestType>();
}

// Two particles at one place are one to the grid: forces that pull them apart do nothing there, and FLIP,
// which takes the change of the grid, must not keep them either.
TEST_CASE("what the grid cannot see moves nothing", "[effect][force]") {
  auto run = block<Solid<Flip, WeightGradient>, BodyForce>();
  auto& state = run.state();
  for (int p = 0; p < count; ++p) {
    state.set<particle::Velocity>(0, p, {});
    state.set<particle::Position>(0, p, state.get<particle::Position>(0, p - p % 2));
    state.set<particle::BodyForce>(0, p, (p % 2 == 0 ? 1.0 : -1.0) * vec(3.0, -7.0, 11.0));
  }
  run.step(dt);
  for (int p = 0; p < count; ++p) CHECK(norm(state.get<particle::Velocity>(0, p)) <= 1e-17);
}

TEST_CASE("body forces have the same bits on packs", "[effect][force]") {
  using Body = Solid<Apic, Mls>;
  auto wide = block<Body, BodyForce, float>();
  auto plain = block<Body, BodyForce, float>(Kernels::plain);
  testing::Samples random(7);
  for (int p = 0; p < count; ++p) {
    auto const b = cast<float>(random.matrix<3>(-90, 110));
    wide.state().set<particle::BodyForce>(0, p, b);
    plain.state().set<particle::BodyForce>(0, p, b);
  }
  for (int n = 0; n < 5; ++n) {
    wide.step(dt);
    plain.step(dt);
  }
  for (int p = 0; p < count; ++p)
    CHECK(wide.state().get<particle::Position>(0, p) ==
          plain.state().get<particle::Position>(0, p));
}
