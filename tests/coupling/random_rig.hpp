// Random states of grid, thread and needle for the laws of the exchange.
#pragma once

#include "coupling/rig.hpp"
#include "physics/units.hpp"

namespace test {

using mpmpbd::vec;

struct Draw {
  std::mt19937 random{1};
  std::normal_distribution<double> normal{};
  std::uniform_real_distribution<double> unit{0, 1};
  explicit Draw(unsigned seed = 1) : random(seed) {}
  double uniform() { return unit(random); }
  double log_uniform(double a, double b) { return a * std::pow(b / a, uniform()); }
  template <class T> Vec3<T> arrow() {
    return vec(T(normal(random)), T(normal(random)), T(normal(random)));
  }
};

struct Extras {
  bool needle = false, swage = false, one_sided = false, walls = false, kinematic = false;
  bool surface = false;  // the tissue ends at half height instead of having holes
  bool tension = true;   // carried tensions and impulses
};

// Masses over five decades around a thread of random shape, with random speeds, stretch, carried impulses
// and tensions, holes in the tissue and (on request) a needle, a tip, surface points and walls. The numbers
// are in Units of the tissue.
template <class T, class Form> Rig<T, Form> random_rig(Draw& d, Extras const& extra = {}) {
  Units const u{};
  T const cell = T(u.length), mass = T(u.mass()), speed = T(u.speed()),
          inertia = mass * cell * cell, impulse = T(u.impulse());
  Rig<T, Form> r(12, 12, 12, cell);
  r.dt = r.previous_dt = T(0.1 * u.time());
  r.rest_density = T(0.4 * u.density);  // some points are held firmly, some hardly
  // Float: a light free bead that bends stiffly loses its mass in rounding (dt^2 EI / l^3 m > 1e4).
  double const lightest = Form::bends && sizeof(T) == 4 ? 1e-1 : 1e-4;
  double const ratio = d.log_uniform(lightest, 1e4), hole = d.uniform() * 0.4;
  for (std::size_t i = 0; i < r.mass.size(); ++i) {
    bool const below = static_cast<int>(i) / 144 < 6;
    if (extra.surface ? !below : d.uniform() < hole) continue;
    r.mass[i] = mass * T(d.log_uniform(0.05, 1));
    r.inverse_mass[i] = T(1) / r.mass[i] * vec(T(1), T(1), T(1));
    r.velocity[i] = T(0.1) * speed * d.arrow<T>();
    double const wall = d.uniform();
    if (extra.walls && wall < 0.2) r.inverse_mass[i][static_cast<int>(wall * 15)] = 0;
    if (extra.walls && wall > 0.9) r.inverse_mass[i] = {};
    for (int a = 0; a < 3; ++a)
      if (r.inverse_mass[i][a] == 0) r.velocity[i][a] = 0;
  }
  Vec3<T> x = vec(T(3), T(3), T(3)) + T(0.5) * d.arrow<T>(),
          heading = mpmpbd::direction(vec(T(1), T(1), T(1)));
  int const beads = 6 + static_cast<int>(d.uniform() * 3);
  for (int k = 0; k < beads; ++k) {
    r.add_bead(cell * x, mass * T(ratio * (0.5 + d.uniform())));
    heading = mpmpbd::direction(heading + T(0.3) * d.arrow<T>());
    x += T(0.4 + 0.6 * d.uniform()) * heading;
    for (int a = 0; a < 3; ++a) x[a] = mpmpbd::clamp(x[a], T(2), T(9));
  }
  for (std::size_t k = 0; k < r.bead.size(); ++k) {
    r.bead_velocity[k] = T(0.1) * speed * d.arrow<T>();
    if (k + 1 < r.bead.size()) r.rest_length[k] *= T(1 + 0.02 * d.normal(d.random));
    r.impulse[k] = impulse * T(!extra.tension || d.uniform() < 0.5 ? 0 : d.log_uniform(1e-3, 1));
    r.rest_angle[k] = T(d.uniform() < 0.5 ? 0 : d.uniform());
  }
  r.stretch_compliance = d.uniform() < 0.2 ? T(0) : T(d.log_uniform(1e-5, 1e-1) / u.force());
  r.bending_stiffness = T(d.log_uniform(1e-2, 1e2) * u.energy() * u.length);
  if constexpr (Form::FrictionLaw::grips)
    r.friction = {T(d.log_uniform(0.01, 3)), T(d.log_uniform(1e-3, 1) * u.modulus)};
  if constexpr (Form::DragLaw::drags) r.drag = {T(d.log_uniform(1e-2, 1e2) * u.modulus * u.time())};

  std::vector<mpmpbd::ContactPoint<T>> needle;
  if (extra.needle) {
    r.needle.motion = extra.kinematic ? Motion::kinematic : Motion::dynamic;
    r.needle.swaged = extra.swage && !extra.kinematic;
    r.needle.centre = cell * vec(T(6), T(6), T(6));
    r.needle.mass = mass * T(ratio * 3);
    r.needle.inertia = inertia * T(ratio) * Mat3<T>::identity();
    r.needle.velocity = extra.kinematic ? Vec3<T>{} : T(0.1) * speed * d.arrow<T>();
    r.needle.spin = extra.kinematic ? Vec3<T>{} : T(0.1) * speed / cell * d.arrow<T>();
    for (int i = 0; i < 8; ++i) {
      double const phi = 0.3 * i;
      mpmpbd::ContactPoint<T> p{};
      p.position =
          r.needle.centre + cell * vec(T(2.5 * std::cos(phi)), T(2.5 * std::sin(phi)), T(0.4));
      p.axis = vec(T(-std::sin(phi)), T(std::cos(phi)), T(0));
      p.length = T(0.75) * cell;
      p.radius = T(0.1) * cell;
      p.segment = -1;
      p.contact = Contact::member;
      if (extra.tension) p.impulse = T(0.05) * impulse * d.arrow<T>();
      needle.push_back(p);
    }
    if (extra.one_sided) {
      needle.back().contact = Contact::tip;
      needle.back().force_cap = T(d.log_uniform(1e-2, 10) * u.force());
    }
  }
  r.allocate(needle);
  for (auto& p : r.points) {
    p.radius = T(0.1) * cell;
    p.pressure = T(0.3 * d.normal(d.random) * u.modulus);
    if (p.segment >= 0)
      p.impulse =
          !extra.tension || d.uniform() < 0.3 ? Vec3<T>{} : T(0.05) * impulse * d.arrow<T>();
    if (extra.one_sided && p.contact != Contact::tip && d.uniform() < 0.4)
      p.contact = Contact::surface;
  }
  return r;
}

// A grid full of tissue at rest.
template <class Form> Rig<double, Form> full_rig(Units const& unit, int n) {
  Rig<double, Form> r(n, n, n, unit.length);
  r.dt = r.previous_dt = 0.1 * unit.time();
  r.rest_density = unit.density;
  std::fill(r.mass.begin(), r.mass.end(), unit.mass());
  std::fill(r.inverse_mass.begin(), r.inverse_mass.end(), 1 / unit.mass() * vec(1.0, 1.0, 1.0));
  return r;
}

}  // namespace test
