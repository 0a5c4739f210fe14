// What the agent does: it holds the needle and moves it in the suturing plane.
#pragma once

#include <mpmpbd/needle/kinematic.hpp>
#include <mpmpbd/rl/task.hpp>

namespace mpmpbd::rl {

// The suturing plane of a SuturingConfig: x from entry to exit, z up. A positive turn drives the
// needle from entry to exit.
namespace plane {
template <class T> MPMPBD_HD constexpr Vec3<T> across() { return {{T(0), T(-1), T(0)}}; }
// Angle from a to b, seen along `across` [rad], in (-pi, pi].
template <class T> MPMPBD_HD T angle(Vec3<T> const& a, Vec3<T> const& b) {
  return atan2(a[0] * b[2] - a[2] * b[0], a[0] * b[0] + a[2] * b[2]);
}
// The needle's orientation when its tip is seen from the arc's centre at this angle from the x axis
// [rad].
template <class T> MPMPBD_HD Quaternion<T> orientation(T turn) {
  Vec3<T> const tip = vec(cos(turn), T(0), sin(turn));
  return quaternion::from_axes(tip, cross(across<T>(), tip), across<T>());
}
}  // namespace plane

// Three numbers: velocity of the needle's arc centre along x and z, and how fast it turns about
// that centre, as shares of the largest. The needle cannot jump: it gains speed at a bounded rate.
struct MoveNeedle {
  using Role = role::Action;
  static constexpr FixedString name = "MoveNeedle";
  static constexpr int size = 3;
  using Reads = needle::State;
  using Writes = needle::State;

  template <class T> struct Parameters {
    T speed;                 // [m/s]
    T turn_rate;             // [rad/s]
    T acceleration;          // [m/s^2]
    T angular_acceleration;  // [rad/s^2]
  };
  static constexpr ParameterInfo parameter_info[] = {
      bound::positive("speed", "m/s"), bound::positive("turn_rate", "rad/s"),
      bound::positive("acceleration", "m/s^2"), bound::positive("angular_acceleration", "rad/s^2")};

  template <class Env, class Ctx>
  MPMPBD_HD static void apply(Env const& env, Ctx const& context, float const* action, double h) {
    using T = typename Env::Scalar;
    auto const& k = context.template of<MoveNeedle>();
    Twist<T> const wanted{k.speed * vec(T(action[0]), T(0), T(action[1])),
                          k.turn_rate * T(action[2]) * plane::across<T>()};
    auto const& needles = env.template domain<Needles>();
    kinematic::begin_commanded(needles.view, needles.first, wanted, k.acceleration,
                               k.angular_acceleration, T(h));
  }
};

}  // namespace mpmpbd::rl
