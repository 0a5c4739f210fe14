// The clock of one environment's substep.
#pragma once

#include <cstdint>

namespace mpmpbd {

// Time is a count of steps, not a sum of dt: a float sum stops growing after 2^24 steps.
template <class T> struct Tick {
  T dt;           // length of this substep [s]
  T previous_dt;  // length of the substep before it [s]; impulses are carried over in proportion
  std::int64_t step;  // substeps taken by this environment since its reset
  T time = T(0);      // since its reset, at the start of this substep [s]
  int substep = 0;    // which of the step's substeps this is
  int substeps = 1;   // of the step
};

}  // namespace mpmpbd
