// A block of soft tissue for the coupling tests: explicit MLS-APIC with quadratic B-splines and a
// neo-Hookean solid, written out by hand so that these tests do not depend on the scene machinery.
//
// The tests that fill it speak of cell, density and shear modulus 1 and run in Units (units.hpp): for cells
// of 1 mm and mu = 3.6 kPa a time of 190 is 0.1 s and a force of 1 is 3.6 mN.
#pragma once

#include <functional>

#include "physics/exchange_on_back_end.hpp"
#include "physics/units.hpp"

namespace test {

template <class T> struct Tissue {
  struct Particle {
    Vec3<T> x, v;
    Mat3<T> C, F;
    T m, volume;
  };
  std::vector<Particle> particles;
  std::vector<char> fixed;                    // nodes held by a sticky wall
  T dx = 0, density = 0, mu = 0, lambda = 0;  // dx: the cell of its rig
  T dt = 0, damping = 0;

  // Takes cell, density and modulus of `u`, for itself and its rig; `step` in units of time, Lame's first
  // modulus in shear moduli.
  template <class R> void measure_in(Units const& u, R& rig, double step, double lame_first) {
    dx = T(u.length);
    density = rig.rest_density = T(u.density);
    mu = T(u.modulus);
    lambda = T(lame_first * u.modulus);
    dt = rig.dt = rig.previous_dt = T(step * u.time());
  }

  using Q = mpmpbd::QuadraticBSpline;
  static constexpr int width = 3;
  struct Near {
    int base[3];
    T w[3][3], d[3][3];
  };
  static Near near(Vec3<T> const& x) {  // in cells
    Near s;
    for (int a = 0; a < 3; ++a) {
      T const first = mpmpbd::floor(x[a] - T(0.5)), f = x[a] - first;
      s.base[a] = static_cast<int>(first);
      for (int i = 0; i < 3; ++i) {
        s.w[a][i] = Q::weight(i, f);
        s.d[a][i] = T(i) - f;
      }
    }
    return s;
  }
  template <class F> static void each_node(Near const& s, int nx, int ny, F const& f) {
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) {
        T const w = s.w[1][j] * s.w[2][k];
        auto const row =
            static_cast<std::size_t>(s.base[0] + nx * (s.base[1] + j + ny * (s.base[2] + k)));
        for (int i = 0; i < 3; ++i)
          f(row + static_cast<std::size_t>(i), w * s.w[0][i],
            mpmpbd::vec(s.d[0][i], s.d[1][j], s.d[2][k]));
      }
  }

  // Eight particles per cell, displaced by up to a quarter of their spacing times `jitter`.
  void fill(Vec3<double> low, Vec3<double> high, double jitter,
            std::function<bool(Vec3<double>)> const& inside = nullptr) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> U(-1, 1);
    double const spacing = 0.5 * double(dx);
    T const volume = T(0.125) * dx * dx * dx;
    for (double x = low[0] + 0.5 * spacing; x < high[0]; x += spacing)
      for (double y = low[1] + 0.5 * spacing; y < high[1]; y += spacing)
        for (double z = low[2] + 0.5 * spacing; z < high[2]; z += spacing) {
          Vec3<double> p = mpmpbd::vec(x, y, z);
          for (int a = 0; a < 3; ++a) p[a] += 0.5 * spacing * jitter * U(random);
          if (inside && !inside(p)) continue;
          particles.push_back(
              {mpmpbd::cast<T>(p), {}, {}, Mat3<T>::identity(), density * volume, volume});
        }
  }

  template <class R> void scatter(R& r) {
    if (fixed.empty()) fixed.assign(r.mass.size(), 0);
    std::fill(r.mass.begin(), r.mass.end(), T(0));
    std::fill(r.velocity.begin(), r.velocity.end(), Vec3<T>{});
    T const kept = 1 - damping * dt;
    for (auto const& p : particles) {
      T const log_J = mpmpbd::log(mpmpbd::determinant(p.F));
      Mat3<T> const tau =
          mu * (p.F * mpmpbd::transpose(p.F)) + (lambda * log_J - mu) * Mat3<T>::identity();
      // Of the momentum only: damped after the forces, an elastic reaction would be 1 - damping dt of itself,
      // and tissue that is loaded and let go would keep that share of its energy.
      Vec3<T> const mv = kept * p.m * p.v;
      Mat3<T> const A = (kept * p.m * dx) * p.C - (4 * dt * p.volume / dx) * tau;
      each_node(near(1 / dx * p.x), r.lattice.nodes[0], r.lattice.nodes[1],
                [&](std::size_t i, T w, Vec3<T> const& d) {
                  r.mass[i] += w * p.m;
                  r.velocity[i] += w * (mv + A * d);
                });
    }
    for (std::size_t i = 0; i < r.mass.size(); ++i) {
      T const inverse = r.mass[i] > 0 && !fixed[i] ? 1 / r.mass[i] : T(0);
      r.inverse_mass[i] = mpmpbd::vec(inverse, inverse, inverse);
      r.velocity[i] *= inverse;
    }
  }
  template <class R> void gather(R const& r) {
    T const slope = 4 / dx;
    for (auto& p : particles) {
      p.v = {};
      p.C = {};
      each_node(near(1 / dx * p.x), r.lattice.nodes[0], r.lattice.nodes[1],
                [&](std::size_t i, T w, Vec3<T> const& d) {
                  Vec3<T> const u = w * r.velocity[i];
                  p.v += u;
                  p.C += mpmpbd::outer(slope * u, d);
                });
      p.x += dt * p.v;
      p.F = p.F + dt * (p.C * p.F);
    }
  }
  // The tissue's velocity at a point of it: tracers follow the flow.
  template <class R> static Vec3<T> velocity_at(R const& r, Vec3<T> const& x) {
    Vec3<T> u{};
    each_node(near(r.lattice.inverse_dx * x), r.lattice.nodes[0], r.lattice.nodes[1],
              [&](std::size_t i, T w, Vec3<T> const&) { u += w * r.velocity[i]; });
    return u;
  }
  double energy() const {
    double e = 0;
    for (auto const& p : particles) {
      double const J = double(mpmpbd::determinant(p.F)), log_J = std::log(J);
      e += double(p.volume) * (0.5 * double(mu) * (double(mpmpbd::dot(p.F, p.F)) - 3) -
                               double(mu) * log_J + 0.5 * double(lambda) * log_J * log_J);
      e += 0.5 * double(p.m) *
           (double(mpmpbd::dot(p.v, p.v)) + 0.25 * double(dx * dx * mpmpbd::dot(p.C, p.C)));
    }
    return e;
  }
};

}  // namespace test
