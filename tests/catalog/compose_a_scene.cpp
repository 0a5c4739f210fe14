// The code of docs/tutorials/compose_a_scene.md, and the check that the page shows nothing else.
#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/io/config.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/per_particle.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/plan.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include "catch.hpp"
#include "io/scratch.hpp"
#include "shown.hpp"

using namespace mpmpbd;

namespace first {
struct Block : Mpm<NeoHookean> {};
struct Falling : Scene<Block, Gravity> {};
}  // namespace first

namespace second {
struct Block : Mpm<NeoHookean> {};
using Floor = Wall<Separating, 2, Side::low>;
struct Bouncing : Scene<Floor, Gravity, Damping, Block> {};
}  // namespace second

namespace threads {
struct Thread : Pbd<Constraints<Distance, Bend>> {};
struct Hanging : Scene<Thread, Gravity, Damping> {};
}  // namespace threads

namespace layered {
struct Block : Mpm<PerParticle<NeoHookean>> {};
struct Layers : Scene<Block, Gravity> {};
}  // namespace layered

namespace coupled {
struct Tissue : Mpm<NeoHookean> {};
struct Suture : Pbd<Constraints<Distance, Bend, Swage>> {};
struct Stitch
    : Scene<Tissue, Suture, ArcNeedle, Surface, Coupling<Embedded, Friction, Drag>, Gravity> {};
}  // namespace coupled

struct Settings {
  double young_modulus = 50e3;
  int beads = 20;
  void declare(ConfigKeys& keys) {
    keys(young_modulus, bound::positive("young_modulus_pa", "Pa"), "Young's modulus");
    keys(beads, bound::between("beads", "1", 2, 1000), "points of the thread");
  }
};

TEST_CASE("compose a scene: a body and gravity", "[tutorial]") {
  using namespace first;
  Simulation<Falling> sim(
      {.cell_size = 0.1, .nodes = {16, 16, 16}, .capacity = {{"particle", 64}}});
  auto const k = lame(50e3, 0.3);
  sim.set<NeoHookean>({k.mu, k.lambda});
  sim.set<Gravity>({{0.0, 0.0, -9.81}});

  std::vector<Vec3<double>> points;
  for (int i = 0; i < 64; ++i)
    points.push_back(vec(0.6, 0.6, 1.0) + 0.05 * vec<double>(i % 4, i / 4 % 4, i / 16));
  sim.add_particles(0, points, 1000.0, 0.05 * 0.05 * 0.05);
  for (int i = 0; i < 10; ++i) sim.step(0.01);

  auto const v = sim.state().get<particle::Velocity>(0, 0);
  REQUIRE(v[2] == Approx(-0.981).epsilon(1e-4));
  REQUIRE(sim.status(0) == 0);

  sim.remember();
  sim.step(0.01);
  sim.reset();
  REQUIRE(sim.state().get<particle::Velocity>(0, 0) == v);
}

TEST_CASE("compose a scene: threads", "[tutorial]") {
  using namespace threads;
  RodAssembly<Thread> rod;
  std::vector<Vec3<double>> const line{vec(0.2, 0.2, 1.2), vec(0.8, 0.2, 1.2)};
  auto const thread =
      add_thread(rod, std::span<Vec3<double> const>(line), 20, {2e9, 0.0005, 1140.0});
  rod.prescribe(thread.first);  // its first bead is held

  Simulation<Hanging, Serial, double> sim({.capacity = rod.capacity()});
  rod.write(sim.state(), 0);
  sim.set<Gravity>({{0.0, 0.0, -9.81}});
  for (int i = 0; i < 5; ++i) sim.step(0.002);
  REQUIRE(sim.status(0) == 0);
  REQUIRE(sim.state().get<bead::Position>(0, 19)[2] < 1.2);
  REQUIRE(sim.state().get<bead::Position>(0, 0)[2] == 1.2);
}

TEST_CASE("compose a scene: many environments", "[tutorial]") {
  using namespace second;
  Simulation<Bouncing, Threads, double> sim(
      {.environments = 2, .cell_size = 0.1, .nodes = {16, 16, 16}, .capacity = {{"particle", 64}}},
      {.count = 2});
  sim.set<Gravity>({{0.0, 0.0, -9.81}});
  sim.set<Floor>({0.2});
  for (std::int64_t env = 0; env < 2; ++env) {
    auto const k = lame(env == 0 ? 20e3 : 80e3, 0.3);
    sim.set<NeoHookean>(env, {k.mu, k.lambda});
  }
  for (int i = 0; i < 5; ++i) sim.step(0.002);
  REQUIRE(sim.status(1) == 0);
}

TEST_CASE("compose a scene: what the plan says", "[tutorial]") {
  auto const text = plan<first::Falling>();
  REQUIRE(text.find("gravity") != std::string::npos);
  REQUIRE(text.find("bead") == std::string::npos);
  REQUIRE(plan<coupled::Stitch>().find("bead") != std::string::npos);
}

TEST_CASE("compose a scene: parameters per particle", "[tutorial]") {
  using namespace layered;
  using Material = PerParticle<NeoHookean>;
  Simulation<Layers> sim({.cell_size = 0.1, .nodes = {16, 16, 16}, .capacity = {{"particle", 2}}});
  std::vector<Vec3<double>> const points{vec(0.7, 0.7, 0.7), vec(0.7, 0.7, 0.8)};
  sim.add_particles(0, points, 1000.0, 1e-3);
  for (std::int64_t i = 0; i < 2; ++i) {
    auto const k = lame<float>(i == 0 ? 20e3 : 80e3, 0.3);
    sim.state().set<Material::Values>(0, i, Material::pack<float>({k.mu, k.lambda}));
  }
  sim.step(1e-3);
  REQUIRE(sim.status(0) == 0);
}

TEST_CASE("compose a scene: settings from a file", "[tutorial]") {
  ::Scratch const scratch;
  io::write_file(scratch / "scene.toml", "young_modulus_pa = 30e3\n");
  auto const settings = io::read_config<Settings>(scratch / "scene.toml");
  REQUIRE(settings.young_modulus == 30e3);
  io::write_config(scratch / "resolved.toml", settings);
  REQUIRE(io::read_config<Settings>(scratch / "resolved.toml").beads == 20);
}

TEST_CASE("compose a scene: the page shows this code", "[tutorial]") {
  CHECK(blocks_not_in(__FILE__, "tutorials/compose_a_scene.md") == std::vector<std::string>{});
}
