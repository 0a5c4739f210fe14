// What a simulation refuses, and that it changes nothing then (B13).
#include "catch.hpp"

#include <array>
#include <limits>

#include <mpmpbd/coupling/coupling.hpp>
#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
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

TEST_CASE("options that cannot be are refused by name and value", "[scene][refusal][B13]") {
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
  CHECK(says(make([](auto& o) { o.most_substeps = 0; }), "most_substeps = 0; give at least 1"));
  CHECK(says(make([](auto& o) { o.capacity.clear(); }), "no capacity given for domain 'particle'"));
  CHECK(says(make([](auto& o) { o.capacity[0].slots = -1; }), "'particle' = -1; give at least 1"));
  CHECK(says(make([](auto& o) { o.capacity[0].slots = 0; }), "'particle' = 0; give at least 1"));
}

TEST_CASE("an environment that does not exist is refused everywhere", "[scene][refusal][B13]") {
  Simulation<Block> sim(two_blocks());
  std::array<Vec3<double>, 1> const one{{{{0.02, 0.02, 0.02}}}};
  CHECK(says(refusal([&] { sim.set<NeoHookean>(2, lame(3e4, 0.4)); }),
             "environment 2 given; this run has 0 to 1"));
  CHECK(says(refusal([&] { sim.add_particles(-1, one, 1000.0, 1e-9); }), "environment -1"));
  CHECK(says(refusal([&] { sim.reset(5); }), "environment 5"));
  CHECK(says(refusal([&] { static_cast<void>(sim.status(2)); }), "environment 2"));
  CHECK(says(refusal([&] { static_cast<void>(sim.context(-1)); }), "environment -1"));
  CHECK(says(refusal([&] { static_cast<void>(sim.suggest_dt(2)); }), "environment 2"));
  CHECK(says(refusal([&] { sim.clone(0, 2); }), "environment 2"));
  std::array<unsigned char, 3> const mask{1, 1, 1};
  CHECK(says(refusal([&] { sim.reset(mask); }), "a mask of 3 entries given; this run has 2"));
}

TEST_CASE("particles outside the domain or beyond the capacity are refused whole",
          "[scene][refusal][B13]") {
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

TEST_CASE("particles begin at rest, whatever their slots held before", "[scene]") {
  Simulation<Block> sim(two_blocks());
  std::array<Vec3<double>, 1> const one{{{{0.02, 0.02, 0.02}}}};
  sim.add_particles(1, one, 1000.0, 1e-9);
  using T = decltype(sim)::Scalar;
  for (std::int64_t env : {0, 1})
    sim.state().set<particle::Velocity>(env, 0, vec(T(1), T(2), T(3)));
  sim.state().table<Particles>().set_live(1, 0);
  sim.add_particles(1, one, 1000.0, 1e-9);
  CHECK(norm(sim.state().get<particle::Velocity>(1, 0)) == 0);
  CHECK(norm(sim.state().get<particle::Velocity>(0, 0)) > 3);
}

TEST_CASE("sizes that cannot be are refused by name and value", "[scene][refusal][B13]") {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  double const inf = std::numeric_limits<double>::infinity();
  auto const names = [](std::string const& text, std::string const& name,
                        std::string const& value) {
    CAPTURE(text, name, value);
    CHECK(says(text, name));
    CHECK(says(text, value));
  };
  struct Bad {
    double number;
    std::string text;
  };
  std::array const every{Bad{0.0, "0.0"}, Bad{-5.0, "-5.0"}, Bad{nan, "nan"}, Bad{inf, "inf"},
                         Bad{-inf, "-inf"}};
  Simulation<Block> sim(two_blocks());
  std::array<Vec3<double>, 1> const one{{{{0.02, 0.02, 0.02}}}};
  for (auto const& [number, text] : every) {
    names(refusal([&, bad = number] {
            auto options = two_blocks();
            options.cell_size = bad;
            Simulation<Block> other(options);
          }),
          "cell_size = ", text);
    names(refusal([&, bad = number] { sim.add_particles(0, one, bad, 1e-9); }), "density = ", text);
    names(refusal([&, bad = number] { sim.add_particles(0, one, 1e3, bad); }), "volume = ", text);
    auto const step = refusal([&, bad = number] { sim.step(bad); });
    names(step, "step of ", text);
    CHECK(says(step, "give a positive time"));
  }
  for (double const bad : {nan, inf}) {
    auto points = one;
    points[0][1] = bad;
    names(refusal([&] { sim.add_particles(0, points, 1e3, 1e-9); }), "a particle at ",
          std::to_string(bad));
  }
  CHECK(sim.state().table<Particles>().live(0) == 0);
  CHECK(sim.state().get<environment::Step>(0) == 0);
  CHECK(sim.state().get<environment::Time>(0) == 0);
}

namespace {
struct Sewn
    : Scene<Mpm<NeoHookean>, Pbd<Constraints<Distance>>, Coupling<Embedded, Friction, Drag>> {};
}  // namespace

TEST_CASE("friction and drag that cannot be are refused by name and value",
          "[scene][refusal][B13]") {
  auto options = two_blocks();
  for (auto const& c : RodAssembly<Sewn::Rods>{}.capacity()) options.capacity.push_back(c);
  options.capacity.push_back({ContactPoints::name.view(), 8});
  Simulation<Sewn> sim(options);
  sim.set<Friction>({0.2, 500.0});
  sim.set<Drag>({0.3});
  double const nan = std::numeric_limits<double>::quiet_NaN();
  double const inf = std::numeric_limits<double>::infinity();
  for (double const bad : {-0.1, nan, inf, -inf}) {
    auto const friction = refusal([&] {
      sim.set<Friction>({bad, 500.0});
    }),
               drag = refusal([&] { sim.set<Drag>({bad}); });
    CAPTURE(friction, drag);
    CHECK(says(friction, "Coulomb friction: coefficient = " + std::to_string(bad)));
    CHECK(says(friction, "[0, inf)"));
    CHECK(says(drag, "coefficient = " + std::to_string(bad)));
  }
  for (double const bad : {nan, inf})
    CHECK(says(refusal([&] {
                 sim.set<Friction>({0.2, bad});
               }),
               "clamp_pressure = " + std::to_string(bad)));
  CHECK(sim.state().parameters<Friction>(1).coefficient == 0.2F);
  CHECK(sim.state().parameters<Drag>(1).coefficient == 0.3F);
}
