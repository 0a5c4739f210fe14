// A straight rigid needle along z through a block of tissue that is clamped at its sides.
#pragma once

#include "physics/tissue_block.hpp"

namespace test {

struct NeedleCase {
  double x = 7.4, y = 7.6;     // where it passes
  double bottom = 3, top = 8;  // of the block, and of the needle
  double spacing = 0.5, dt = 0.15, damping = 0.05;
  double radius = 0.1, pressure = 0;
  int sweeps = 2;
};

template <class T, class Form> struct NeedleInBlock {
  NeedleCase c;
  Rig<T, Form> rig{16, 16, 14};
  Tissue<T> tissue;
  double time = 0;
  Vec3<double> force{};  // on the needle, of the last substep
  double rough = 0;      // sum of |lateral impulse| over |sum of them|

  explicit NeedleInBlock(NeedleCase const& c_) : c(c_) {
    tissue.dt = rig.dt = rig.previous_dt = T(c.dt);
    tissue.damping = T(c.damping);
    tissue.fill(mpmpbd::vec(3.0, 3.0, c.bottom), mpmpbd::vec(12.0, 12.0, c.top), 0);
    tissue.fixed.assign(rig.mass.size(), 0);
    for (int k = 0, i = 0; k < 14; ++k)
      for (int b = 0; b < 16; ++b)
        for (int a = 0; a < 16; ++a, ++i)
          tissue.fixed[std::size_t(i)] = a <= 3 || a >= 12 || b <= 3 || b >= 12;
    int const n = static_cast<int>(std::lround((c.top - c.bottom) / c.spacing));
    std::vector<mpmpbd::ContactPoint<T>> points;
    for (int i = 0; i < n; ++i) {
      mpmpbd::ContactPoint<T> p{};
      p.length = T((c.top - c.bottom) / n);
      p.position = mpmpbd::vec(T(c.x), T(c.y), T(c.bottom) + (T(i) + T(0.5)) * p.length);
      p.axis = mpmpbd::vec(T(0), T(0), T(1));
      p.radius = T(c.radius);
      p.pressure = T(c.pressure);
      p.segment = -1;
      points.push_back(p);
    }
    rig.allocate(points);
    rig.needle.motion = Motion::kinematic;
  }
  // One substep at a needle velocity; the needle is endless along z, so only its sideways motion moves points.
  void step(Vec3<double> const& velocity) {
    rig.needle.velocity = mpmpbd::cast<T>(velocity);
    tissue.scatter(rig);
    auto const x = rig.view();
    mpmpbd::Solo const team;
    mpmpbd::embed_points(team, x, rig.nodes());
    for (auto& p : rig.points) p.contact = p.coverage >= T(0.25) ? Contact::member : Contact::off;
    mpmpbd::exchange(team, x, rig.nodes(), c.sweeps);
    rig.previous_dt = rig.dt;
    force = mpmpbd::cast<double>(mpmpbd::needle_wrench(x, rig.needle.centre).force);
    double sizes = 0;
    for (auto const& p : rig.points)
      sizes += std::hypot(double(p.impulse[0]), double(p.impulse[1]));
    rough = sizes / c.dt / std::max(std::hypot(force[0], force[1]), 1e-30);
    tissue.gather(rig);
    for (auto& p : rig.points) {
      p.position[0] += rig.dt * rig.needle.velocity[0];
      p.position[1] += rig.dt * rig.needle.velocity[1];
    }
    time += c.dt;
  }
};

}  // namespace test
