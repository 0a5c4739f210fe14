// The stable limit that a run holds on to when it chooses its own substeps.
#pragma once

#include <mpmpbd/core/math.hpp>
#include <mpmpbd/core/status.hpp>

namespace mpmpbd {

// Shorter at once, longer only after a while and by steps: substeps that follow a swing are shorter in each of its
// crests, and that feeds it. A lone particle, which nothing damps, then gains without end; with substeps that are held its
// energy stays within ten times what it was (tests/stability/time_step.cpp).
template <class T> struct HeldLimit {
  static constexpr std::int64_t patience = 32;  // [steps]
  static constexpr double growth = 1.25;        // at most, after them

  T limit;            // that substeps keep [s]; 0: none yet
  T longer;           // the shortest of those met since, all of them longer [s]
  std::int64_t calm;  // steps since it was met last

  // Meets the limit of the present state [s].
  MPMPBD_HD void meet(T now) {
    if (limit > T(0) && now > limit) {
      longer = calm > 0 ? min(longer, now) : now;
      if (++calm < patience) return;
      now = min(longer, T(growth) * limit);
    }
    limit = now;
    calm = 0;
  }
};

}  // namespace mpmpbd
