// Threads with frames, brought to rest.
#pragma once

#include "pbd/framed.hpp"
#include "physics/rods_at_rest.hpp"

namespace rods {

// A wire of given EI, GJ [N m^2] and mass per length [kg/m], so thin that it neither stretches nor shears.
inline RodMaterial thin_wire(double bending_stiffness, double torsional_stiffness,
                             double line_density, double radius) {
  double const nu = 0.0, solid = torsional_stiffness * (1 + nu);  // EI of a solid wire of that GJ
  auto wire = thin_wire(solid, line_density, radius);
  wire.bending_share = bending_stiffness / solid;
  wire.poisson_ratio = nu;
  return wire;
}

// The joint between frames f and f + 1 stands for this part of the length that it was made with: half, at a wall.
template <class AnyRig> void keep_share(AnyRig& rig, std::int64_t f, double part) {
  using Joint = instance<BendTwist>;
  auto const joints = rig.store.template table<Instances<BendTwist>>().live(0);
  for (std::int64_t i = 0; i < joints; ++i) {
    if (rig.store.template get<typename Joint::FrameIndex>(0, i)[0] != f) continue;
    auto k = rig.store.template get<typename Joint::Parameters>(0, i);
    k[3] *= part, k[4] *= part;  // its compliances
    rig.store.template set<typename Joint::Parameters>(0, i, k);
  }
}

// Holds a segment that starts at bead b, with its frame f: a clamp.
template <class Body> void hold_segment(RodAssembly<Body>& rod, std::int64_t b, std::int64_t f) {
  rod.prescribe(b);
  rod.prescribe(b + 1);
  rod.prescribe_frame(f);
}

}  // namespace rods
