// A force per mass on every particle, given by the caller: a += b.
#pragma once

#include <mpmpbd/effects/concepts.hpp>

namespace mpmpbd {

// Set particle::BodyForce [N/kg] of the state before a step; it stays until it is set again, and is zero
// before it is set. For manufactured solutions, loads on a part of a body and fields that are no constant (a
// constant is Gravity, which costs no memory). Momentum grows by sum m dt b to rounding.
// Limits: constant over the substeps of a step; three numbers per particle.
struct BodyForce {
  using Role = role::Effect;
  static constexpr FixedString name = "body force";
  static constexpr Slot slot = Slot::before_scatter;
  static constexpr bool branch_free = true;
  using Reads = Fields<particle::BodyForce>;
  using Writes = Fields<particle::Acceleration>;

  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& p, K const&, Tick<T> const&) {
    p[particle::Acceleration{}] += p[particle::BodyForce{}];
  }
};

}  // namespace mpmpbd
