// A4.1: an arc needle that turns about its own centre follows itself. In uniform gel it meets friction along
// itself and nothing else.
#pragma once

#include "physics/back_end.hpp"
#include "physics/needle_in_gel.hpp"

namespace test {

struct ArcCase {
  double radius = 5;          // of the arc [cells]
  double angle = pi<double>;  // tip to blunt end [rad]
  double speed = 0.1;         // along itself, of the gel's shear waves
  double pivot = 0;           // how far beside its centre it turns [cells]
};

// What the gel feels of the needle, as shares of all it feels along the needle.
struct ArcForces {
  double
      compression;  // sum of radial forces, outwards: what a needle does that does not follow itself
  double radial;    // sum of the sizes of radial forces: these may cancel
  double axial;     // the same out of the needle's plane
  double moment;    // about the arc's centre, of friction alone: 1
  double force;     // on the whole needle
  double along_chord;  // the same, of friction alone: 1
};

struct ArcInGel {
  using Run = Simulation<NeedleInGel<Friction>, BackEnd, double>;
  static constexpr double wire = 3e-4, friction = 0.2, pressure = 2e3;  // [m], [1], [Pa]

  ArcCase c;
  Arc<double> arc;
  Run run;

  explicit ArcInGel(ArcCase const& c_)
      : c(c_),
        arc{c.radius * gel_cell, c.angle, wire, 0.0},
        run(gel_scene<NeedleInGel<Friction>, double>(block(c), arc)) {
    run.set<Friction>({friction, pressure});
    double const middle = 0.5 * (block(c).low[0] + block(c).high[0]);
    place_needle(
        run, 0,
        {gel_cell * vec(middle + 0.13, middle - 0.21, 7.1), quaternion::identity<double>()});
  }
  static GelBlock block(ArcCase const& c) {
    GelBlock b;
    int const wide = static_cast<int>(2 * c.radius) + 6;
    b.high[0] = b.high[1] = b.low[0] + wide;
    b.high[2] = b.low[2] + 8;
    for (int a = 0; a < 3; ++a) b.held_high[a] = b.high[a];
    b.damping = 0.3 / gel_time();
    return b;
  }
  // Turns for as long as a point of it needs for so many cells.
  void turn(double cells) {
    double const step = 0.25 * gel_time();
    Vec3<double> const spin = vec(0.0, 0.0, c.speed * gel_shear_speed() / arc.radius);
    Vec3<double> const off = cross(spin, gel_cell * vec(-c.pivot, 0.0, 0.0));
    for (int n = static_cast<int>(std::lround(cells / (0.25 * c.speed))); n > 0; --n) {
      drive_needle(run, 0, off, spin);
      run.step(step);
    }
  }
  ArcForces forces() const {
    auto const& state = run.state();
    auto const pose =
        Pose<double>{state.get<needle::Position>(0, 0), state.get<needle::Orientation>(0, 0)};
    auto const points = ArcPoints<double>::over(arc, gel_cell);
    double const dt = state.get<environment::Dt>(0);
    ArcForces sum{};
    double along = 0;
    for (int i = 0; i < points.count(); ++i) {
      auto const f = quaternion::rotate_back(pose.orientation,
                                             (1 / dt) * state.get<contact::Impulse>(0, i + 1));
      auto const out = direction(arc.point(points.s(i)));
      sum.compression += dot(f, out);
      sum.radial += std::abs(dot(f, out));
      sum.axial += std::abs(f[2]);
      along += dot(f, arc.tangent(points.s(i)));
    }
    auto const force = state.get<needle::Force>(0, 0);
    double const per_length = friction * pressure * 2 * pi<double> * wire;
    auto const chord = quaternion::rotate(pose.orientation, arc.point(0) - arc.point(arc.length()));
    double const reach = dot(chord, chord) > 1e-6 * square(arc.radius) ? dot(chord, chord) : 0;
    return {sum.compression / along,
            sum.radial / along,
            sum.axial / along,
            -state.get<needle::Moment>(0, 0)[2] / (per_length * arc.length() * arc.radius),
            norm(force) / along,
            reach > 0 ? -dot(force, chord) / (per_length * reach) : 1};
  }
};

}  // namespace test
