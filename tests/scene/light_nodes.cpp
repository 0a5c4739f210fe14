// Nodes at the edge of a shape function get masses down to the smallest float and below (B7): nothing
// but the particles' own motion may come back from them.
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include <cmath>
#include <vector>

#include "catch.hpp"

using namespace mpmpbd;

namespace {
template <class Body> struct Alone : Scene<Body> {};

// A particle of `mass` a few roundings off the middle between nodes on two axes or three.
template <class Body> void check(float mass, int axes) {
  float const dx = 0x1p-13f;  // 0.12 mm
  for (int ulps = 1; ulps < 40; ++ulps) {
    Simulation<Alone<Body>, Serial, float> run({.environments = 1,
                                                .cell_size = double(dx),
                                                .nodes = {8, 8, 8},
                                                .capacity = {{"particle", 1}},
                                                .substeps = 1});
    run.template set<NeoHookean>(lame(1e4, 0.3));
    std::vector<Vec3<double>> const at{double(dx) * vec(3.5, 3.5, 3.5)};
    run.add_particles(0, at, 1000.0, 1e-13);
    Vec3<float> x{{3.5f * dx, 3.5f * dx, 3.47f * dx}};
    for (int a = 0; a < axes; ++a)
      for (int n = 0; n < ulps; ++n) x[a] = std::nextafter(x[a], 1.0f);
    Vec3<float> const v{{0.01f, -0.02f, 0.005f}};
    run.state().template set<particle::Position>(0, 0, x);
    run.state().template set<particle::Velocity>(0, 0, v);
    run.state().template set<particle::Mass>(0, 0, mass);
    run.state().template set<particle::Volume>(0, 0, mass / 1000.0f);
    for (int s = 0; s < 3; ++s) run.step(1e-7);
    CAPTURE(mass, axes, ulps);
    REQUIRE(run.status(0) == 0);
    auto const after = run.state().template get<particle::Velocity>(0, 0);
    REQUIRE(norm(after - v) < 1e-5f * norm(v));
  }
}
}  // namespace

TEST_CASE("Nodes of almost no mass do no harm") {
  for (float const mass : {1e-9f, 1e-12f, 1e-16f, 1e-20f, 1e-24f})
    for (int const axes : {1, 2, 3}) {
      check<Mpm<NeoHookean>>(mass, axes);
      check<Mpm<NeoHookean, CubicBSpline>>(mass, axes);
      check<Mpm<NeoHookean, Tpic, WeightGradient>>(mass, axes);
    }
}
