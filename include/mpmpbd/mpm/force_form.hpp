// Which gradient carries internal forces to the grid and updates F.
#pragma once

#include <mpmpbd/mpm/concepts.hpp>
#include <mpmpbd/mpm/transfer/apic.hpp>

namespace mpmpbd {

// f_i = -V0 tau grad w, F <- (I + dt sum v grad w^T) F. Sulsky et al. 1994.
struct WeightGradient {
  using Role = role::Form;
  static constexpr FixedString name = "weight gradient";
  static constexpr bool branch_free = true;
  static constexpr bool uses_moment = false;
};

// f_i = -V0 tau D^-1 w d, F <- (I + dt D^-1 sum w v d^T) F. Hu et al. 2018 (MLS-MPM), eq. 16-18.
// Limits: bending is 8-9 % softer at four cells of thickness; needs a shape with constant inertia D.
struct Mls {
  using Role = role::Form;
  static constexpr FixedString name = "MLS";
  static constexpr bool branch_free = true;
  static constexpr bool uses_moment = true;
};

// Several policies under one name; a composition spreads them.
template <class... Policies> struct Bundle { using List = TypeList<Policies...>; };
using MlsApic = Bundle<Apic, Mls>;

}  // namespace mpmpbd
