// A limp thread round half a turn or a full one in gel, 16 segments to an angle of pi, drawn out at one end.
#pragma once

#include "physics/back_end.hpp"
#include "physics/drawn_thread.hpp"

namespace test {

inline constexpr double wound_radius = 4, drawn_way = 4;  // [cells]

inline DrawnCase wound(double friction) {
  DrawnCase c;
  c.segment = wound_radius * pi<double> / 16;
  c.friction = friction;
  c.tension = 4;
  c.track.radius = wound_radius;
  c.track.outside = drawn_way + 2;
  return c;
}
// It leaves by the face where it enters.
inline DrawnCase half_turn(double friction) {
  DrawnCase c = wound(friction);
  c.block = {.high = {12, 15, 8}, .held_low = {-99, 3, 3}, .held_high = {12, 15, 8}};
  c.track.entry = vec(3.0, 13.13, 5.59);
  c.track.leg = 3;
  c.track.turn = pi<double>;
  return c;
}
// It leaves by the opposite face. Where its tension has grown almost sevenfold the gel is stretched: steps are shorter.
inline DrawnCase full_turn(double friction) {
  DrawnCase c = wound(friction);
  c.block = {.high = {15, 15, 10}, .held_low = {-99, 3, 3}, .held_high = {99, 15, 10}};
  c.track.entry = vec(3.0, 13.13, 5.09);
  if (friction < 0.15) c.tension = 6;  // against what the thread wobbles by
  c.step = 0.2;
  c.track.leg = 6;
  c.track.turn = 2 * pi<double>;
  c.track.climb = 2.83;
  return c;
}

struct Wound {
  double ratio = 0;  // of the tensions, mean over the last segment of the way
  double track = 0,
         angle = 0;  // by which the thread turns in all: at the start, and meanwhile [rad]
  std::uint32_t status = 0;
};

template <class Thread> double turning(Thread const& t) {
  double sum = 0;
  for (int k = 1; k + 1 < t.beads; ++k) sum += t.joint(k);
  return sum;
}

template <class T = double, class Backend = BackEnd>
Wound draw_round(DrawnCase const& c, double speed, Backend where = {}) {
  DrawnThread<Limp, Backend, T> t(c, where);
  Wound w{.track = turning(t)};
  t.settle();
  double pulled = 0, held = 0;
  int n = 0;
  while (t.moved < drawn_way) {
    t.step(speed);
    if (t.moved < drawn_way - c.segment) continue;
    pulled += t.pulled();
    held += t.held();
    w.angle += turning(t);
    ++n;
  }
  w.ratio = pulled / held;
  w.angle /= n;
  w.status = t.run.status(0);
  return w;
}

}  // namespace test
