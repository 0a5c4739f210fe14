// A2.1: a single particle on the grid is an oscillator with a known frequency, wherever it is in its cell,
// and with a known limit of the time step. Checks gradient_stiffness() for every transfer and force form.
// seconds: 3
// on a device
#include <algorithm>
#include <cmath>
#include <vector>

#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/flip.hpp>
#include <mpmpbd/mpm/transfer/pic.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include "catch.hpp"
#include "physics/back_end.hpp"

using namespace mpmpbd;

namespace {

constexpr double dx = 3.7e-3, density = 1050.0;
// At the start: small, and far above what momentum is rounded to.
constexpr double strain = test::quantum < double >> 0 ? 1e-5 : 1e-7, large = 1e-2;
Lame<double> const material = lame(1.3e4, 0.4);

template <class Body> struct Lone : Scene<Body> {};

enum class Mode { volume, deviator };

Mat3<double> shape_of(Mode mode) {
  return mode == Mode::volume ? Mat3<double>{{1, 0, 0, 0, 1, 0, 0, 0, 1}}
                              : Mat3<double>{{1, 0, 0, 0, -1, 0, 0, 0, 0}};
}

// The strain of a lone particle `cells` from the origin, over `steps` steps of dt.
template <class Body>
std::vector<double> strains(Vec3<double> const& cells, double dt, int steps,
                            Mode mode = Mode::volume) {
  Simulation<Lone<Body>, test::BackEnd, double> run({.environments = 1,
                                                     .cell_size = dx,
                                                     .nodes = {8, 8, 8},
                                                     .capacity = {{"particle", 1}},
                                                     .substeps = 1});
  run.template set<NeoHookean>(material);
  if constexpr (std::is_same_v<typename Body::Transfer, Flip>) run.template set<Flip>({1.0});
  std::vector<Vec3<double>> const at{dx * cells};
  run.add_particles(0, at, density, dx * dx * dx / 8);
  run.state().template set<particle::Deformation>(
      0, 0, Mat3<double>::identity() + strain * shape_of(mode));
  std::vector<double> e;
  for (int n = 0; n < steps; ++n) {
    e.push_back(run.state().template get<particle::Deformation>(0, 0)(0, 0) - 1.0);
    if (mpmpbd::abs(e.back()) > 10 * large) break;
    run.step(dt);
  }
  return e;
}

double largest(std::vector<double> const& e) {
  double most = 0.0;
  for (double x : e) most = max(most, mpmpbd::abs(x));
  return most / strain;
}

// Frequency [1/s] of an undamped discrete oscillator, e_{n+1} + e_{n-1} = (2 - (w dt)^2) e_n, by least
// squares: w is that of the differential equation, sin(w_disc dt / 2) = w dt / 2. Rounding of shared momentum moves e by
// 6 to 9 quanta per step, and w by 18 to 28 quanta over the strain (one standard deviation).
double frequency(std::vector<double> const& e, double dt) {
  double up = 0.0, down = 0.0;
  for (std::size_t n = 1; n + 1 < e.size(); ++n) {
    up += e[n] * (e[n + 1] - 2.0 * e[n] + e[n - 1]);
    down += e[n] * e[n];
  }
  return mpmpbd::sqrt(-up / down) / dt;
}

// Where the weight gradient is stiffest, in cells: at the edge of the stencil, but not so near to it that the mass there
// is less than what it is rounded to.
template <class Shape> double worst_place() {
  double const edge = std::max(1e-9, std::sqrt(2e6 * test::quantum<double>));
  double place = 0.5, most = 0.0;
  for (int n = 1; n < 400; ++n) {
    double const f = Shape::offset + (n < 399 ? n / 400.0 : edge);
    double const here = detail::slope_stiffness<Shape>(f);
    if (here > most) {
      most = here;
      place = f;
    }
  }
  return place;
}

template <class Shape, class Transfer, class Form>
using Body = Mpm<NeoHookean, Shape, Transfer, Form>;

template <class Body> void check_frequency() {
  double const k3 = 3.0 * material.lambda + 2.0 * material.mu;
  double const D = dx * dx / Body::Shape::inverse_inertia;
  struct {
    Mode mode;
    double exact;
  } const cases[] = {{Mode::volume, mpmpbd::sqrt(k3 / (density * D))},
                     {Mode::deviator, mpmpbd::sqrt(2.0 * material.mu / (density * D))}};
  for (auto const& c : cases) {
    double const dt = 0.11 / c.exact;
    double slowest = 1e30, fastest = 0.0;
    for (auto const& cells : {vec(3.0, 3.0, 3.0), vec(3.5, 3.5, 3.5), vec(3.17, 2.71, 3.93),
                              vec(2.999999, 3.25, 3.500001), vec(3.4, 3.0, 2.6)}) {
      double const w = frequency(strains<Body>(cells, dt, 400, c.mode), dt);
      slowest = min(slowest, w);
      fastest = max(fastest, w);
    }
    CHECK_THAT(slowest, WithinRel(c.exact, 1e-4));
    CHECK_THAT(fastest, WithinRel(c.exact, 1e-4));
    CHECK(fastest - slowest < (1e-6 + 150 * test::quantum<double> / strain) * c.exact);
  }
}

// Both sides of the limit, at the stiffest place. At 0.98 of it the amplitude of the undamped
// oscillator is 1 / sqrt(1 - 0.98^2) times the initial strain; with PIC and FLIP the strain decays.
template <class Body> void check_limit(double stiffness) {
  CHECK_THAT(gradient_stiffness<Body>(), WithinRel(stiffness, 1e-6));
  double const k3 = 3.0 * material.lambda + 2.0 * material.mu;
  double const limit = elastic_limit<Body>(StepBounds<double>{k3 / density, 0.0, 0.0}, dx);
  double const f = worst_place<typename Body::Shape>();
  auto const cells = vec(2.0 + f, 2.0 + f, 2.0 + f);
  CAPTURE(Body::Shape::name.view(), Body::Transfer::name.view(), Body::Form::name.view());
  CHECK(largest(strains<Body>(cells, 0.98 * limit, 4000)) <=
        1.001 / mpmpbd::sqrt(1.0 - 0.98 * 0.98));
  CHECK(largest(strains<Body>(cells, 1.02 * limit, 4000)) > large / strain);
}

}  // namespace

