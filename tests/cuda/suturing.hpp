// The suturing scene for tests of a device, in a grid that fits into the shared memory of one block.
#pragma once

#include <mpmpbd/backend/cuda.hpp>
#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/catalog/suturing.hpp>
#include <mpmpbd/catalog/suturing_hand.hpp>

#include "cuda/compare.hpp"

namespace test {

using namespace mpmpbd;

using OnHost = Simulation<Suturing, Serial, float>;
using OnDevice = Simulation<Suturing, Cuda, float>;

inline SuturingConfig config() {
  SuturingConfig c;
  c.domain.size = {{2.5, 1.5, 1.5}};
  c.tissue.corner = {{0.25, 0.25, 0.25}};
  c.tissue.points = {{24, 12, 12}};
  return c;
}

// A hand drives the needle; after `steps` of it the needle is in tissue, and the thread follows.
inline constexpr int steps_to_tissue = 400;
template <class Run> void drive(Run& run, SuturingConfig const& c, int first, int steps) {
  suturing::ScriptedHand const hand{c.script()};
  double const h = c.time.step;
  for (int s = first; s < first + steps; ++s) {
    for (std::int64_t env = 0; env < run.environments(); ++env) hand.command(run, env, s * h, h);
    run.step(h);
  }
}

// One environment with the needle in tissue, found once.
inline OnHost const& stitch_under_way() {
  static OnHost const run = [] {
    auto const c = config();
    OnHost r(suturing::options(c));
    suturing::set_up(r, 0, c);
    drive(r, c, 0, steps_to_tissue);
    return r;
  }();
  return run;
}

// Environments of a run that are copies of one of another.
template <class Run> void fill(Run& run, OnHost const& source) {
  for (std::int64_t env = 0; env < run.environments(); ++env)
    run.state().copy_environment(env, source.state(), 0);
}
inline OnDevice device_run(std::int64_t environments, Cuda where = {}) {
  OnDevice run(suturing::options(config(), environments), where);
  fill(run, stitch_under_way());
  return run;
}

}  // namespace test
