// A straight needle is pushed into gel along its own axis and drawn out again.
#pragma once

#include <algorithm>
#include <utility>

#include "physics/back_end.hpp"
#include "physics/needle_in_gel.hpp"

namespace test {

// How a needle goes in and out.
struct Way {
  double deepest = 8;   // [cells]
  double speed = 0.05;  // of shear waves
  double per_cell = 1;  // friction and drag, of 0.05 and 4 N s/m^2
  double friction() const { return 0.05 * per_cell; }
  double drag() const { return 4.0 * per_cell; }
};
// A straight line through (depth, force).
struct Line {
  double n = 0, z = 0, f = 0, zz = 0, zf = 0;
  void add(double depth, double force) {
    n += 1, z += depth, f += force, zz += depth * depth, zf += depth * force;
  }
  double slope() const { return (zf - z * f / n) / (zz - z * z / n); }
  double offset() const { return f / n - slope() * z / n; }
};

template <class Backend = BackEnd, class T = double> struct Stroke {
  using Run = Simulation<NeedleInGel<Friction, Drag>, Backend, T>;
  static constexpr double clear = 1, wire = 3e-4, pressure = 4e3;  // [cells], [m], [Pa]
  // A cycle costs as much as if the needle went in so far beyond its depth. In cycles 5 cells deep it was 0.40 to 0.42
  // cells at half to twice the speed, and 0.35 in cells of half the size; compliant contact begins at 0.468.
  static constexpr double beyond = 0.41;  // [cells]
  Way way;
  Arc<double> arc;
  Run run;
  double depth = -clear;  // [cells]
  double work = 0;        // of both ways [J]
  double touched = 1e9;   // the depth at which the needle first felt anything [cells]
  Line in, out;           // [cells], [N]

  GelBlock block() const {
    GelBlock b;
    b.high[0] = b.high[1] = 11;
    b.high[2] = b.low[2] + static_cast<int>(way.deepest) + 3;
    b.held_high[0] = b.held_high[1] = 11;
    b.held_high[2] = 100;  // free above
    b.damping = 0.3 / gel_time();
    return b;
  }
  explicit Stroke(Way const& way_, Backend where = {})
      : way(way_),
        arc(straight_needle(gel_cell * (way.deepest + 4), wire)),
        run(gel_scene<NeedleInGel<Friction, Drag>, T>(block(), arc, where)) {
    run.template set<Friction>({way.friction(), pressure});
    run.template set<Drag>({way.drag()});
    auto const tip = gel_cell * vec(7.13, 6.79, block().high[2] + clear);
    place_needle(run, 0, straight_pose(arc, tip, vec(0.0, 0.0, -1.0), vec(1.0, 0.0, 0.0)));
  }
  double velocity() const { return way.speed * gel_shear_speed(); }
  double per_length() const {
    return way.friction() * pressure * 2 * pi<double> * wire + way.drag() * velocity();
  }
  double slope() const { return per_length() * gel_cell; }  // [N] per cell of depth
  // Of a cycle in and out: slope (depth + beyond)^2 [J].
  double cycle() const { return slope() * gel_cell * square(way.deepest + beyond); }
  // Down (+1) or up (-1) until the needle is at a depth.
  void move_to(double target, double sign, Line& line) {
    double const step = 0.25 * gel_time();
    for (; sign * (target - depth) > 1e-9; depth += sign * 0.25 * way.speed) {
      drive_needle(run, 0, vec(0.0, 0.0, -sign * velocity()), {});
      run.step(step);
      double const force = double(std::as_const(run).state().template get<needle::Force>(0, 0)[2]);
      if (force != 0 && touched > way.deepest) touched = depth;
      work += sign * force * velocity() * step;
      // Not where the first point enters, nor where the direction has just changed.
      if (depth > 1 && depth < way.deepest - 1) line.add(depth, sign * force);
    }
  }
  Vec3<double> particle(std::int64_t i) const {
    return cast<double>(run.state().template get<particle::Position>(0, i));
  }
  // The farthest that a particle is from where it began [cells], after a rest.
  double displacement() {
    drive_needle(run, 0, {}, {});
    for (int i = 0; i < 20; ++i) run.step(gel_time());
    auto const start = block().positions();
    double worst = 0;
    for (std::size_t i = 0; i < start.size(); ++i)
      worst = std::max(worst, norm(particle(std::int64_t(i)) - start[i]));
    return worst / gel_cell;
  }
};

}  // namespace test