TEST_CASE("A lone particle oscillates with the exact frequency anywhere in its cell") {
  check_frequency<Body<QuadraticBSpline, Apic, Mls>>();
  check_frequency<Body<CubicBSpline, Apic, Mls>>();
  check_frequency<Body<QuadraticBSpline, Tpic, Mls>>();
  check_frequency<Body<CubicBSpline, Tpic, Mls>>();
}

// 2 a_F - a_C of time_step.hpp: MLS forces have a = D^-1 everywhere, the weight gradient up to 6 for the
// quadratic shape (at half cells) and 3.1368 for the cubic; PIC and FLIP carry nothing.
TEST_CASE("The time step limit of a lone particle is sharp") {
  SECTION("MLS forces") {
    check_limit<Body<QuadraticBSpline, Apic, Mls>>(4.0);
    check_limit<Body<QuadraticBSpline, Tpic, Mls>>(4.0);
    check_limit<Body<QuadraticBSpline, Pic, Mls>>(8.0);
    check_limit<Body<QuadraticBSpline, Flip, Mls>>(8.0);
    check_limit<Body<CubicBSpline, Apic, Mls>>(3.0);
    check_limit<Body<CubicBSpline, Tpic, Mls>>(3.0);
    check_limit<Body<CubicBSpline, Pic, Mls>>(6.0);
    check_limit<Body<CubicBSpline, Flip, Mls>>(6.0);
  }
  SECTION("weight gradient") {
    check_limit<Body<QuadraticBSpline, Tpic, WeightGradient>>(6.0);
    check_limit<Body<QuadraticBSpline, Apic, WeightGradient>>(8.0);
    check_limit<Body<QuadraticBSpline, Pic, WeightGradient>>(12.0);
    check_limit<Body<QuadraticBSpline, Flip, WeightGradient>>(12.0);
    double const cubic = detail::slope_stiffness<CubicBSpline>(worst_place<CubicBSpline>());
    CHECK_THAT(cubic, WithinRel(3.1368, 1e-4));
    check_limit<Body<CubicBSpline, Tpic, WeightGradient>>(cubic);
    check_limit<Body<CubicBSpline, Apic, WeightGradient>>(2.0 * cubic - 3.0);
    check_limit<Body<CubicBSpline, Pic, WeightGradient>>(2.0 * cubic);
    check_limit<Body<CubicBSpline, Flip, WeightGradient>>(2.0 * cubic);
  }
}
