// A needle that tissue and thread can move: mass, inertia and the motion of six degrees of freedom.
//
// Free motion conserves linear and angular momentum to rounding and keeps the energy error bounded:
// the rotation is split into turns about the three principal axes, each solved exactly (McLachlan
// 1993; Dullweber, Leimkuhler, McLachlan, J. Chem. Phys. 107, 5840, 1997). The gyroscopic term is
// in it.
#pragma once

#include <mpmpbd/geometry/arc.hpp>
#include <mpmpbd/geometry/pose.hpp>

namespace mpmpbd {

template <class T> struct NeedleBody {
  T mass;                   // [kg]
  Vec3<T> centre;           // centre of mass, body axes, from the body's origin [m]
  Vec3<T> inertia;          // principal moments about the centre of mass [kg m^2]
  Quaternion<T> principal;  // turns principal axes into body axes

  // An arc of round wire (taper neglected). Closed form of the integrals over a piece of a torus.
  MPMPBD_HD static NeedleBody of(Arc<T> const& arc, T density) {
    double const r = double(arc.radius), angle = double(arc.angle),
                 a2 = square(double(arc.wire_radius));
    double const mean_cos = quaternion::sinc(0.5 * angle);  // about the arc's middle
    double const cos2 = 0.5 * (1.0 + quaternion::sinc(angle));
    double const sin2 = 0.5 * (1.0 - quaternion::sinc(angle));
    double const mass = double(density) * pi<double> * a2 * r * angle;
    double const arm = (r + 0.25 * a2 / r) * mean_cos;
    double const in_plane = r * r + 0.75 * a2;  // mean of rho^2
    double const s1 = in_plane * cos2, s2 = in_plane * sin2, s3 = 0.25 * a2;
    double const half = -0.5 * angle;
    NeedleBody b;
    b.mass = T(mass);
    b.centre = {{T(arm * cos(half)), T(arm * sin(half)), T(0)}};
    b.inertia = {
        {T(mass * (s2 + s3)), T(mass * (s1 + s3 - arm * arm)), T(mass * (s1 + s2 - arm * arm))}};
    b.principal = cast<T>(quaternion::from_axis_angle(vec(0.0, 0.0, 1.0), half));
    return b;
  }

  MPMPBD_HD Vec3<T> centre_of_mass(Pose<T> const& pose) const { return to_world(pose, centre); }
  MPMPBD_HD Vec3<T> arm(Pose<T> const& pose) const {
    return quaternion::rotate(pose.orientation, centre);
  }
  MPMPBD_HD Vec3<T> velocity_of_centre(Pose<T> const& pose, Twist<T> const& twist) const {
    return twist.linear + cross(twist.angular, arm(pose));
  }
  // I w and I^-1 L in world axes.
  MPMPBD_HD Vec3<T> times_inertia(Pose<T> const& pose, Vec3<T> const& w) const {
    Quaternion<T> const q = quaternion::product(pose.orientation, principal);
    Vec3<T> v = quaternion::rotate_back(q, w);
    for (int i = 0; i < 3; ++i) v[i] *= inertia[i];
    return quaternion::rotate(q, v);
  }
  MPMPBD_HD Vec3<T> divided_by_inertia(Pose<T> const& pose, Vec3<T> const& l) const {
    Quaternion<T> const q = quaternion::product(pose.orientation, principal);
    Vec3<T> v = quaternion::rotate_back(q, l);
    for (int i = 0; i < 3; ++i) v[i] /= inertia[i];
    return quaternion::rotate(q, v);
  }
  MPMPBD_HD Vec3<T> momentum(Pose<T> const& pose, Twist<T> const& twist) const {
    return mass * velocity_of_centre(pose, twist);
  }
  // About a point [kg m^2/s].
  MPMPBD_HD Vec3<T> angular_momentum(Pose<T> const& pose, Twist<T> const& twist,
                                     Vec3<T> const& about) const {
    return times_inertia(pose, twist.angular) +
           cross(centre_of_mass(pose) - about, momentum(pose, twist));
  }
  MPMPBD_HD T kinetic_energy(Pose<T> const& pose, Twist<T> const& twist) const {
    Vec3<T> const v = velocity_of_centre(pose, twist);
    return T(0.5) * (mass * dot(v, v) + dot(twist.angular, times_inertia(pose, twist.angular)));
  }

  // What a solve for a free body takes: velocity and spin about the centre of mass, inertia in
  // world axes.
  MPMPBD_HD Mat3<T> world_inertia(Pose<T> const& pose) const {
    Mat3<T> m{};
    for (int k = 0; k < 3; ++k) {
      Vec3<T> e{};
      e[k] = T(1);
      Vec3<T> const column = times_inertia(pose, e);
      for (int i = 0; i < 3; ++i) m(i, k) = column[i];
    }
    return m;
  }
  MPMPBD_HD Twist<T> twist_from_centre(Pose<T> const& pose, Vec3<T> const& velocity,
                                       Vec3<T> const& spin) const {
    return {velocity - cross(spin, arm(pose)), spin};
  }

  // The twist after an impulse [N s] at a world point and an angular impulse [N m s].
  MPMPBD_HD Twist<T> kicked(Pose<T> const& pose, Twist<T> const& twist, Vec3<T> const& impulse,
                            Vec3<T> const& at, Vec3<T> const& angular_impulse = {}) const {
    Vec3<T> const l = cross(at - centre_of_mass(pose), impulse) + angular_impulse;
    Vec3<T> const w = twist.angular + divided_by_inertia(pose, l);
    Vec3<T> const v = velocity_of_centre(pose, twist) + T(1) / mass * impulse;
    return twist_from_centre(pose, v, w);
  }

  // Velocity change of world point `at` per impulse at world point `by`: what a contact solve
  // inverts.
  MPMPBD_HD Mat3<T> mobility(Pose<T> const& pose, Vec3<T> const& at, Vec3<T> const& by) const {
    Vec3<T> const x = centre_of_mass(pose);
    Mat3<T> m{};
    for (int k = 0; k < 3; ++k) {
      Vec3<T> e{};
      e[k] = T(1);
      Vec3<T> const w = divided_by_inertia(pose, cross(by - x, e));
      Vec3<T> const v = T(1) / mass * e + cross(w, at - x);
      for (int i = 0; i < 3; ++i) m(i, k) = v[i];
    }
    return m;
  }

  // Free motion over dt; pose and twist are of the body's origin. Computed in double whatever T is:
  // in float the way from velocity to momentum and back loses an ulp per substep, always the same
  // way.
  MPMPBD_HD void advance(Pose<T>& pose, Twist<T>& twist, T dt) const {
    NeedleBody<double> const body{double(mass), cast<double>(centre), cast<double>(inertia),
                                  cast<double>(principal)};
    Pose<double> p{cast<double>(pose.position), cast<double>(pose.orientation)};
    Twist<double> w{cast<double>(twist.linear), cast<double>(twist.angular)};
    body.turn_and_shift(p, w, double(dt));
    pose = {cast<T>(p.position), cast<T>(p.orientation)};
    twist = {cast<T>(w.linear), cast<T>(w.angular)};
  }

  MPMPBD_HD void turn_and_shift(Pose<T>& pose, Twist<T>& twist, T dt) const {
    Vec3<T> const v = velocity_of_centre(pose, twist);
    Vec3<T> const x = centre_of_mass(pose) + dt * v;
    Quaternion<T> q = quaternion::product(pose.orientation, principal);
    Vec3<T> l = quaternion::rotate_back(q, twist.angular);
    for (int i = 0; i < 3; ++i) l[i] *= inertia[i];
    int const axis[5] = {0, 1, 2, 1, 0};
    for (int k = 0; k < 5; ++k) {
      Vec3<T> r{};
      r[axis[k]] = (k == 2 ? dt : T(0.5) * dt) * l[axis[k]] / inertia[axis[k]];
      Quaternion<T> const turn = quaternion::from_rotation_vector(r);
      q = quaternion::product(q, turn);
      l = quaternion::rotate_back(turn, l);
    }
    pose.orientation =
        quaternion::normalised(quaternion::product(q, quaternion::conjugate(principal)));
    for (int i = 0; i < 3; ++i) l[i] /= inertia[i];
    twist.angular = quaternion::rotate(q, l);
    pose.position = x - arm(pose);
    twist.linear = v - cross(twist.angular, arm(pose));
  }
};

}  // namespace mpmpbd
