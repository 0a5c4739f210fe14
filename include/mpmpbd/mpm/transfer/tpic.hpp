// TPIC: a Taylor expansion, C = sum v grad w^T, the gradient of the interpolated velocity.
// Nakamura, Matsumura, Mizutani 2023.
#pragma once

#include <mpmpbd/mpm/concepts.hpp>

namespace mpmpbd {

// Limits: angular momentum is kept to about 1e-5 per revolution, not to rounding.
struct Tpic {
  using Role = role::Transfer;
  static constexpr FixedString name = "TPIC";
  static constexpr bool branch_free = true;
  using Reads = Fields<>;
  using Writes = Fields<particle::Velocity, particle::Affine>;
  static constexpr bool carries_affine = true;
  static constexpr bool needs_moment = false;
  static constexpr bool needs_slope = true;
  static constexpr bool needs_previous_grid = false;

  template <class P, class T, class K>
  MPMPBD_INLINE static void finish(P& p, Gathered<T> const& g, K const&) {
    p[particle::Velocity{}] = g.velocity;
    p[particle::Affine{}] = g.slope;
  }
};

}  // namespace mpmpbd
