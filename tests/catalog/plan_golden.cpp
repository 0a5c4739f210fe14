// The plans of the catalogue, compared with stored texts: what a scene stores and runs changes only on
// purpose. After such a change: MPMPBD_UPDATE_GOLDEN=1 build/.../test_catalog_plan_golden
#include <mpmpbd/catalog.hpp>
#include <mpmpbd/io/file.hpp>

#include <cstdlib>

#include "catch.hpp"

using namespace mpmpbd;

TEST_CASE("plans of the catalogue are the stored ones", "[catalog][plan]") {
  auto const folder = std::filesystem::path(__FILE__).parent_path() / "golden";
  for (auto const& scene : catalog::entries()) {
    auto const file = folder / (std::string(scene.name) + ".txt");
    auto const now = std::string(scene.about) + "\n" + scene.plan();
    if (std::getenv("MPMPBD_UPDATE_GOLDEN") != nullptr) {
      std::filesystem::create_directories(folder);
      io::write_file(file, now);
    }
    INFO("scene " << scene.name << ", stored in " << file.string());
    REQUIRE(now == io::read_file(file));
  }
}

TEST_CASE("a scene without a part has no trace of it", "[catalog][plan]") {
  auto const tissue = catalog::entry("tissue").plan(), suture = catalog::entry("suture").plan();
  for (auto const* word : {"bead", "Distance", "needle", "contact", "rods"})
    REQUIRE(tissue.find(word) == std::string::npos);
  for (auto const* word : {"particle", "node", "neo-Hookean", "needle", "contact", "scatter"})
    REQUIRE(suture.find(word) == std::string::npos);
}

TEST_CASE("an unknown scene is refused with the names that there are", "[catalog]") {
  REQUIRE_THROWS_WITH(catalog::entry("sutur"),
                      Catch::Contains("no scene 'sutur'; there are tissue, suture, suturing"));
}

// The functions with all loops come from the library, for each back end and precision.
TEMPLATE_TEST_CASE("catalogue scenes run in every combination", "[catalog]", float, double) {
  auto run = [](auto backend) {
    Simulation<catalog::Tissue, decltype(backend), TestType> sim(
        {.cell_size = 0.1, .nodes = {12, 12, 12}, .capacity = {{"particle", 64}}}, backend);
    auto const k = lame(1e5, 0.3);
    sim.template set<NeoHookean>({k.mu, k.lambda});
    sim.template set<Gravity>({{0.0, 0.0, -9.81}});
    sim.template set<Viscosity>({0.0});
    sim.template set<catalog::Bottom>({0.2});
    std::vector<Vec3<double>> points;
    for (int i = 0; i < 64; ++i)
      points.push_back(vec(0.4, 0.4, 0.2) + 0.05 * vec(0.5 + i % 4, 0.5 + i / 4 % 4, 0.5 + i / 16));
    sim.add_particles(0, points, 1000.0, 1.25e-4);
    for (int i = 0; i < 5; ++i) sim.step(0.002);
    REQUIRE(sim.status(0) == 0);
    return sim.state().template get<particle::Position>(0, 63);
  };
  auto const serial = run(Serial{});
  REQUIRE(serial == run(Threads{2}));
  REQUIRE(serial[2] < TestType(0.375));
}
