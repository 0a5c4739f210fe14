// Threads with frames, for tests.
#pragma once

#include "pbd/rig.hpp"

#include <mpmpbd/pbd/solvers/direct_frames.hpp>

namespace rods {

using Cosserat = Constraints<StretchShear, BendTwist>;
using Frame = Quaternion<double>;

// What a joint between two frames measures: bend_1, bend_2, twist [rad], for a rest without any.
inline Evaluation<BendTwist, double> joint(Frame const& a, Frame const& b) {
  ValuesOf<BendTwist, double> x;
  get<0>(x) = a, get<1>(x) = b;
  return BendTwist::evaluate(x, BendTwist::Parameters<double>{});
}

template <class AnyRig> Frame frame_at(AnyRig const& rig, std::int64_t f) {
  return cast<double>(rig.store.template get<frame::Orientation>(0, f));
}
template <class AnyRig> std::int64_t frames_of(AnyRig const& rig) {
  return rig.store.template table<Frames>().live(0);
}
// The twist of all joints of a thread together [rad].
template <class AnyRig> double total_twist(AnyRig const& rig) {
  double sum = 0;
  for (std::int64_t f = 1; f < frames_of(rig); ++f)
    sum += joint(frame_at(rig, f - 1), frame_at(rig, f)).value[2];
  return sum;
}

// A moment [N m], in world axes, on a frame during the coming step of length h.
template <class AnyRig> void twist(AnyRig& rig, std::int64_t f, V3 const& moment, double h) {
  double const w = rig.store.template get<frame::InverseInertia>(0, f);
  rig.store.template set<frame::AngularVelocity>(
      0, f, rig.store.template get<frame::AngularVelocity>(0, f) + h * w * moment);
}

// Frames turned about their own d3, each by a little more than the one before, `turns` [rad] in all.
inline std::vector<Frame> twisted(std::vector<Frame> frames, double turns) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    double const angle = turns * double(i) / double(frames.size() - 1);
    frames[i] =
        quaternion::product(frames[i], quaternion::from_axis_angle(vec(0.0, 0.0, 1.0), angle));
  }
  return frames;
}

}  // namespace rods
