// APIC: the particle carries an affine velocity field, C = D^-1 sum w v d^T. Jiang et al. 2015, eq. 10.
#pragma once

#include <mpmpbd/mpm/concepts.hpp>

namespace mpmpbd {

// Conserves linear and angular momentum to rounding (with the affine part counted, Jiang et al. 2017).
struct Apic {
  using Role = role::Transfer;
  static constexpr FixedString name = "APIC";
  static constexpr bool branch_free = true;
  using Reads = Fields<>;
  using Writes = Fields<particle::Velocity, particle::Affine>;
  static constexpr bool carries_affine = true;
  static constexpr bool needs_moment = true;
  static constexpr bool needs_slope = false;
  static constexpr bool needs_previous_grid = false;

  template <class P, class T, class K>
  MPMPBD_INLINE static void finish(P& p, Gathered<T> const& g, K const&) {
    p[particle::Velocity{}] = g.velocity;
    p[particle::Affine{}] = g.moment;
  }
};

}  // namespace mpmpbd
