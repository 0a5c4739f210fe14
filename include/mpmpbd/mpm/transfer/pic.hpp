// PIC: the particle takes the grid's velocity. Harlow 1964; Sulsky et al. 1994.
#pragma once

#include <mpmpbd/mpm/concepts.hpp>

namespace mpmpbd {

// Limits: dissipates all modes below the grid, more with every step (diverges as dt -> 0), and loses
// angular momentum. The cheap bad end of every comparison.
struct Pic {
  using Role = role::Transfer;
  static constexpr FixedString name = "PIC";
  static constexpr bool branch_free = true;
  using Reads = Fields<>;
  using Writes = Fields<particle::Velocity>;
  static constexpr bool carries_affine = false;
  static constexpr bool needs_moment = false;
  static constexpr bool needs_slope = false;
  static constexpr bool needs_previous_grid = false;

  template <class P, class T, class K>
  MPMPBD_INLINE static void finish(P& p, Gathered<T> const& g, K const&) {
    p[particle::Velocity{}] = g.velocity;
  }
};

}  // namespace mpmpbd
