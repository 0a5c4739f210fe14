// A4.3: a free needle that slides along itself in still gel loses its speed as v0 exp(-c t / m).
//
// Drag is implicit in the exchange: v' = v / (1 + dt / tau), tau = mass / drag, both per length. That
// is exact for steady sliding at any dt (coupling_friction.cpp) and first order here: 1 % when tau is
// resolved by 50 substeps. An exponential instead would be exact here and wrong there, where a force
// holds the needle against its drag.
// on a device
#include "catch.hpp"

#include "physics/needle_in_gel.hpp"

using namespace test;

namespace {

struct FreeNeedle : Scene<Gel, FreeArcNeedle, Coupling<Embedded, Drag>, Walls<Sticky>> {};

constexpr double start = 0.4, wire = 3e-4, density = 7.9e3;

// What is left of the speed along itself after some substeps. Walls hold all of the gel.
double remaining(double tau, double dt, int steps) {
  GelBlock block{.high = {9, 9, 15}, .substeps = 1};
  for (int a = 0; a < 3; ++a) block.held_low[a] = 100;
  double const length = 6.3 * gel_cell;
  auto const straight = straight_needle(length, wire);
  auto run = gel_scene<FreeNeedle, double>(block, straight);
  run.set<FreeArcNeedle>(
      {straight.radius, straight.angle, straight.wire_radius, straight.taper, 0.0, 0.0, density});
  run.set<Drag>({density * pi<double> * wire * wire / tau});
  auto const tip = gel_cell * vec(6.13, 5.79, 5.4);
  place_needle(run, 0, straight_pose(straight, tip, vec(0.0, 0.0, -1.0), vec(1.0, 0.0, 0.0)));
  drive_needle(run, 0, vec(0.0, 0.0, -start), {});
  for (int i = 0; i < steps; ++i) run.step(dt);
  auto const view = run.state().view<Needles>();
  auto const pose = needle::pose(view, 0);
  auto const v = velocity_at(pose, needle::twist(view, 0), to_world(pose, straight.point(0.0)));
  REQUIRE(std::hypot(v[0], v[1]) < 1e-3 * start);
  REQUIRE(run.status(0) == 0);
  return -v[2] / start;
}

}  // namespace

TEST_CASE("drag slows a free needle exponentially, whatever the time step",
          "[coupling][embedded][drag]") {
  double previous = 0;
  for (int per_tau : {50, 100, 200}) {
    double const v = remaining(1e-3, 1e-3 / per_tau, per_tau), error = v / std::exp(-1.0) - 1;
    CAPTURE(per_tau, v, error, previous / error);
    CHECK(std::abs(error) < 0.01);
    CHECK(std::abs(v * std::pow(1 + 1.0 / per_tau, per_tau) - 1) < 1e-5);
    if (previous > 0) CHECK(std::abs(previous / error - 2) < 0.1);
    previous = error;
  }
}

TEST_CASE("drag never turns a motion round", "[coupling][embedded][drag]") {
  double least = 1;
  for (double per_tau : {10.0, 1.0, 0.1, 0.01}) {
    double const v = remaining(1e-4 * per_tau, 1e-4, 1);
    CAPTURE(per_tau, v);
    CHECK(v > 0);
    CHECK(v < least);
    least = v;
  }
  CHECK(least < 0.02);
}
