// Two elastic discs meet and part (Sulsky, Chen and Schreyer 1994; A2.7), in plane strain.
#pragma once

#include <algorithm>
#include <cmath>

#include <mpmpbd/scene/totals.hpp>

#include "physics/plane_strain.hpp"

namespace test {

struct DiscOutcome {
  double start;    // kinetic energy per depth at the start [J/m]
  double kinetic;  // at the end, over that of the start
  double least;    // kinetic energy on the way
  double when;     // at that time [s]
  double most;  // of kinetic and strain energy on the way, affine motion within particles included
  double momentum;  // at the end, over the sum of m |v| at the start
  double rounding;  // that it may have on this back end
  std::uint32_t status;
};

template <class Body> class Discs {
 public:
  static constexpr double young = 1e3, poisson = 0.3, density = 1e3;  // [Pa] [1] [kg/m^3]
  static constexpr double radius = 0.2, speed = 0.1;                  // [m], [m/s] along each axis
  static constexpr double dt = 1e-3, duration = 3.5;                  // [s]
  static constexpr int margin = 4;  // cells around the unit square

  explicit Discs(int cells) : dx_(1.0 / cells), points_(both(cells)), run_(options(cells)) {
    run_.template set<NeoHookean>(lame(young, poisson));
    run_.template set<Walls<Slip>>(layer_walls(dx_, 2));
    pure_flip(run_);
    run_.add_particles(0, points_, density, dx_ * dx_ * dx_ / 4);
    for (std::int64_t p = 0; p < count(); ++p) {
      auto const& x = points_[static_cast<std::size_t>(p)];
      double const v = in_disc(x, 0.2) ? speed : -speed;
      run_.state().template set<particle::Velocity>(0, p, vec(v, v, 0.0));
    }
  }

  DiscOutcome collide() {
    double const start = kinetic();
    DiscOutcome o{start / dx_, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0};
    auto const steps = static_cast<int>(std::lround(duration / dt));
    for (int n = 1; n <= steps; ++n) {
      run_.step(dt);
      o.most = std::max(o.most, tissue_totals(run_, 0).energy() / start);
      if (n % 10 != 0) continue;
      o.kinetic = kinetic() / start;
      if (o.kinetic < o.least) {
        o.least = o.kinetic;
        o.when = n * dt;
      }
    }
    auto const all = tissue_totals(run_, 0);
    o.momentum = norm(all.momentum) / (all.mass * std::sqrt(2.0) * speed);
    o.rounding =
        1e-13 + fixed_point_noise_of_mean(dx_, dt, steps, double(count()), quantum<double>) / speed;
    o.status = run_.status(0);
    return o;
  }

 private:
  double place(double x) const { return x - margin * dx_; }
  bool in_disc(Vec3<double> const& x, double centre) const {
    return std::hypot(place(x[0]) - centre, place(x[1]) - centre) <= radius;
  }
  std::vector<Vec3<double>> both(int cells) const {
    return layer_points(dx_, cells + 2 * margin, cells + 2 * margin, [this](Vec3<double> const& x) {
      return in_disc(x, 0.2) || in_disc(x, 0.8);
    });
  }
  SimulationOptions options(int cells) const {
    return layer_options(dx_, cells + 2 * margin + 1, cells + 2 * margin + 1, points_.size());
  }
  std::int64_t count() const { return static_cast<std::int64_t>(points_.size()); }
  template <class F> auto get(std::int64_t p) const { return run_.state().template get<F>(0, p); }
  // Of the particles' own motion alone, as the table counts it [J].
  double kinetic() const {
    double sum = 0.0;
    for (std::int64_t p = 0; p < count(); ++p)
      sum += 0.5 * get<particle::Mass>(p) *
             dot(get<particle::Velocity>(p), get<particle::Velocity>(p));
    return sum;
  }
  double dx_;
  std::vector<Vec3<double>> points_;
  LayerRun<Body> run_;
};

}  // namespace test
