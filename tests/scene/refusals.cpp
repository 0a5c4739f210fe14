// What a simulation refuses, and that it changes nothing then.
#include "catch.hpp"

#include <array>

#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>

using namespace mpmpbd;

namespace {
struct Block : Scene<Mpm<NeoHookean>> {};

SimulationOptions two_blocks() {
  SimulationOptions options;
  options.environments = 2;
  options.cell_size = 4.3e-3;
  for (int& n : options.nodes) n = 12;
  options.capacity = {{"particle", 8}};
  return options;
}

template <class Action> std::string refusal(Action const& action) {
  try {
    action();
  } catch (std::exception const& e) { return e.what(); }
  return "";
}
bool says(std::string const& text, std::string const& part) {
  return text.find(part) != std::string::npos;
}
}  // namespace

TEST_CASE("options that cannot be are refused by name and value", "[scene][refusal]") {
  auto make = [](auto const& change) {
    return refusal([&] {
      auto options = two_blocks();
      change(options);
      Simulation<Block> sim(options);
    });
  };
  CHECK(says(make([](auto& o) { o.environments = 0; }), "environments = 0"));
  CHECK(says(make([](auto& o) { o.cell_size = -1.0; }), "cell_size = -1"));
  CHECK(says(make([](auto& o) { o.nodes[1] = 3; }), "nodes per axis = 3"));
  CHECK(says(make([](auto& o) { o.substeps = -2; }), "substeps = -2"));
  CHECK(says(make([](auto& o) { o.capacity.clear(); }), "no capacity given for domain 'particle'"));
}

TEST_CASE("an environment that does not exist is refused everywhere", "[scene][refusal]") {
  Simulation<Block> sim(two_blocks());
  std::array<Vec3<double>, 1> const one{{{{0.02, 0.02, 0.02}}}};
  CHECK(says(refusal([&] { sim.set<NeoHookean>(2, lame(3e4, 0.4)); }),
             "environment 2 given; this run has 0 to 1"));
  CHECK(says(refusal([&] { sim.add_particles(-1, one, 1000.0, 1e-9); }), "environment -1"));
  CHECK(says(refusal([&] { sim.reset(5); }), "environment 5"));
  CHECK(says(refusal([&] { sim.clone(0, 2); }), "environment 2"));
  std::array<unsigned char, 3> const mask{1, 1, 1};
  CHECK(says(refusal([&] { sim.reset(mask); }), "a mask of 3 entries given; this run has 2"));
}

TEST_CASE("particles outside the domain or beyond the capacity are refused whole",
          "[scene][refusal]") {
  Simulation<Block> sim(two_blocks());
  std::vector<Vec3<double>> points(9, {{0.02, 0.021, 0.022}});
  CHECK(says(refusal([&] { sim.add_particles(0, points, 1000.0, 1e-9); }), "capacity is 8"));
  points.resize(2);
  points[1][2] = 0.06;
  CHECK(says(refusal([&] { sim.add_particles(0, points, 1000.0, 1e-9); }), "a particle at 0.06"));
  points.pop_back();
  CHECK(says(refusal([&] { sim.add_particles(0, points, -5.0, 1e-9); }), "density = -5"));
  CHECK(sim.state().table<Particles>().live(0) == 0);
}
