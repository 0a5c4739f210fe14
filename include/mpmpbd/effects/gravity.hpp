// Gravity, or any uniform acceleration: v += dt g.
#pragma once

#include <array>

#include <mpmpbd/effects/concepts.hpp>
#include <mpmpbd/needle/fields.hpp>
#include <mpmpbd/pbd/fields.hpp>

namespace mpmpbd {

// Acts on the grid, and on beads of threads and a free needle where the scene has any. Exact for a constant g: after
// n steps of symplectic Euler, x = g dt^2 n (n + 1) / 2.
struct Gravity {
  using Role = role::Effect;
  static constexpr FixedString name = "gravity";
  static constexpr Slot slot = Slot::on_grid;
  using Reads = Fields<node::Velocity>;
  using Writes = Fields<node::Velocity>;

  template <class T> struct Parameters {
    T g[3];  // [m/s^2]
  };
  static constexpr std::array<ParameterInfo, 3> parameter_info{
      {bound::any("g_x", "m/s^2"), bound::any("g_y", "m/s^2"), bound::any("g_z", "m/s^2")}};

  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& node, K const& k, Tick<T> const& tick) {
    fall(node[node::Velocity{}], k, tick);
  }

  // A bead without inverse mass has a prescribed motion: it does not fall.
  struct OnBeads {
    using Role = role::Effect;
    using ParametersOf = Gravity;
    static constexpr FixedString name = "gravity on threads";
    static constexpr Slot slot = Slot::before_solve;
    using Reads = Fields<bead::Velocity, bead::InverseMass>;
    using Writes = Fields<bead::Velocity>;

    template <class Item, class K, class T>
    MPMPBD_HD static void apply(Item& bead, K const& k, Tick<T> const& tick) {
      if (!(bead[bead::InverseMass{}] > T(0))) return;
      fall(bead[bead::Velocity{}], k, tick);
    }
  };

  // Every point of the needle gains the same velocity: it does not turn, wherever its centre of mass is.
  struct OnNeedle {
    using Role = role::Effect;
    using ParametersOf = Gravity;
    static constexpr FixedString name = "gravity on the needle";
    static constexpr Slot slot = Slot::on_needle;
    using Reads = Fields<needle::LinearVelocity>;
    using Writes = Fields<needle::LinearVelocity>;

    template <class Item, class K, class T>
    MPMPBD_HD static void apply(Item& needle, K const& k, Tick<T> const& tick) {
      fall(needle[needle::LinearVelocity{}], k, tick);
    }
  };

 private:
  // Rounded alike for nodes, beads and needles.
  template <class V, class K, class T>
  MPMPBD_HD static void fall(V&& v, K const& k, Tick<T> const& tick) {
    for (int a = 0; a < 3; ++a) v[a] = multiply_add(tick.dt, k.g[a], v[a]);
  }
};

}  // namespace mpmpbd
