// A rigid smooth sphere that is moved into tissue: what an indentation test presses with.
#pragma once

#include <array>

#include <mpmpbd/effects/concepts.hpp>

namespace mpmpbd {

// Nodes within the sphere may not approach its centre faster than it moves itself: they lose that part of their
// relative velocity along the normal, slide freely, and let go. The sphere moves at a constant velocity from its
// place at time 0 until a given time, and then stands.
// Limits: contact is felt where the nodes are, up to 1.5 cells before the particles meet the sphere; a needle's contact
// feels these nodes as free.
struct Indenter {
  using Role = role::Effect;
  static constexpr FixedString name = "indenter";
  static constexpr Slot slot = Slot::at_boundary;
  static constexpr bool drives = true;
  using Reads = Fields<node::Position, node::Velocity>;
  using Writes = Fields<node::Velocity>;

  template <class T> struct Parameters {
    T centre[3];    // at time 0 [m]
    T velocity[3];  // [m/s]
    T radius;       // [m]
    T until;        // when it stops [s]
  };
  static constexpr std::array<ParameterInfo, 8> parameter_info{
      {bound::any("centre_x", "m"), bound::any("centre_y", "m"), bound::any("centre_z", "m"),
       bound::any("velocity_x", "m/s"), bound::any("velocity_y", "m/s"),
       bound::any("velocity_z", "m/s"), bound::positive("radius", "m"),
       bound::not_negative("until", "s")}};

  template <class Node, class K, class T>
  MPMPBD_HD static void apply(Node& n, K const& k, Tick<T> const& tick) {
    bool const moves = tick.time < k.until;
    T const moved = moves ? tick.time : k.until;
    auto const velocity = vec(k.velocity[0], k.velocity[1], k.velocity[2]);
    auto const arm = add_product(n[node::Position{}] - vec(k.centre[0], k.centre[1], k.centre[2]),
                                 -moved, velocity);
    T const distance = norm(arm);
    if (!(distance < k.radius && distance > T(0))) return;
    auto const out = (T(1) / distance) * arm;
    auto& v = n[node::Velocity{}];
    T const parting = dot(v - (moves ? T(1) : T(0)) * velocity, out);
    if (parting < T(0)) v = add_product(v, -parting, out);
  }
};

}  // namespace mpmpbd
