// Materials and effects composed into scenes: what is stored, and that a run stays sound.
#include "catch.hpp"

#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/pinned_region.hpp>
#include <mpmpbd/effects/prony.hpp>
#include <mpmpbd/effects/viscosity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/materials/per_particle.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>
#include <mpmpbd/mpm/materials/weakly_compressible_fluid.hpp>
#include <mpmpbd/scene/scene.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include <vector>

namespace {
using namespace mpmpbd;

struct Pool : Scene<Mpm<WeaklyCompressibleFluid>, Gravity, Viscosity, Walls<Slip>> {};
using Layered = PerParticle<StableNeoHookean>;
struct Slab : Scene<Mpm<Layered>, Gravity, Prony<2>, PinnedRegion> {};
struct Plain : Scene<Mpm<StableNeoHookean>, Gravity> {};

constexpr double dx = 0.0125;

// 2 x 2 x 2 points per cell in a box of cells [4, 10) x [4, 10) x [4, 8).
std::vector<Vec3<double>> block() {
  std::vector<Vec3<double>> points;
  for (int i = 8; i < 20; ++i)
    for (int j = 8; j < 20; ++j)
      for (int k = 8; k < 16; ++k)
        points.push_back({{(i + 0.5) * dx / 2, (j + 0.5) * dx / 2, (k + 0.5) * dx / 2}});
  return points;
}
SimulationOptions options(std::size_t points) {
  SimulationOptions o;
  o.cell_size = dx;
  o.nodes[0] = o.nodes[1] = o.nodes[2] = 15;
  o.capacity = {{"particle", static_cast<std::int64_t>(points)}};
  return o;
}
}  // namespace

TEST_CASE("an effect that is not named stores nothing", "[effect][scene]") {
  STATIC_REQUIRE(contains<Slab::StateFields, Prony<2>::Previous>);
  STATIC_REQUIRE(contains<Slab::StateFields, Prony<2>::Overstress>);
  STATIC_REQUIRE(contains<Slab::StateFields, Layered::Values>);
  STATIC_REQUIRE_FALSE(contains<Plain::StateFields, Prony<2>::Previous>);
  STATIC_REQUIRE_FALSE(contains<Plain::StateFields, Layered::Values>);
  STATIC_REQUIRE_FALSE(contains<Slab::StateFields, particle::Fibre>);
  STATIC_REQUIRE_FALSE(contains<Slab::StateFields, particle::Stress>);
}

TEST_CASE("a viscous fluid settles between walls and forgets its shape", "[effect][scene][fluid]") {
  auto const points = block();
  Simulation<Pool, Serial, double> run(options(points.size()));
  run.set<WeaklyCompressibleFluid>({2e4, 7.0});  // c = 4.5 m/s
  run.set<Gravity>({{0.0, 0.0, -9.81}});
  run.set<Viscosity>({1.0});
  run.set<Walls<Slip>>({{4 * dx, 4 * dx, 4 * dx}, {10 * dx, 10 * dx, 14 * dx}});
  run.add_particles(0, points, 1000.0, dx * dx * dx / 8);
  for (int n = 0; n < 40; ++n) run.step(2e-3);
  CHECK(run.status(0) == 0);
  auto const& particles = run.state().table<Particles>();
  double lowest = 1, highest = 0, shape = 0, J_low = 10, J_high = 0;
  for (std::int64_t p = 0; p < particles.live(0); ++p) {
    auto const x = particles.get<particle::Position>(0, p);
    auto const F = particles.get<particle::Deformation>(0, p);
    shape = std::max(shape, norm(F - F(0, 0) * Mat3<double>::identity()));
    J_low = std::min(J_low, determinant(F));
    J_high = std::max(J_high, determinant(F));
    lowest = std::min(lowest, x[2]);
    highest = std::max(highest, x[2]);
  }
  CHECK(shape == 0.0);
  // The weight of the column compresses it by rho g h / K = 2.5 %, twice that while it swings.
  CHECK(J_low > 0.93);
  CHECK(J_high < 1.04);
  CHECK(lowest > 3.5 * dx);
  CHECK(highest > 7 * dx);
  CHECK(highest < 8.5 * dx);
}

TEST_CASE("a layered viscoelastic slab hangs from its pinned end and creeps",
          "[effect][scene][prony]") {
  auto const points = block();
  auto const sag = [&](double share) {
    Simulation<Slab, Serial, double> run(options(points.size()));
    run.set<Gravity>({{0.0, 0.0, -9.81}});
    run.set<Prony<2>>({{share, share / 2}, {0.01, 0.04}});
    run.set<PinnedRegion>({{0, 0, 0}, {5 * dx, 15 * dx, 15 * dx}});
    run.add_particles(0, points, 1000.0, dx * dx * dx / 8);
    auto& particles = run.state().table<Particles>();
    for (std::size_t p = 0; p < points.size(); ++p)  // the lower half is twice as stiff
      particles.set<Layered::Values>(
          0, static_cast<std::int64_t>(p),
          Layered::pack<double>(lame(points[p][2] < 6 * dx ? 4e4 : 2e4, 0.4)));
    for (int n = 0; n < 60; ++n) run.step(2e-3);
    CHECK(run.status(0) == 0);
    double least = 1;
    for (std::int64_t p = 0; p < particles.live(0); ++p)
      least = std::min(least, particles.get<particle::Position>(0, p)[2]);
    return 4.25 * dx - least;
  };
  double const elastic = sag(0.0), viscoelastic = sag(0.5);
  CAPTURE(elastic, viscoelastic);
  CHECK(elastic > 0.05 * dx);
  CHECK(viscoelastic > 1.2 * elastic);
  CHECK(viscoelastic < 4.0 * dx);
}
