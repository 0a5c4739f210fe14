// A scripted rigid motion: turns and shifts, one after the other, each with a smooth start and end.
//
// The pose is a function of time, never a sum of steps: after any number of substeps the needle is
// where the script says, to rounding. Times and poses are double whatever the scene's scalar,
// because the velocity of a substep is a small difference of large numbers.
#pragma once

#include <stdexcept>
#include <string>

#include <mpmpbd/core/parameters.hpp>
#include <mpmpbd/geometry/pose.hpp>

namespace mpmpbd {

// How far a motion is (0 to 1) after the share `tau` of its duration. Speed grows and falls like 3
// u^2 - 2 u^3 over the share `ramp` at both ends and is constant between: speed and acceleration
// are continuous, the peak speed is 1 / (1 - ramp) of the mean.
MPMPBD_HD inline double smooth_progress(double tau, double ramp) {
  if (!(tau > 0.0)) return 0.0;
  if (tau >= 1.0) return 1.0;
  bool const second_half = tau > 0.5;
  double const t = second_half ? 1.0 - tau : tau;
  double const u = t / ramp;
  double const area = t < ramp ? ramp * u * u * u * (1.0 - 0.5 * u) : t - 0.5 * ramp;
  double const progress = area / (1.0 - ramp);
  return second_half ? 1.0 - progress : progress;
}

struct Script {
  static constexpr int capacity = 8;
  static constexpr double default_ramp = 0.1;

  struct Move {
    double duration;     // [s]
    double ramp;         // share of the duration, (0, 0.5]
    Vec3<double> turn;   // rotation vector of the whole move [rad]; more than one turn is allowed
    Vec3<double> pivot;  // the world point that it turns about, at the move's start [m]
    Vec3<double> shift;  // of the pivot, over the whole move [m]
  };

  Pose<double> start;
  int count;
  Move moves[capacity];

  // A script that stays at a pose; moves are added to it.
  static Script at(Pose<double> const& pose) {
    Script s{};
    s.start = {pose.position, quaternion::checked("Script", pose.orientation)};
    check_vector("start position", "m", pose.position);
    return s;
  }
  // Turns by `angle` [rad] about an axis through `pivot`.
  Script& turn(Vec3<double> const& pivot, Vec3<double> const& axis, double angle, double duration,
               double ramp = default_ramp) {
    check_vector("axis", "1", axis);
    if (!(norm(axis) > 0.0))
      throw std::invalid_argument("mpmpbd Script: axis = (0, 0, 0) is not a direction; give one");
    return add({duration, ramp, angle * direction(axis), pivot, Vec3<double>{}});
  }
  Script& shift(Vec3<double> const& by, double duration, double ramp = default_ramp) {
    return add({duration, ramp, Vec3<double>{}, end().position, by});
  }
  Script& hold(double duration) { return shift(Vec3<double>{}, duration); }
  // To a pose, by the shorter way round; the body's origin goes straight.
  Script& go_to(Pose<double> const& pose, double duration, double ramp = default_ramp) {
    Pose<double> const from = end();
    auto const q = quaternion::checked("Script", pose.orientation);
    auto const turn_by = quaternion::rotation_vector(
        quaternion::product(q, quaternion::conjugate(from.orientation)));
    return add({duration, ramp, turn_by, from.position, pose.position - from.position});
  }
  Script& add(Move const& move) {
    if (count == capacity)
      throw std::out_of_range("mpmpbd Script: more than " + std::to_string(capacity) +
                              " moves; join some of them");
    check_parameter("Script", bound::positive("duration", "s"), move.duration);
    check_parameter("Script", {"ramp", "1", 0.0, 0.5, false, true}, move.ramp);
    check_vector("turn", "rad", move.turn);
    check_vector("pivot", "m", move.pivot);
    check_vector("shift", "m", move.shift);
    moves[count++] = move;
    return *this;
  }

  MPMPBD_HD double duration() const {
    double sum = 0.0;
    for (int i = 0; i < count; ++i) sum += moves[i].duration;
    return sum;
  }
  MPMPBD_HD Pose<double> end() const { return pose(duration()); }

  // Before 0 the start, after the last move its end.
  MPMPBD_HD Pose<double> pose(double time) const {
    Pose<double> p = start;
    for (int i = 0; i < count; ++i) {
      Move const& m = moves[i];
      double const share = time >= m.duration ? 1.0 : smooth_progress(time / m.duration, m.ramp);
      auto const q = quaternion::from_rotation_vector(share * m.turn);
      Vec3<double> const arm = p.position - m.pivot;
      p.position += share * m.shift + (quaternion::rotate(q, arm) - arm);
      p.orientation = quaternion::normalised(quaternion::product(q, p.orientation));
      if (!(time > m.duration)) break;
      time -= m.duration;
    }
    return p;
  }
  // The constant twist that takes the pose at t0 to the pose at t1 (half a turn at most).
  MPMPBD_HD Twist<double> twist(double t0, double t1) const {
    return twist_between(pose(t0), pose(t1), t1 - t0);
  }

 private:
  static void check_vector(char const* name, char const* unit, Vec3<double> const& v) {
    for (int a = 0; a < 3; ++a) check_parameter("Script", bound::any(name, unit), v[a]);
  }
};

// Commands from outside (a controller, an agent) may jump; the needle's speed may not. The twist
// after dt on the way to the wanted one, with bounded acceleration [m/s^2] and angular acceleration
// [rad/s^2].
template <class T>
MPMPBD_HD Twist<T> approach(Twist<T> const& now, Twist<T> const& wanted, T acceleration,
                            T angular_acceleration, T dt) {
  auto step = [dt](Vec3<T> const& from, Vec3<T> const& to, T rate) {
    Vec3<T> const d = to - from;
    T const length = norm(d);
    return length > rate * dt ? from + (rate * dt / length) * d : to;
  };
  return {step(now.linear, wanted.linear, acceleration),
          step(now.angular, wanted.angular, angular_acceleration)};
}

}  // namespace mpmpbd
