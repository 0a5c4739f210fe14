// Air around threads: a free thread loses its swing, v *= exp(-c dt).
#pragma once

#include <array>

#include <mpmpbd/effects/concepts.hpp>
#include <mpmpbd/pbd/fields.hpp>

namespace mpmpbd {

// Stands for everything that a thread rubs against or within itself outside of tissue. Acts on beads only;
// exact at any dt. In tissue it is a small part of Drag: c times the mass per length.
struct Air {
  using Role = role::Effect;
  static constexpr FixedString name = "air";
  static constexpr Slot slot = Slot::before_solve;
  using Reads = Fields<bead::Velocity, bead::InverseMass>;
  using Writes = Fields<bead::Velocity>;

  template <class T> struct Parameters {
    T rate;  // [1/s]
  };
  static constexpr std::array<ParameterInfo, 1> parameter_info{
      {bound::not_negative("rate", "1/s")}};

  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& bead, K const& k, Tick<T> const& tick) {
    if (bead[bead::InverseMass{}] > T(0)) bead[bead::Velocity{}] *= exp(-k.rate * tick.dt);
  }
};

}  // namespace mpmpbd
