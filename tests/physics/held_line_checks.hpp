// How a held line is loaded and watched: the load grows until t = 40, vibrations are damped until t = 100,
// and the slip is watched from t = 190 on. 1900 units are one second of tissue of 1 mm cells and 3.6 kPa.
#pragma once

#include "catch.hpp"
#include "physics/held_line.hpp"

namespace test {

using Held = HeldLine<double, mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::Friction,
                                                   mpmpbd::NoDrag, false>>;

inline constexpr double settled = 190, second = 1900;

inline double ramp(double time) { return std::min(1.0, time / 40); }

// Friction keeps the line from sliding out along itself once it tilts.
inline Held held_thread(double mass) {
  Held h(0.2, true, 0.5);
  h.rig.friction = {0.2, 0};
  h.add_thread(6, mass, 1000);
  return h;
}
inline Held held_bar(double mass, double buried) {
  Held h(0.2, true, buried);
  h.rig.friction = {0.2, 0};
  h.add_bar(mass);
  return h;
}

struct Slip {
  double settled = 0,
         growth = -1;   // largest distance of tissue from the line [cells]; since settled
  double reaction = 0;  // along x, at the end
};

// Moves on for `span` after the line has settled.
template <class Load> Slip watch(Held& h, Load const& load, double span) {
  Slip s;
  for (long n = 0; h.before(settled + span); ++n) {
    h.tissue.damping = h.before(100) ? 0.1 / h.unit.time() : 0;
    REQUIRE(h.step(load) == 0u);
    if (n % 10 != 0) continue;
    if (h.before(settled))
      s.settled = h.slip();
    else
      s.growth = std::max(s.growth, h.slip() - s.settled);
  }
  for (auto const& p : h.rig.points)
    s.reaction += double(p.impulse[0]) / (double(h.rig.dt) * h.unit.force());
  return s;
}

// Sum of the sizes of the lateral impulses over the size of their sum.
inline double roughness(Held const& h) {
  double sizes = 0;
  Vec3<double> sum{};
  for (auto const& p : h.rig.points) {
    auto const lateral = p.impulse - mpmpbd::dot(p.axis, p.impulse) * p.axis;
    sizes += mpmpbd::norm(lateral);
    sum += lateral;
  }
  return sizes / mpmpbd::norm(sum);
}

}  // namespace test
