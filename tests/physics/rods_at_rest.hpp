// Threads clamped at one end, loads on their beads, and friction until nothing moves.
#pragma once

#include "physics/rods_on_back_end.hpp"

namespace rods {

// A wire so thin that it bends and does not stretch: its strain under P is P r^2 / (4 EI).
inline RodMaterial thin_wire(double bending_stiffness, double line_density, double radius) {
  double const area = pi<double> * square(radius);
  return {4 * bending_stiffness / (area * square(radius)), radius, line_density / area};
}

// A straight beam from the origin along a direction. The segment before the origin is the clamp.
//
// A step turns the last segment by h^2 P / (m l) before the solver turns it back, and the forces that it finds are off by
// about as much. A load therefore sits on a weight; at rest its mass does not count.
struct Cantilever {
  RodMaterial wire;
  double length;
  int segments;
  V3 direction;
  double wall_share = 0.5;  // of a segment that the joint at the wall stands for; the rest is wall
  double tip_weight = 0.0;  // masses of the beam that each of the last two beads has more

  double segment() const { return length / segments; }
  // The time unit of bending, sqrt(rho A L^4 / EI): the first mode has omega = 3.516 in it.
  double unit() const {
    return square(length) * std::sqrt(wire.line_density() / wire.bending_stiffness());
  }
  template <class Body> Simulated<Body> build() const {
    RodAssembly<Body> rod;
    add_thread(rod, straight(-segment() * direction, length * direction, segments + 2), wire);
    rod.prescribe(0);
    rod.prescribe(1);
    for (auto b : {tip() - 1, tip()})
      rod.set_mass(b, 1 / rod.inverse_mass(b) + tip_weight * wire.line_density() * length);
    Simulated<Body> rig(rod);
    using Parameters = typename instance<Bend>::Parameters;
    auto k = rig.store.template get<Parameters>(0, 0);  // the first joint has the first colour
    k[1] = wire.bend_compliance(wall_share * segment());
    rig.store.template set<Parameters>(0, 0, k);
    return rig;
  }
  std::int64_t tip() const { return segments + 1; }
};

// A force [N] on a bead during the coming step of length h.
template <class AnyRig> void push(AnyRig& rig, std::int64_t b, V3 const& force, double h) {
  double const w = rig.store.template get<bead::InverseMass>(0, b);
  rig.store.template set<bead::Velocity>(0, b, rig.v(b) + h * w * force);
}
template <class AnyRig> void slow_down(AnyRig& rig, double factor) {
  for (std::int64_t b = 0; b < rig.beads(); ++b)
    if (rig.store.template get<bead::InverseMass>(0, b) > 0)
      rig.store.template set<bead::Velocity>(0, b, factor * rig.v(b));
  if constexpr (AnyRig::Store::template has<Frames>)
    for (std::int64_t f = 0; f < rig.store.template table<Frames>().live(0); ++f)
      if (rig.store.template get<frame::InverseInertia>(0, f) > 0)
        rig.store.template set<frame::AngularVelocity>(
            0, f, factor * rig.store.template get<frame::AngularVelocity>(0, f));
}

// Steps under load(rig, h) with a friction of `rate` [1/s] until no bead is faster than `least` [m/s];
// tells whether that was so within `most` steps.
template <class AnyRig, class Load>
bool settle(AnyRig& rig, double h, double rate, double least, int most, Load const& load,
            double g = 0.0) {
  for (int s = 0; s < most; ++s) {
    load(rig, h);
    rig.step(h, g);
    slow_down(rig, std::exp(-rate * h));
    if (s > 10 && rig.fastest() < least) return true;
  }
  return false;
}

}  // namespace rods
