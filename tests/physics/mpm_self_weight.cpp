// A2.8 (and B38 at ten times gravity): a column between rollers under its own weight, against the exact
// finite-strain solution P(F) = -rho g (H - X).
// seconds: 2
// on a device
#include <array>
#include <cmath>

#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/gravity.hpp>

#include "catch.hpp"
#include "physics/plane_strain.hpp"

using namespace test;

namespace {

constexpr double young = 1e4, poisson = 0.4, density = 1050.0, height = 0.1;
Lame<double> const material = lame(young, poisson);

// First Piola-Kirchhoff stress in uniaxial strain [Pa].
double stress(double F) { return material.mu * (F - 1.0 / F) + material.lambda * std::log(F) / F; }
// Stretch under a pressure [Pa], by Newton.
double stretch(double pressure) {
  double F = 1.0;
  for (int n = 0; n < 50; ++n) {
    double const slope =
        material.mu * (1.0 + 1.0 / (F * F)) + material.lambda * (1.0 - std::log(F)) / (F * F);
    F -= (stress(F) + pressure) / slope;
  }
  return F;
}
// Displacement at height X [m], by the rule of the midpoint.
double displacement(double X, double g) {
  constexpr int intervals = 4000;
  double sum = 0.0;
  for (int n = 0; n < intervals; ++n)
    sum += stretch(density * g * (height - (n + 0.5) / intervals * X)) - 1.0;
  return sum * X / intervals;
}

struct Errors {
  double top;     // of the displacement of the highest particle, relative
  double stress;  // L2, relative
};

// At rest, n cells high on a wall.
template <class Body> Errors settle(int n, double g) {
  constexpr int floor = 2;
  double const dx = height / n;
  auto const points = bar_points(dx, floor, floor + n);
  auto options = layer_options(dx, n + floor + 4, layer_nodes, points.size());
  options.substeps = 0;
  LayerRun<Body, Gravity, Damping> run(options);
  auto walls = layer_walls(dx, 1);
  walls.low[0] = floor * dx;
  run.template set<Walls<Slip>>(walls);
  run.template set<NeoHookean>(material);
  run.template set<Gravity>({{-g, 0.0, 0.0}});
  // The slowest mode, critically damped, for sixteen times its time.
  double const slowest =
      pi<double> / (2.0 * height) * std::sqrt((material.lambda + 2.0 * material.mu) / density);
  run.template set<Damping>({2.0 * slowest});
  run.add_particles(0, points, density, dx * dx * dx / 2);
  for (int s = 0; s < 200; ++s) run.step(16.0 / slowest / 200);
  CHECK(run.status(0) == 0);

  double off = 0.0, size = 0.0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    double const exact = -density * g * (height + floor * dx - points[p][0]);
    double const F =
        run.state().template get<particle::Deformation>(0, static_cast<std::int64_t>(p))(0, 0);
    off += std::pow(stress(F) - exact, 2);
    size += exact * exact;
  }
  auto const last = static_cast<std::int64_t>(points.size()) - 1;
  double const u = run.state().template get<particle::Position>(0, last)[0] - points.back()[0];
  double const exact = displacement(points.back()[0] - floor * dx, g);
  return {std::abs(u / exact - 1.0), std::sqrt(off / size)};
}

// Errors at 16, 32 and 64 cells; at 32 not more than `most`.
template <class Body> std::array<Errors, 3> check(double most, double g) {
  std::array<Errors, 3> const e{settle<Body>(16, g), settle<Body>(32, g), settle<Body>(64, g)};
  CAPTURE(Body::Shape::name.view(), Body::Form::name.view(), g, e[0].top, e[1].top, e[2].top,
          e[0].stress, e[1].stress, e[2].stress);
  CHECK(e[1].top <= most);
  CHECK(e[1].stress <= 0.1);
  CHECK(e[2].top < e[1].top);
  CHECK(e[1].top < e[0].top);
  return e;
}
template <class Body> void check_order(double most) {
  auto const e = check<Body>(most, 9.81);
  for (double const order : {std::log2(e[0].top / e[1].top), std::log2(e[1].top / e[2].top)}) {
    CHECK(order >= 0.8);
    CHECK(order <= 1.3);
  }
}

template <class... Policies> using Body = Mpm<NeoHookean, Apic, Policies...>;

}  // namespace

TEST_CASE("The exact column is that of the page", "[mpm]") {
  CHECK_THAT(displacement(height, 9.81), WithinAbs(-2.31715085e-3, 1e-10));
  CHECK_THAT(stretch(density * 9.81 * height), WithinAbs(0.95448578, 1e-8));
  CHECK_THAT(displacement(height, 98.1), WithinAbs(-1.76696273e-2, 1e-9));
  CHECK_THAT(stretch(density * 98.1 * height), WithinAbs(0.69179982, 1e-8));
}

// First order: half a cell at the wall and at the free face is not seen.
TEST_CASE("A column settles under its weight", "[mpm][order]") {
  check_order<Body<QuadraticBSpline, WeightGradient>>(0.03);
  check_order<Body<QuadraticBSpline, Mls>>(0.02);
  check_order<Body<CubicBSpline, WeightGradient>>(0.03);
}

TEST_CASE("A column settles under ten times its weight", "[mpm][stability]") {
  check<Body<QuadraticBSpline, WeightGradient>>(0.03, 98.1);
  check<Body<QuadraticBSpline, Mls>>(0.02, 98.1);
}
