// A straight thread or rigid bar along z in a block of tissue of 6 cells a side that is clamped at four of
// them or free. All numbers that go in and come out are in Units.
#pragma once

#include <mpmpbd/geometry/polyline.hpp>
#include <mpmpbd/geometry/pose.hpp>

#include "physics/tissue_block.hpp"
#include "physics/units.hpp"

namespace test {

template <class T, class Form> struct HeldLine {
  // A functor, for a lambda of the host cannot be handed to a function that a kernel may call too.
  struct Vertices {
    Vec3<T> const* of;
    MPMPBD_HD Vec3<T> operator()(std::int64_t i) const { return of[i]; }
  };

  static constexpr double low = 3, high = 9;  // of the block, in cells
  static constexpr double x = 6.2, y = 5.7;   // of the line

  Units unit;
  Rig<T, Form> rig{12, 12, 12, T(unit.length)};
  Tissue<T> tissue;
  std::vector<Vec3<T>> tracer;  // tissue points where the line held the tissue first
  double time = 0, bottom, top;

  // A function, for nvcc takes `.time <` in the head of a loop for the begin of a template's arguments.
  bool before(double end) const { return time < end; }

  // `buried`: how deep the line ends in the tissue.
  HeldLine(double dt, bool clamped, double buried, Units const& u = {})
      : unit(u), bottom(low + buried), top(high - buried) {
    tissue.measure_in(unit, rig, dt, 2);
    auto const corner = [&](double a) { return unit.length * mpmpbd::vec(a, a, a); };
    tissue.fill(corner(low), corner(high), 0.4);
    tissue.fixed.assign(rig.mass.size(), 0);
    auto const outside = [](int a) { return a <= low || a >= high; };
    for (int k = 0, i = 0; k < 12; ++k)
      for (int b = 0; b < 12; ++b)
        for (int a = 0; a < 12; ++a, ++i)
          tissue.fixed[std::size_t(i)] = clamped && (outside(a) || outside(b));
  }
  Vec3<T> place(double z) const { return mpmpbd::cast<T>(unit.length * mpmpbd::vec(x, y, z)); }
  // Segments of equal length; the mass is that of a bead, EA in units of force.
  void add_thread(int segments, double mass, double stretch_stiffness) {
    for (int k = 0; k <= segments; ++k)
      rig.add_bead(place(bottom + (top - bottom) * k / segments), T(mass * unit.mass()));
    rig.stretch_compliance = T(1 / (stretch_stiffness * unit.force()));
    rig.allocate();
    mark();
  }
  // A bar with a point every half cell; the mass is that of a cell of its length.
  void add_bar(double mass) {
    auto const n = std::size_t(2 * (top - bottom));
    std::vector<mpmpbd::ContactPoint<T>> points(n);
    for (std::size_t i = 0; i < n; ++i) {
      points[i].position = place(bottom + 0.5 * double(i) + 0.25);
      points[i].axis = mpmpbd::vec(T(0), T(0), T(1));
      points[i].length = T(0.5 * unit.length);
      points[i].segment = -1;
      points[i].contact = Contact::member;
    }
    auto& bar = rig.needle;
    double const length = (top - bottom) * unit.length;
    bar.motion = Motion::dynamic;
    bar.centre = place((bottom + top) / 2);
    bar.mass = T(mass * (top - bottom) * unit.mass());
    bar.inertia = bar.mass * T(length * length / 12) * Mat3<T>::identity();
    rig.allocate(points);
    mark();
  }
  void mark() {
    for (int i = 0; i < 40; ++i) tracer.push_back(place(bottom + (top - bottom) * (i + 0.5) / 40));
  }

  std::vector<Vec3<T>> line() const {
    if (rig.beads() > 0) return rig.bead;
    auto const& first = rig.points.front();
    auto const& last = rig.points.back();
    return {first.position - T(0.5) * first.length * first.axis,
            last.position + T(0.5) * last.length * last.axis};
  }
  // Largest distance of the marked tissue from the line [cells].
  double slip() const {
    auto const now = line();
    Vertices const vertices{now.data()};
    double most = 0;
    for (auto const& p : tracer) {
      auto const nearest = mpmpbd::nearest_on_polyline(vertices, std::int64_t(now.size()), p);
      most = std::max(most, double(nearest.distance));
    }
    return most / unit.length;
  }
  // Adds a force to a bead, or to the bar's centre.
  void push(std::size_t bead, Vec3<double> const& force) {
    auto const impulse = mpmpbd::cast<T>(unit.force() * double(rig.dt) * force);
    if (rig.beads() > 0)
      rig.bead_velocity[bead] += T(1) / rig.bead_mass[bead] * impulse;
    else
      rig.needle.velocity += T(1) / rig.needle.mass * impulse;
  }

  template <class Load, class Couple> std::uint32_t step(Load const& load, Couple const& couple) {
    tissue.scatter(rig);
    for (auto& v : rig.bead_velocity) v *= 1 - tissue.damping * rig.dt;  // as the tissue's
    load();
    auto const faults = couple();
    for (auto& p : tracer) p += rig.dt * Tissue<T>::velocity_at(rig, p);
    tissue.gather(rig);
    if (rig.needle.motion == Motion::dynamic) move_bar();
    time += double(rig.dt) / unit.time();
    return faults;
  }
  template <class Load> std::uint32_t step(Load const& load) {
    return step(load, [&] { return couple_on_back_end(rig); });
  }
  void move_bar() {
    auto& bar = rig.needle;
    mpmpbd::Pose<T> const before{bar.centre, mpmpbd::quaternion::identity<T>()};
    auto const after = mpmpbd::moved(before, {bar.velocity, bar.spin}, rig.dt);
    for (auto& p : rig.points) {
      p.position = mpmpbd::to_world(after, mpmpbd::to_body(before, p.position));
      p.axis = mpmpbd::direction(mpmpbd::quaternion::rotate(after.orientation, p.axis));
    }
    bar.centre = after.position;
  }
};

}  // namespace test
