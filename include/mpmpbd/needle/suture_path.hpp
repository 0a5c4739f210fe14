// The ideal way of an arc needle through tissue: in at one marker, round, out at the other.
//
// A needle that turns about its own centre follows itself and does not tear. The circle through
// both markers with the needle's radius has its centre above the surface, so the shorter arc is in
// tissue. (Reference system: markers at +-0.30 m, radius 0.32 m: centre 0.111 m above, 139 degrees,
// 0.209 m deep.)
#pragma once

#include <mpmpbd/geometry/arc.hpp>
#include <mpmpbd/needle/script.hpp>

namespace mpmpbd {

struct SuturePath {
  Vec3<double> entry, exit;  // marker positions [m]
  Vec3<double> centre;       // of the arc while it drives [m]
  Vec3<double> axis;         // unit; a positive turn leads from entry to exit
  Vec3<double> up;           // unit, across the line between the markers, out of the tissue
  double radius;             // [m]
  double height;             // of the centre above the line between the markers [m]
  double angle;              // in tissue [rad]
  double depth;              // of the deepest point below the line between the markers [m]

  static SuturePath between(Vec3<double> const& entry, Vec3<double> const& exit,
                            Vec3<double> const& outward, double radius) {
    Vec3<double> const chord = exit - entry;
    double const half = 0.5 * norm(chord);
    check_parameter("SuturePath", bound::positive("half the marker distance", "m"), half);
    check_parameter("SuturePath", {"needle radius", "m", half, bound::none, true, false}, radius);
    Vec3<double> const along = direction(chord);
    Vec3<double> const across = outward - dot(outward, along) * along;
    if (!(norm(across) > 1e-6 * norm(outward)))
      throw std::invalid_argument(
          "mpmpbd SuturePath: the outward direction is along the line between the markers; give the normal of the surface");
    SuturePath p{};
    p.entry = entry;
    p.exit = exit;
    p.up = direction(across);
    p.axis = cross(along, p.up);
    p.radius = radius;
    p.height = sqrt(max(radius * radius - half * half, 0.0));
    p.centre = 0.5 * (entry + exit) + p.height * p.up;
    p.angle = 2.0 * atan2(half, p.height);
    p.depth = radius - p.height;
    return p;
  }

  // The smallest shift of the centre after which the needle's circle goes through `marker` [m]: for
  // a marker that has moved with the tissue while the needle drives.
  MPMPBD_HD Vec3<double> offset_to(Vec3<double> const& marker) const {
    Vec3<double> const e = marker - centre;
    double const across = dot(e, axis);
    Vec3<double> const in_plane = e - across * axis;
    double const r = norm(in_plane);
    return across * axis + (r > 0.0 ? (r - radius) / r : 0.0) * in_plane;
  }

  // The pose in which the tip is `angle` past the entry marker (negative: before it).
  Pose<double> pose(double past_entry) const {
    auto const turn = quaternion::from_axis_angle(axis, past_entry);
    Vec3<double> const x = quaternion::rotate(turn, direction(entry - centre));
    return {centre, quaternion::from_axes(x, cross(axis, x), axis)};
  }
};

// How the scripted hand sews along a path.
struct SutureMotion {
  double approach = 0.35;   // the tip starts this far before the entry marker [rad]
  double out = 0.52;        // the tip has left the exit marker by this much when driving ends [rad]
  double clear = 0.17;      // the blunt end has left it by this much when the needle is free [rad]
  double drive_time = 6.0;  // [s]
  double pull_time = 4.0;   // turning the needle out and pulling the thread after it [s]
  Vec3<double> pull{};      // shift of the free needle, which pulls the thread [m]; may be zero
  double ramp = Script::default_ramp;
};

// Drive, turn out, pull. The pull time is shared so that both of its moves have the same mean
// speed.
inline Script suture_script(SuturePath const& path, Arc<double> const& arc,
                            SutureMotion const& how = {}) {
  check_arc(arc, "suture_script");
  double const pi_ = pi<double>;
  check_parameter("suture_script",
                  {"radius", "m", path.radius * (1.0 - 1e-6), path.radius * (1.0 + 1e-6)},
                  arc.radius);
  // Before the start neither end is in tissue: the whole needle fits into the free part of the
  // circle.
  double const room = 2.0 * pi_ - path.angle - arc.angle;
  check_parameter("suture_script",
                  {"free angle beside the needle", "rad", 0.0, bound::none, false, false}, room);
  check_parameter("suture_script", {"approach", "rad", 0.0, room, true, false}, how.approach);
  check_parameter("suture_script", {"clear", "rad", 0.0, room, true, false}, how.clear);
  check_parameter("suture_script", {"out", "rad", 0.0, arc.angle}, how.out);
  double const rest = arc.angle - how.out + how.clear;
  double const turned = rest * path.radius, pulled = norm(how.pull);
  Script script = Script::at(path.pose(-how.approach));
  script.turn(path.centre, path.axis, how.approach + path.angle + how.out, how.drive_time,
              how.ramp);
  double const share = turned / (turned + pulled);
  script.turn(path.centre, path.axis, rest, share * how.pull_time, how.ramp);
  if (pulled > 0.0) script.shift(how.pull, (1.0 - share) * how.pull_time, how.ramp);
  return script;
}

}  // namespace mpmpbd
