// A2.12: the bulk modulus, from a block that is pressed between a floor and a plate: pressure over the
// share of the volume that the plate has taken.
// seconds: 3
#include <cmath>

#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/pinned_region.hpp>
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>

#include "catch.hpp"
#include "physics/plane_strain.hpp"

using namespace test;

namespace {

constexpr double young = 1e4, density = 1050.0, height = 0.1;  // [Pa] [kg/m^3] [m]
constexpr int cells = 32, floor_node = 2;
constexpr double dx = height / cells, squeeze = 2e-3;  // share of the height

// Mean pressure [Pa] of a block between rollers after the plate has come to rest.
template <class Body> double pressure(Lame<double> const& material) {
  using Material = typename Body::Material;
  auto const points = bar_points(dx, floor_node, floor_node + cells);
  auto options = layer_options(dx, cells + floor_node + 4, layer_nodes, points.size());
  options.substeps = 0;
  LayerRun<Body, Damping, DrivenRegion> run(options);
  run.template set<Material>({material.mu, material.lambda});
  auto walls = layer_walls(dx, 1);
  walls.low[0] = floor_node * dx;
  run.template set<Walls<Slip>>(walls);
  double const slowest =
      pi<double> / height * std::sqrt((material.lambda + 2.0 * material.mu) / density);
  run.template set<Damping>({2.0 * slowest});
  run.add_particles(0, points, density, dx * dx * dx / 2);

  double const duration = 20.0 / slowest, plate = (floor_node + cells - 0.01) * dx;
  auto const drive = [&](double speed) {
    run.template set<DrivenRegion>({{plate, -1.0, -1.0}, {1.0, 1.0, 1.0}, {-speed, 0.0, 0.0}});
    for (int s = 0; s < 200; ++s) run.step(duration / 200);
  };
  drive(squeeze * height / duration);
  drive(0.0);
  CHECK(run.status(0) == 0);

  double sum = 0.0;
  auto const k = run.state().template parameters<Material>(0);
  for (std::size_t p = 0; p < points.size(); ++p) {
    Local<double, Fields<particle::Deformation>> q{};
    q[particle::Deformation{}] =
        run.state().template get<particle::Deformation>(0, static_cast<std::int64_t>(p));
    sum -= trace(Material::kirchhoff(q, k)) / (3.0 * determinant(q[particle::Deformation{}]));
  }
  return sum / double(points.size());
}

template <class Body> void check(double poisson) {
  auto const k = lame(young, poisson);
  double const bulk = k.lambda + 2.0 / 3.0 * k.mu;
  CAPTURE(Body::Material::name.view(), Body::Form::name.view(), poisson);
  CHECK_THAT(pressure<Body>(k) / squeeze, WithinRel(bulk, 0.03));
}

}  // namespace

TEST_CASE("Plates measure the bulk modulus", "[mpm]") {
  for (double const poisson : {0.0, 0.3, 0.45}) {
    check<Mpm<NeoHookean, Mls>>(poisson);
    check<Mpm<NeoHookean, WeightGradient>>(poisson);
    check<Mpm<FixedCorotated, CubicBSpline>>(poisson);
  }
}
