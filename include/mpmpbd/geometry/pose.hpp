// Where a rigid body is and how it moves: position and orientation, linear and angular velocity.
#pragma once

#include <mpmpbd/geometry/quaternion.hpp>

namespace mpmpbd {

template <class T> struct Pose {
  Vec3<T> position;           // of the body's own origin [m]
  Quaternion<T> orientation;  // turns body axes into world axes

  static MPMPBD_HD constexpr Pose identity() { return {Vec3<T>{}, quaternion::identity<T>()}; }
};

template <class T> struct Twist {
  Vec3<T> linear;   // velocity of the body's own origin [m/s]
  Vec3<T> angular;  // [rad/s], world axes
};

template <class T> MPMPBD_HD constexpr Vec3<T> to_world(Pose<T> const& pose, Vec3<T> const& body) {
  return pose.position + quaternion::rotate(pose.orientation, body);
}
template <class T> MPMPBD_HD constexpr Vec3<T> to_body(Pose<T> const& pose, Vec3<T> const& world) {
  return quaternion::rotate_back(pose.orientation, world - pose.position);
}

template <class To, class T> MPMPBD_HD Pose<To> cast_pose(Pose<T> const& a) {
  return {cast<To>(a.position), quaternion::normalised(cast<To>(a.orientation))};
}

// The pose after dt of a constant twist: the origin goes straight, the body turns about it by
// exactly dt |omega|. A body that turns about its own origin therefore never leaves its circle.
template <class T> MPMPBD_HD Pose<T> moved(Pose<T> const& pose, Twist<T> const& twist, T dt) {
  auto const turn = quaternion::from_rotation_vector(dt * twist.angular);
  return {pose.position + dt * twist.linear,
          quaternion::normalised(quaternion::product(turn, pose.orientation))};
}

// The constant twist that takes one pose to the other in dt, by the shorter way round.
template <class T> MPMPBD_HD Twist<T> twist_between(Pose<T> const& from, Pose<T> const& to, T dt) {
  auto const turn = quaternion::product(to.orientation, quaternion::conjugate(from.orientation));
  return {T(1) / dt * (to.position - from.position), T(1) / dt * quaternion::rotation_vector(turn)};
}

// Velocity of the material point of the body that is at `world` now.
template <class T>
MPMPBD_HD constexpr Vec3<T> velocity_at(Pose<T> const& pose, Twist<T> const& twist,
                                        Vec3<T> const& world) {
  return twist.linear + cross(twist.angular, world - pose.position);
}

// The same, averaged over a substep dt that starts at this pose: x(t + dt) = x(t) + dt * mean
// velocity to rounding, so contact points leave no gap between substeps, however far the body
// turns. (Turning about n by a: x1 - x0 = 2 sin(a/2) n x r at half the turn.)
template <class T> struct Sweep {
  Vec3<T> origin;
  Vec3<T> linear;
  Vec3<T> angular;  // scaled by sinc(a / 2)
  Quaternion<T> half_turn;

  MPMPBD_HD static Sweep of(Pose<T> const& pose, Twist<T> const& twist, T dt) {
    T const half = T(0.5) * dt;
    return {pose.position, twist.linear,
            quaternion::sinc(half * norm(twist.angular)) * twist.angular,
            quaternion::from_rotation_vector(half * twist.angular)};
  }
  MPMPBD_HD Vec3<T> mean_velocity(Vec3<T> const& world) const {
    return linear + cross(angular, quaternion::rotate(half_turn, world - origin));
  }
};

}  // namespace mpmpbd
