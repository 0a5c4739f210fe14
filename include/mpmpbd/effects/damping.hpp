// Damping of all motion, exponential in physical time: v *= exp(-c dt).
#pragma once

#include <array>

#include <mpmpbd/effects/concepts.hpp>
#include <mpmpbd/pbd/fields.hpp>

namespace mpmpbd {

// For settling a scene. Exact at any dt: it can neither reverse a velocity nor depend on the step.
// Limits: not a material property - rigid motion is damped too; take Prony or Viscosity for tissue.
struct Damping {
  using Role = role::Effect;
  static constexpr FixedString name = "damping";
  static constexpr Slot slot = Slot::on_grid;
  using Reads = Fields<node::Velocity>;
  using Writes = Fields<node::Velocity>;

  template <class T> struct Parameters {
    T rate;  // [1/s]
  };
  static constexpr std::array<ParameterInfo, 1> parameter_info{
      {bound::not_negative("rate", "1/s")}};

  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& node, K const& k, Tick<T> const& tick) {
    node[node::Velocity{}] *= exp(-k.rate * tick.dt);
  }

  struct OnBeads {
    using Role = role::Effect;
    using ParametersOf = Damping;
    static constexpr FixedString name = "damping of threads";
    static constexpr Slot slot = Slot::before_solve;
    using Reads = Fields<bead::Velocity, bead::InverseMass>;
    using Writes = Fields<bead::Velocity>;

    template <class Item, class K, class T>
    MPMPBD_HD static void apply(Item& bead, K const& k, Tick<T> const& tick) {
      if (bead[bead::InverseMass{}] > T(0)) bead[bead::Velocity{}] *= exp(-k.rate * tick.dt);
    }
  };
};

}  // namespace mpmpbd
