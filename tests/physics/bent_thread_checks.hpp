// What T90 demands, and the reference displacements.
#pragma once

#include "catch.hpp"
#include "physics/bent_thread.hpp"

namespace test {

using Slippery =
    mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;
using Rough =
    mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::Friction, mpmpbd::NoDrag, false>;

// Tissue displacement under a dead load of T = 4 without any thread, dt 0.05; and of the thread itself with
// dt/4. Both are computed again by `test_physics_coupling_bent_reference_long`.
inline constexpr double dead_load_displacement = 0.2531, quarter_step_displacement = 0.2546;

template <class T> void check_bent_threads() {
  for (double mass : {1e-4, 1.0})
    for (double friction : {0.0, 0.2}) {
      BentCase const c{.tension = 4, .bead_mass = mass, .dt = 0.1, .friction = friction};
      BentResult const r =
          friction > 0 ? BentThread<T, Rough>(c).run() : BentThread<T, Slippery>(c).run();
      CAPTURE(mass, friction, r.slip_early, r.slip_end, r.tissue, r.stretch, r.energy_rise, r.held);
      CHECK_FALSE(r.ran_away);
      CHECK(r.slip_end < 0.05);
      CHECK(r.slip_end - r.slip_early < 0.005);
      CHECK(std::abs(r.tissue / dead_load_displacement - 1) < 0.05);
      CHECK(std::abs(r.tissue / quarter_step_displacement - 1) < 0.05);
      CHECK(r.stretch < 0.01);
      CHECK(std::abs(r.stretch / (c.tension / c.stiffness) - 1) < 0.1);
      CHECK(r.energy_rise < 0.005);
      CHECK(std::abs(r.held / c.tension - 1) < 0.01);
    }
}

}  // namespace test
