// What T90 demands, and the reference displacements.
#pragma once

#include <vector>

#include "catch.hpp"
#include "physics/bent_thread.hpp"
#include "support/sanitized.hpp"

namespace test {

using Slippery =
    mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;
using Rough =
    mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::Friction, mpmpbd::NoDrag, false>;

// Displacement of the bend [cells] under a dead load T on the tissue without any thread, dt 0.05, and held by
// a thread of 1e-4 node masses with dt 0.025. Made, and checked again, by
// `test_physics_coupling_bent_reference_long "[T90]"`.
struct BentReference {
  double tension, dead_load, quarter_step;
};
inline constexpr BentReference bent_references[] = {
    {1, 0.0678, 0.0678}, {4, 0.2542, 0.2543}, {8, 0.4754, 0.4780}};

inline BentReference bent_reference(double tension) {
  for (auto const& r : bent_references)
    if (r.tension == tension) return r;
  throw std::invalid_argument("no reference for this tension");
}

// Met where value < limit.
struct Demand {
  char const* what;
  double value, limit;
  bool met() const { return value < limit; }
};
// Tissue tracers start on the segments, which meet the track at angles of up to l/(2 R). When a thread slides
// along itself, and without friction it does for as long as it takes to find its rest, the distance of
// tissue that stays where it is changes by that share of the way. This is not a cut.
inline double bent_growth(BentCase const& c, BentResult const& r) {
  double const angle = bent_length / c.segments / (2 * bend_radius);
  return r.slip_end - r.slip_early - angle * std::abs(r.slide_end - r.slide_early);
}
// An impulse T dt of relative error u, half an ulp, moves a bead of mass m by u T dt^2 / m: a strain of
// u (EA/l) dt^2 / m times T/EA. Each bead meets such an error in every step. Below 2e-8 of T/EA in double.
template <class T> double strain_rounding(BentCase const& c) {
  double const per_length = c.stiffness / (bent_length / c.segments);
  return 0.5 * double(mpmpbd::epsilon<T>) * per_length * c.dt * c.dt / c.bead_mass;
}
template <class T> std::vector<Demand> bent_demands(BentCase const& c, BentResult const& r) {
  BentReference const reference = bent_reference(c.tension);
  auto const off = [](double a, double b) { return std::abs(a / b - 1); };
  return {
      {"runs", r.ran_away ? 1.0 : 0.0, 0.5},
      {"slip", r.slip_end, 0.05},
      {"growth", bent_growth(c, r), 0.005},
      {"tissue", off(r.tissue, reference.dead_load), 0.05},
      {"dt/4", off(r.tissue, reference.quarter_step), 0.05},
      {"stretch", r.stretch, 0.01},
      {"EA", off(r.mean_stretch, c.tension / c.stiffness), 0.1},
      // Of some 10^4 samples of 16 segments; four such errors, one of each of the bead's impulses.
      {"peak", off(r.stretch, c.tension / c.stiffness), 0.1 + 4 * strain_rounding<T>(c)},
      {"energy", r.energy_rise, 0.005},
      {"tension", off(r.held, c.tension), 0.01}};
}

template <class T> BentResult run_bent(BentCase const& c) {
  return c.friction > 0 ? BentThread<T, Rough>(c).run() : BentThread<T, Slippery>(c).run();
}

// The rows of T90 that tier `physics` runs; all of them: coupling_bent_table_long.cpp. Under a sanitizer, which makes a
// row take minutes, only the lighter bead without friction and the heavier with it.
template <class T> void check_bent_threads() {
  for (double mass : {1e-4, 1.0})
    for (double friction : {0.0, 0.2}) {
      if (sanitized && (mass == 1.0) != (friction > 0)) continue;
      BentCase const c{.tension = 4, .bead_mass = mass, .dt = 0.1, .friction = friction};
      for (Demand const& d : bent_demands<T>(c, run_bent<T>(c))) {
        CAPTURE(mass, friction, d.what, d.value, d.limit);
        CHECK(d.met());
      }
    }
}

}  // namespace test
