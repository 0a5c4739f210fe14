// An elastic disc spins in free flight (A2.6).
#pragma once

#include <vector>

#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/transfer/flip.hpp>
#include <mpmpbd/mpm/transfer/pic.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/scene/totals.hpp>

#include "physics/back_end.hpp"

namespace test {

using namespace mpmpbd;

inline constexpr double radius = 0.2537, young = 1e6, poisson = 0.3,
                        density = 1000.0;          // [m] [Pa] [1] [kg/m^3]
inline constexpr double omega = 2.0 * pi<double>;  // [rad/s]

template <class Body> struct Flight : Scene<Body> {};

template <class Body, int cells_per_radius, class Backend = BackEnd, class T = double> class Disc {
 public:
  using Transfer = typename Body::Transfer;
  static constexpr double dx = radius / cells_per_radius;

  explicit Disc(Backend where = {})
      : run_({.environments = 1,
              .cell_size = dx,
              .nodes = {2 * cells_per_radius + 9, 2 * cells_per_radius + 9, 8},
              .capacity = {{"particle", 16 * (cells_per_radius + 1) * (cells_per_radius + 1) * 2}},
              .substeps = 1},
             where) {
    run_.template set<FixedCorotated>(lame(young, poisson));
    if constexpr (std::is_same_v<Transfer, Flip>) run_.template set<Flip>({1.0});
    std::vector<Vec3<double>> at;
    int const n = 2 * (2 * cells_per_radius + 8);
    for (int k = 6; k < 8; ++k)  // one cell thick, two particles per cell and axis
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          auto const x = 0.5 * dx * vec(i + 0.5, j + 0.5, k + 0.5);
          if (norm(arm(x)) <= radius) at.push_back(x);
        }
    run_.add_particles(0, at, density, dx * dx * dx / 8);
    count_ = static_cast<std::int64_t>(at.size());
    auto& state = run_.state();
    for (std::int64_t p = 0; p < count_; ++p) {
      auto const r = arm(cast<double>(state.template get<particle::Position>(0, p)));
      state.template set<particle::Velocity>(0, p, cast<T>(cross(vec(0.0, 0.0, omega), r)));
      if constexpr (Transfer::carries_affine)
        state.template set<particle::Affine>(0, p, cast<T>(skew(vec(0.0, 0.0, omega))));
    }
  }

  // 0.4 dx / c_p
  static double dt() {
    auto const k = lame(young, poisson);
    return 0.4 * dx / mpmpbd::sqrt((k.lambda + 2 * k.mu) / density);
  }
  void advance(int steps) {
    for (int n = 0; n < steps; ++n) run_.step(dt());
  }
  std::uint32_t status() const { return run_.status(0); }
  std::int64_t particles() const { return count_; }
  // At the radius of gyration, at the start [m/s].
  static double speed_of_gyration() { return omega * radius / mpmpbd::sqrt(2.0); }
  // What is left of the spin after a PIC step: 1 - 2 M D / (I + 2 M D).
  double pic_factor() const {
    double inertia = 0.0, mass = 0.0;
    for_each([&](auto const& p) {
      mass += p.m;
      inertia += p.m * dot(p.r, p.r);
    });
    double const MD = mass * dx * dx / Body::Shape::inverse_inertia;
    return 1.0 - 2.0 * MD / (inertia + 2.0 * MD);
  }

  Totals totals() const { return tissue_totals(run_, 0); }
  // About the axis, affine part included [kg m^2/s].
  static double spin(Totals const& t) {
    auto const x = vec(centre(), centre(), 0.0);
    return (t.angular_momentum - cross(x, t.momentum))[2];
  }
  double speeds() const {  // sum m |v| [kg m/s]
    double sum = 0.0;
    for_each([&](auto const& p) { sum += p.m * norm(p.v); });
    return sum;
  }

 private:
  struct Point {
    std::int64_t slot;
    double m;
    Vec3<double> r, v;  // from the axis
  };
  static double centre() { return 0.5 * dx * (2 * cells_per_radius + 8); }
  static Vec3<double> arm(Vec3<double> const& x) {
    return vec(x[0] - centre(), x[1] - centre(), 0.0);
  }
  template <class Function> void for_each(Function&& f) const {
    auto const& s = run_.state();
    for (std::int64_t p = 0; p < count_; ++p)
      f(Point{p, s.template get<particle::Mass>(0, p),
              arm(cast<double>(s.template get<particle::Position>(0, p))),
              cast<double>(s.template get<particle::Velocity>(0, p))});
  }

  Simulation<Flight<Body>, Backend, T> run_;
  std::int64_t count_ = 0;
};

struct Outcome {
  double spin_100;  // left after 100 steps
  double pic;       // what the formula leaves to PIC after 100 steps
  double spin;      // left at the end
  double kinetic;   // left at the end
  double lost;      // of kinetic + strain energy
  double momentum;  // over the sum of m |v| at the start
  double rounding;  // that momentum and spin may have on this back end
  std::uint32_t status;
};

template <class Disc_> Outcome spin(Disc_ disc, double revolutions) {
  auto const start = disc.totals();
  double const spin = disc.spin(start), speeds = disc.speeds();
  Outcome o{};
  o.pic = mpmpbd::pow(disc.pic_factor(), 100.0);
  disc.advance(100);
  o.spin_100 = disc.spin(disc.totals()) / spin;
  disc.advance(static_cast<int>(revolutions / disc.dt()) - 100);
  auto const end = disc.totals();
  o.spin = disc.spin(end) / spin;
  o.kinetic = end.kinetic / start.kinetic;
  o.lost = 1.0 - (end.kinetic + end.strain) / start.kinetic;
  o.momentum = norm(end.momentum) / speeds;
  o.rounding = 1e-12 + fixed_point_noise_of_mean(disc.dx, disc.dt(), revolutions / disc.dt(),
                                                 double(disc.particles()), quantum<double>) /
                           disc.speed_of_gyration();
  o.status = disc.status();
  return o;
}

}  // namespace test
