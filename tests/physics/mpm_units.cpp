// B7: the same block in metres, kilograms and seconds and in millimetres, grams and milliseconds; and
// a body of a millionth of the density. A number compared with a constant of a unit would show here.
// seconds: 5
// on a device
#include <vector>

#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/transfer/flip.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/testing/samples.hpp>

#include "catch.hpp"
#include "physics/back_end.hpp"

using namespace mpmpbd;

namespace {

// How many of the new units one SI unit is.
struct Units {
  double length, mass, time;
};
constexpr Units si{1.0, 1.0, 1.0}, small{1e3, 1e3, 1e3};

using Floor = Wall<Sticky, 2, Side::low>;
template <class Body> struct Block : Scene<Body, Gravity, Floor> {};

struct Outcome {
  std::vector<Vec3<double>> x;  // in cells
  std::vector<Mat3<double>> F;
};

// A block hits the floor and bounces; `light` divides density and stiffness alike.
template <class Body, class T> Outcome bounce(Units const& u, double light = 1.0) {
  double const dx = 3.7e-3 * u.length;
  double const pressure = u.mass / (u.length * u.time * u.time) / light;
  double const density = 1050.0 * u.mass / (u.length * u.length * u.length) / light;
  Simulation<Block<Body>, test::BackEnd, T> run({.environments = 1,
                                                 .cell_size = dx,
                                                 .nodes = {12, 12, 12},
                                                 .capacity = {{"particle", 343}},
                                                 .substeps = 1});
  auto const k = lame(1.3e4, 0.4);
  run.template set<FixedCorotated>({k.mu * pressure, k.lambda * pressure});
  run.template set<Gravity>({{0.0, 0.0, -9.81 * u.length / (u.time * u.time)}});
  run.template set<Floor>({2.2 * dx});
  if constexpr (std::is_same_v<typename Body::Transfer, Flip>) run.template set<Flip>({0.95});
  std::vector<Vec3<double>> at;
  testing::Samples random(3);
  for (int n = 0; n < 343; ++n)
    at.push_back(dx * vec(3.0 + 0.5 * (n % 7), 3.0 + 0.5 * (n / 7 % 7), 2.6 + 0.5 * (n / 49)));
  run.add_particles(0, at, density, dx * dx * dx / 8);
  for (int p = 0; p < 343; ++p)
    run.state().template set<particle::Velocity>(
        0, p, cast<T>(u.length / u.time * random.matrix<3>(-0.3, 0.2)));
  for (int s = 0; s < 300; ++s) run.step(1.5e-4 * u.time);
  CHECK(run.status(0) == 0);
  Outcome end;
  for (int p = 0; p < 343; ++p) {
    end.x.push_back(1.0 / dx * cast<double>(run.state().template get<particle::Position>(0, p)));
    end.F.push_back(cast<double>(run.state().template get<particle::Deformation>(0, p)));
  }
  return end;
}

// `allowed` where every share of momentum is rounded to its own last place; more where all are to one quantum: they are
// a 27th of a particle's momentum in the mean.
template <class Body, class T> void compare(double allowed) {
  allowed *= std::max(1.0, 27 * test::quantum<T> / double(epsilon<T>));
  auto const metres = bounce<Body, T>(si);
  for (auto const& other : {bounce<Body, T>(small), bounce<Body, T>(si, 1e6)}) {
    double dx = 0.0, dF = 0.0;
    for (std::size_t p = 0; p < other.x.size(); ++p) {
      dx = max(dx, norm(other.x[p] - metres.x[p]) / norm(metres.x[p]));
      dF = max(dF, norm(other.F[p] - metres.F[p]));
    }
    CAPTURE(dx, dF);
    CHECK(dx <= allowed);
    CHECK(dF <= allowed);
  }
}

template <class... Policies> using Body = Mpm<FixedCorotated, Policies...>;

}  // namespace

// Positions relative to the distance from the origin, and F, which is of the order of 1.
TEST_CASE("A scene does not know its units") {
  compare<Body<Apic, Mls>, double>(1e-11);
  compare<Body<Apic, Mls>, float>(1e-5);
  compare<Body<Tpic, CubicBSpline, WeightGradient>, double>(1e-11);
  compare<Body<Flip, WeightGradient>, double>(1e-11);
}
