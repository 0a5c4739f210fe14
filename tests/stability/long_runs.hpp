// B39: what may not add up over many steps: rounding that is biased, energy that creeps, a clock that stalls.
#pragma once

#include <cmath>

#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/solvers/direct_banded.hpp>

#include "catch.hpp"
#include "physics/thread_in_gel.hpp"
#include "stability/block.hpp"

namespace test::long_runs {

struct Free : Scene<Mpm<NeoHookean>> {};

// A free block turns about no axis of its own. In float it loses 0.15 eps of its angular momentum in a step,
// always in the same direction: 1.8e-3 in 1e5 steps.
template <class T> void check_spin(int steps, double per_step) {
  Block<Free, T> block({.cells = {{2, 2, 2}}}, lame(5e4, 0.4));
  double const h = block.run.suggest_dt(0);
  block.stir({}, 2e-3 / h * skew(vec(0.6, -0.3, 0.7)));
  auto const start = block.sums();
  for (int s = 0; s < steps; ++s) block.run.step(h);
  auto const end = block.sums();
  // About the middle of mass, which drifts by rounding.
  auto const about = [&](Sums const& s) {
    return s.angular_momentum - cross(block.c.middle(), s.momentum);
  };
  double const change = norm(about(end) - about(start)) / norm(about(start));
  CAPTURE(steps, change, 1e12 * change, norm(end.momentum) / start.momentum_size,
          end.energy() / start.energy());
  CHECK(block.run.status(0) == 0);
  CHECK(end.finite);
  CHECK(change < steps * per_step);
  CHECK(end.energy() <= (1 + 1e-3) * start.energy());
  CHECK(block.run.state().template get<environment::Step>(0) == steps);
  CHECK(block.run.state().template get<environment::Time>(0) == steps * std::llround(1e12 * h));
}

// A thread that hangs from one bead, from its place at rest.
using Rods = Pbd<Constraints<Distance, Bend>, DirectBanded<>>;
struct Hanging : Scene<Rods, Gravity> {};

inline void check_hanging(int steps) {
  int const beads = 20;
  double const spacing = 2e-3, g = 9.81;
  RodMaterial const material{2e9, 1e-4, 1150.0};
  RodAssembly<Rods> rod;
  double const mass = material.line_density() * spacing;
  std::vector<Vec3<double>> points;
  for (int b = 0; b < beads; ++b) points.push_back(vec(0.01, 0.02, 0.1 - spacing * b));
  add_thread(rod, std::span<Vec3<double> const>(points), material);
  rod.prescribe(0);
  Simulation<Hanging, Serial, double> run({.environments = 1, .capacity = rod.capacity()});
  rod.write(run.state(), 0);
  run.set<Gravity>({{0.0, 0.0, -g}});
  for (int s = 0; s < 2000; ++s) run.step(1e-3);  // stretches and settles: implicit Euler damps
  auto const settled = run.state().get<bead::Position>(0, beads - 1);
  for (int s = 0; s < steps; ++s) run.step(1e-3);
  double kinetic = 0, potential = mass * beads * g * spacing * beads;
  for (int b = 0; b < beads; ++b) {
    auto const v = run.state().get<bead::Velocity>(0, b);
    kinetic += 0.5 * mass * dot(v, v);
  }
  auto const x = run.state().get<bead::Position>(0, beads - 1);
  CAPTURE(steps, kinetic / potential, norm(x - settled) / spacing);
  CHECK(run.status(0) == 0);
  CHECK(kinetic < 1e-10 * potential);
  CHECK(norm(x - settled) < 1e-6 * spacing);
  CHECK(run.state().get<environment::Step>(0) == steps + 2000);
}

// Gel with a thread through it, under gravity between sticky walls.
struct Stitched
    : Scene<Gel, ThreadInGel::Rods, Coupling<Embedded, Friction>, Gravity, Damping, Walls<Sticky>> {
};

inline void check_stitched(int steps) {
  ThreadInGel thread{.outside = 0.5};
  thread.block = {.low = {4, 4, 4}, .high = {8, 8, 8}, .substeps = 1};
  for (int a = 0; a < 3; ++a)
    thread.block.held_low[a] = a == 2 ? 4 : 0, thread.block.held_high[a] = 100;
  thread.block.damping = 1 / gel_time();
  auto run = thread.make<Stitched, double>();
  run.set<Friction>({0.2, 500.0});
  run.set<Gravity>({{0.0, 0.0, -9.81}});
  double const h = 0.25 * gel_time();
  for (int s = 0; s < 2000; ++s) run.step(h);
  // 22 % per step would hide what grows slowly, and carries some of the thread's weight: it settles again.
  run.set<Damping>({0.0});
  for (int s = 0; s < 3000; ++s) run.step(h);
  auto const kinetic = [&] {
    double sum = 0;
    for (std::int64_t p = 0; p < thread.block.particles(); ++p) {
      auto const v = run.state().get<particle::Velocity>(0, p);
      sum += 0.5 * run.state().get<particle::Mass>(0, p) * dot(v, v);
    }
    return sum;
  };
  auto const settled = run.state().get<bead::Position>(0, 2);
  double const settled_energy = gel_energy(run, 0), settled_kinetic = kinetic();
  double most = 0;
  for (int s = 1; s <= steps; ++s) {
    run.step(h);
    if (s % 50 == 0) most = std::max(most, kinetic());
  }
  auto const x = run.state().get<bead::Position>(0, 2);
  // The thread still creeps into the gel, ever more slowly: 4e-4 of the gel's energy in 2e4 steps.
  double const change = gel_energy(run, 0) / settled_energy - 1;
  CAPTURE(steps, settled_kinetic / settled_energy, most / settled_energy,
          kinetic() / settled_energy, norm(x - settled) / gel_cell, change);
  CHECK(run.status(0) == 0);
  CHECK(most < 1e-10 * settled_energy);
  CHECK(kinetic() <= settled_kinetic);
  CHECK(norm(x - settled) < 1e-3 * gel_cell);
  CHECK(run.state().get<environment::Step>(0) == steps + 5000);
}

}  // namespace test::long_runs
