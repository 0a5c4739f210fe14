// B33: a suture that is drawn to and fro through gel, ten millimetres a stroke.
#pragma once

#include "catch.hpp"
#include "physics/drawn_thread.hpp"

namespace test {

// What a stroke there and back has cost, and where the gel is after it.
struct Stroke {
  double loop = 0;  // work of the moved end beyond that of the load, in units of force times cells
  double friction = 0;  // half of the difference between drawing out and letting in
  double follows = 0;   // half of the way that the gel goes with it [cells]
  Vec3<double> middle{};
};

struct SawnThread {
  static constexpr double half = 2.5, speed = 0.1;  // stroke / 2 [cells], and in shear waves
  DrawnThread<Stiff> thread;
  double most_heat = 0, lost = 0;  // work that is not stored, and its largest fall below that [J]

  explicit SawnThread(DrawnCase const& c) : thread(c) {
    thread.settle();
    while (thread.moved > -half + 1e-9) thread.step(-speed);
    most_heat = thread.work - thread.energy();
  }
  Stroke stroke() {
    Stroke r;
    double low = 1e300, high = -1e300, out = 0, in = 0;
    long const steps = std::lround(2 * half / (speed * thread.c.step));
    for (double const v : {speed, -speed})
      for (long n = 0; n < steps; ++n) {
        thread.step(v);
        r.loop += (thread.pulled() - thread.c.tension) * v * thread.c.step;
        if (2 * n >= steps) (v > 0 ? out : in) += thread.pulled() / double(steps - steps / 2);
        low = std::min(low, thread.followed());
        high = std::max(high, thread.followed());
        if (n % 20 == 0) weigh();
      }
    r.friction = (out - in) / 2;
    r.follows = (high - low) / 2;
    r.middle = thread.middle();
    return r;
  }
  void weigh() {
    double const heat = thread.work - thread.energy();
    most_heat = std::max(most_heat, heat);
    lost = std::max(lost, most_heat - heat);
  }
};

// The loop is that of friction F over what is left of the half stroke A when the gel follows by delta: 4 F (A - delta).
inline void check_loop(Stroke const& s) {
  double const expected = 4 * s.friction * (SawnThread::half - s.follows);
  CAPTURE(s.loop / expected, s.friction, s.follows);
  CHECK(std::abs(s.loop / expected - 1) < 0.1);
}

// Once it has settled the gel drifts by less than 0.02 cells in ten strokes, and friction only costs: all work of a
// stroke but what symplectic Euler does not keep of the swings. `friction`, if known, is asked of every stroke.
inline void saw(DrawnCase const& c, int strokes, int settling, double friction = 0) {
  SawnThread s(c);
  int const block = settling / 2;
  Vec3<double> before{};
  double drift = 0;
  for (int i = 1; i <= strokes; ++i) {
    double const heat = s.most_heat;
    auto const stroke = s.stroke();
    double const work = stroke.loop * s.thread.force() * gel_cell;
    CAPTURE(i, stroke.friction, (s.most_heat - heat) / work, s.lost / work);
    check_loop(stroke);
    if (friction > 0) CHECK(std::abs(stroke.friction / friction - 1) < 0.05);
    CHECK(s.lost < 1e-2 * work);
    if (i > settling) CHECK(std::abs((s.most_heat - heat) / work - 1) < 0.05);
    if (i % block != 0) continue;
    if (i > settling) drift = std::max(drift, norm(stroke.middle - before) * 10 / block);
    before = stroke.middle;
  }
  CAPTURE(drift);
  CHECK(drift < 0.02);
  CHECK(s.thread.run.status(0) == 0);
}

// A monofilament of size 3-0. What grips it is the pressure of its channel.
inline DrawnCase straight_saw() {
  DrawnCase c = straight_track();
  c.thread.bending_share = 1;
  c.tension = 2;
  c.clamp = 0.5;
  return c;
}
// mu p 2 pi r over the gel and the 0.47 cells before each face where it takes hold, in units of force.
inline double clamp_friction(DrawnCase const& c) {
  return c.friction * c.clamp * 2 * pi<double> * c.thread.radius / gel_cell *
         (c.track.embedded() + 0.94);
}
// Round a right angle nothing but its own tension presses it on the gel. Steps are shorter, as that is stretched there.
// A bend of two cells is too narrow for a hundred strokes: then the gel drifts by up to 0.035 cells in ten of them.
inline DrawnCase bent_saw() {
  DrawnCase c = right_angle();
  c.thread.bending_share = 1;
  c.tension = 4;
  c.step = 0.2;
  return c;
}

}  // namespace test
