// FLIP: the particle takes the change of the grid's velocity. Brackbill and Ruppel 1986.
#pragma once

#include <array>

#include <mpmpbd/mpm/concepts.hpp>

namespace mpmpbd {

// v <- blend (v + sum w (v_i - v_i before forces)) + (1 - blend) sum w v_i; blend = 0 is PIC.
// Limits: keeps noise that the grid cannot see; blend < 1 dissipates per step, not per second.
struct Flip {
  using Role = role::Transfer;
  static constexpr FixedString name = "FLIP";
  static constexpr bool branch_free = true;
  using Reads = Fields<particle::Velocity>;
  using Writes = Fields<particle::Velocity>;
  static constexpr bool carries_affine = false;
  static constexpr bool needs_moment = false;
  static constexpr bool needs_slope = false;
  static constexpr bool needs_previous_grid = true;

  template <class T> struct Parameters {
    T blend;  // share of FLIP [1]
  };
  static constexpr std::array<ParameterInfo, 1> parameter_info{
      {bound::between("blend", "1", 0, 1)}};

  template <class P, class T, class K>
  MPMPBD_INLINE static void finish(P& p, Gathered<T> const& g, K const& k) {
    p[particle::Velocity{}] =
        add_product(g.velocity, k.blend, p[particle::Velocity{}] - g.previous_velocity);
  }
};

}  // namespace mpmpbd
