// A straight rigid needle along z through a block of tissue that is clamped at its sides.
#pragma once

#include "physics/tissue_block.hpp"
#include "physics/units.hpp"

namespace test {

// All numbers in Units of the tissue.
struct NeedleCase {
  double x = 7.4, y = 7.6;     // where it passes
  double bottom = 3, top = 8;  // of the block, and of the needle
  double spacing = 0.5, dt = 0.15, damping = 0.05;
  double radius = 0.1, pressure = 0;
  int sweeps = 2;
  Units unit{};
};

template <class T, class Form> struct NeedleInBlock {
  NeedleCase c;
  Units const& u = c.unit;
  Rig<T, Form> rig{16, 16, 14, T(u.length)};
  Tissue<T> tissue;
  double time = 0;       // [units]
  Vec3<double> force{};  // on the needle, of the last substep [units]
  double rough = 0;      // sum of |lateral impulse| over |sum of them|

  explicit NeedleInBlock(NeedleCase const& c_) : c(c_) {
    fill_tissue();
    add_needle();
  }
  void fill_tissue() {
    tissue.measure_in(u, rig, c.dt, 2);
    tissue.damping = T(c.damping / u.time());
    tissue.fill(u.length * mpmpbd::vec(3.0, 3.0, c.bottom),
                u.length * mpmpbd::vec(12.0, 12.0, c.top), 0);
    tissue.fixed.assign(rig.mass.size(), 0);
    for (int k = 0, i = 0; k < 14; ++k)
      for (int b = 0; b < 16; ++b)
        for (int a = 0; a < 16; ++a, ++i)
          tissue.fixed[std::size_t(i)] = a <= 3 || a >= 12 || b <= 3 || b >= 12;
  }
  void add_needle() {
    int const n = static_cast<int>(std::lround((c.top - c.bottom) / c.spacing));
    std::vector<mpmpbd::ContactPoint<T>> points;
    for (int i = 0; i < n; ++i) {
      mpmpbd::ContactPoint<T> p{};
      double const length = (c.top - c.bottom) / n, z = c.bottom + (i + 0.5) * length;
      p.length = T(u.length * length);
      p.position = mpmpbd::cast<T>(u.length * mpmpbd::vec(c.x, c.y, z));
      p.axis = mpmpbd::vec(T(0), T(0), T(1));
      p.radius = T(u.length * c.radius);
      p.pressure = T(u.modulus * c.pressure);
      p.segment = -1;
      points.push_back(p);
    }
    rig.allocate(points);
    rig.needle.motion = Motion::kinematic;
  }
  // A friction coefficient with a clamp pressure, and a drag per length: both in Units.
  void rub(double coefficient, double clamp_pressure) {
    rig.friction = {T(coefficient), T(u.modulus * clamp_pressure)};
  }
  void drag(double coefficient) { rig.drag = {T(u.modulus * u.time() * coefficient)}; }

  // One substep at a needle velocity; the needle is endless along z, so only its sideways motion moves points.
  void step(Vec3<double> const& velocity) {
    meet(velocity);
    couple();
  }
  // The substep up to where tissue and needle exchange impulses, and from there on.
  void meet(Vec3<double> const& velocity) {
    rig.needle.velocity = mpmpbd::cast<T>(u.speed() * velocity);
    tissue.scatter(rig);
    mpmpbd::embed_points(mpmpbd::Solo{}, rig.view(), rig.nodes());
    for (auto& p : rig.points) p.contact = p.coverage >= T(0.25) ? Contact::member : Contact::off;
  }
  void couple() {
    exchange();
    move_on();
  }
  void exchange() {
    auto const x = rig.view();
    exchange_on_back_end(rig, x, c.sweeps);
    rig.previous_dt = rig.dt;
    auto const pull = mpmpbd::needle_wrench(x, rig.needle.centre).force;
    force = 1 / u.force() * mpmpbd::cast<double>(pull);
    double sizes = 0;
    for (auto const& p : rig.points)
      sizes += std::hypot(double(p.impulse[0]), double(p.impulse[1]));
    sizes /= double(rig.dt) * u.force();
    rough = sizes / std::max(std::hypot(force[0], force[1]), 1e-30);
  }
  void move_on() {
    tissue.gather(rig);
    for (auto& p : rig.points) {
      p.position[0] += rig.dt * rig.needle.velocity[0];
      p.position[1] += rig.dt * rig.needle.velocity[1];
    }
    time += c.dt;
  }
};

}  // namespace test
