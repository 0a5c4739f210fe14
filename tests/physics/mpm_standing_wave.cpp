// A2.5: the lowest mode of a bar with one end fixed and one free: its period and what is left of it after
// ten periods.
// seconds: 12
//
// The bar and its mirror image are run, so the fixed end is a place inside of a body. A wall would hold the
// node behind it too, which should move like the one before it, backwards: first order in dx.
// on a device
#include <cmath>

#include <mpmpbd/mpm/transfer/pic.hpp>

#include "catch.hpp"
#include "physics/plane_strain.hpp"

using namespace test;

namespace {

constexpr double length = 0.37, young = 2.3e4, density = 1050.0;  // [m] [Pa] [kg/m^3]
// Of the speed of sound: strains of 1e-3, whose square shortens the period by less than 1e-6.
constexpr double amplitude = 1e-3;
constexpr int periods = 10;

struct Mode {
  double period;     // over the exact one
  double amplitude;  // over that of the start
};

template <class Body> class Bar {
 public:
  explicit Bar(int cells)
      : dx_(length / cells),
        points_(bar_points(dx_, 3, 3 + 2 * cells)),
        run_(layer_options(dx_, 2 * cells + 7, layer_nodes, points_.size())) {
    run_.template set<NeoHookean>({young / 2, 0.0});  // P = E / 2 (F - 1 / F)
    run_.template set<Walls<Slip>>(layer_walls(dx_, 1));
    pure_flip(run_);
    run_.add_particles(0, points_, density, dx_ * dx_ * dx_ / 2);
    for (std::int64_t p = 0; p < count(); ++p) {
      run_.state().template set<particle::Velocity>(0, p,
                                                    vec(amplitude * speed() * shape(p), 0.0, 0.0));
      if constexpr (Body::Transfer::carries_affine) {
        Mat3<double> C{};
        C(0, 0) = amplitude * speed() * wave_number * std::cos(wave_number * X(p));
        run_.state().template set<particle::Affine>(0, p, C);
      }
    }
  }

  Mode observe() {
    auto const per_period = static_cast<int>(std::lround(40.0 * length / dx_));  // 0.1 dx / c
    double const dt = 4.0 * length / speed() / per_period;
    double first = 0.0, last = 0.0, before = of_mode(), most = 0.0;
    int crossings = 0;
    for (int n = 1; n <= periods * per_period; ++n) {
      run_.step(dt);
      double const now = of_mode();
      if (now * before < 0.0) {  // the mode is at rest
        last = n - now / (now - before);
        if (crossings++ == 0) first = last;
      }
      if (n > (periods - 1) * per_period) most = std::max(most, std::abs(now));
      before = now;
    }
    CHECK(run_.status(0) == 0);
    CHECK(crossings == 2 * periods);
    return {2.0 * (last - first) / (crossings - 1) / per_period, most};
  }

 private:
  static constexpr double wave_number = pi<double> / (2.0 * length);
  static double speed() { return std::sqrt(young / density); }
  std::int64_t count() const { return static_cast<std::int64_t>(points_.size()); }
  double X(std::int64_t p) const {  // from the fixed end
    return points_[static_cast<std::size_t>(p)][0] - 3.0 * dx_ - length;
  }
  double shape(std::int64_t p) const { return std::sin(wave_number * X(p)); }
  // Velocity of the mode, over its amplitude.
  double of_mode() const {
    double sum = 0.0, norm2 = 0.0;
    for (std::int64_t p = 0; p < count(); ++p) {
      sum += shape(p) * run_.state().template get<particle::Velocity>(0, p)[0];
      norm2 += shape(p) * shape(p);
    }
    return sum / norm2 / (amplitude * speed());
  }

  double dx_;
  std::vector<Vec3<double>> points_;
  LayerRun<Body> run_;
};

template <class... Policies> using Body = Mpm<NeoHookean, QuadraticBSpline, Policies...>;

// The error of the period at 25 cells, with a tenth of room, and its order.
template <class Body> void check(double error) {
  auto const coarse = Bar<Body>(25).observe(), fine = Bar<Body>(50).observe();
  double const order = std::log2(std::abs((coarse.period - 1.0) / (fine.period - 1.0)));
  CAPTURE(Body::Transfer::name.view(), coarse.period - 1.0, fine.period - 1.0, order,
          coarse.amplitude, fine.amplitude);
  CHECK(std::abs(coarse.period - 1.0) <= 1.1 * error);
  CHECK(order >= 1.8);
  CHECK_THAT(coarse.amplitude, WithinAbs(1.0, 5e-3));
  CHECK_THAT(fine.amplitude, WithinAbs(1.0, 5e-3));
}

}  // namespace

TEST_CASE("A bar rings with its period", "[mpm][order]") {
  check<Body<Flip, WeightGradient>>(1.0e-3);
  check<Body<Apic, WeightGradient>>(5.4e-4);
  check<Body<Apic, Mls>>(4.3e-4);
}

TEST_CASE("A bar of PIC rings no longer", "[mpm]") {
  CHECK(Bar<Body<Pic, WeightGradient>>(25).observe().amplitude < 0.05);
}
