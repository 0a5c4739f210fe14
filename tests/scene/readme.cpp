// The scene of the README compiles, runs and is coupled.
#include "catch.hpp"

#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/simulation.hpp>

using namespace mpmpbd;

namespace {
struct Tissue : Mpm<NeoHookean> {};  // quadratic B-splines, APIC and MLS by default
struct Suture : Pbd<Constraints<Distance, Bend>> {};
using Floor = Wall<Sticky, 2, Side::low>;
struct Stitched : Scene<Tissue, Suture, Coupling<Embedded, Friction>, Gravity, Floor> {};
}  // namespace

TEST_CASE("the scene of the README holds its thread in tissue", "[scene][readme]") {
  std::vector<Vec3<double>> points, line;  // [m]
  for (int i = 0; i < 1000; ++i)
    points.push_back(
        {{0.02 + 1e-3 * (i % 10), 0.02 + 1e-3 * (i / 10 % 10), 0.02 + 1e-3 * (i / 100)}});
  for (int i = 0; i < 11; ++i) line.push_back({{0.015 + 2e-3 * i, 0.0243, 0.0241}});
  RodAssembly<Suture> rod;
  add_thread(rod, std::span<Vec3<double> const>(line), RodMaterial{2e9, 1.15e-4, 1140.0});

  SimulationOptions options{.cell_size = 2e-3, .nodes = {26, 26, 26}, .capacity = rod.capacity()};
  options.capacity.push_back({"particle", 1000});
  options.capacity.push_back({"contact point", 11});
  Simulation<Stitched> sim(options);
  sim.set<NeoHookean>(lame(30e3, 0.45));
  sim.set<Gravity>({{0, 0, -9.81}});
  sim.set<Floor>({0.02});
  sim.set<Embedded>({1.15e-4});
  sim.set<Friction>({0.2, 2000.0});
  sim.add_particles(0, points, 1060.0, 1e-9);
  rod.write(sim.state(), 0);
  sim.state().table<ContactPoints>().set_live(0, 11);
  for (int i = 0; i < 5; ++i) sim.step(0.004);  // [s]; substeps from the stable limit

  CHECK(sim.status(0) == 0);
  // In 20 ms a free thread would have fallen 2 mm; in tissue its middle hangs on to it.
  auto const middle = sim.state().get<bead::Position>(0, 5);
  CHECK(middle[2] > 0.0241f - 3e-4f);
  CHECK(sim.state().get<contact::Covered>(0, 5) > 0.5f);
  CHECK(norm(sim.state().get<contact::Impulse>(0, 5)) > 0.0f);
}
