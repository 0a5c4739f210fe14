// A2.12: the bulk modulus, from a block that a known load presses on a floor: the strain is the load's over
// the modulus of uniaxial strain, so that the forces of the grid are weighed and not only the material's law,
// and the mean pressure is the bulk modulus times the strain.
// seconds: 1
// on a device
#include <cmath>

#include <mpmpbd/effects/body_force.hpp>
#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>

#include "catch.hpp"
#include "physics/plane_strain.hpp"

using namespace test;

namespace {

constexpr double young = 1e4, density = 1050.0, height = 0.1;  // [Pa] [kg/m^3] [m]
constexpr int cells = 32, floor_node = 2;
constexpr double dx = height / cells, squeeze = 2e-3;  // expected strain

struct Squeezed {
  double strain;    // of the block, by the way of its last particle
  double pressure;  // mean over the block [Pa]
};

// A block on a wall, between rollers, at rest under a load [Pa] on its last half column.
template <class Body> class Block {
 public:
  using Material = typename Body::Material;

  Block(Lame<double> const& material, double load)
      : material_(material),
        points_(bar_points(dx, floor_node, floor_node + cells)),
        run_(options()) {
    run_.template set<Material>({material.mu, material.lambda});
    auto walls = layer_walls(dx, 1);
    walls.low[0] = floor_node * dx;
    run_.template set<Walls<Slip>>(walls);
    run_.template set<Damping>({2.0 * slowest()});
    run_.add_particles(0, points_, density, dx * dx * dx / 2);
    double const mass = density * dx * dx * dx / 2;
    run_.state().template set<particle::BodyForce>(0, last(),
                                                   vec(-load * dx * dx / mass, 0.0, 0.0));
  }

  Squeezed rest() {
    for (int s = 0; s < 200; ++s) run_.step(16.0 / slowest() / 200);
    CHECK(run_.status(0) == 0);
    double const start = points_.back()[0];
    double const way = start - run_.state().template get<particle::Position>(0, last())[0];
    return {way / (start - floor_node * dx), pressure()};
  }

 private:
  static SimulationOptions options() {
    auto o = layer_options(dx, cells + floor_node + 4, layer_nodes, 2 * cells);
    o.substeps = 0;
    return o;
  }
  std::int64_t last() const { return static_cast<std::int64_t>(points_.size()) - 1; }
  // Of a bar that is held at one end [1/s].
  double slowest() const {
    return pi<double> / (2.0 * height) *
           std::sqrt((material_.lambda + 2.0 * material_.mu) / density);
  }
  double pressure() const {
    double sum = 0.0;
    auto const k = run_.state().template parameters<Material>(0);
    for (std::int64_t p = 0; p <= last(); ++p) {
      Local<double, Fields<particle::Deformation>> q{};
      q[particle::Deformation{}] = run_.state().template get<particle::Deformation>(0, p);
      sum -= trace(Material::kirchhoff(q, k)) / (3.0 * determinant(q[particle::Deformation{}]));
    }
    return sum / double(points_.size());
  }

  Lame<double> material_;
  std::vector<Vec3<double>> points_;
  LayerRun<Body, BodyForce, Damping> run_;
};

template <class Body> void check(double poisson) {
  auto const k = lame(young, poisson);
  double const bulk = k.lambda + 2.0 / 3.0 * k.mu, uniaxial = bulk + 4.0 / 3.0 * k.mu;
  double const load = squeeze * uniaxial;
  auto const block = Block<Body>(k, load).rest();
  CAPTURE(Body::Material::name.view(), Body::Form::name.view(), poisson);
  CHECK_THAT(load / block.strain, WithinRel(uniaxial, 0.03));
  CHECK_THAT(block.pressure / block.strain, WithinRel(bulk, 0.03));
}

}  // namespace

TEST_CASE("A load measures the bulk modulus", "[mpm]") {
  for (double const poisson : {0.0, 0.3, 0.45}) {
    check<Mpm<NeoHookean, Mls>>(poisson);
    check<Mpm<NeoHookean, WeightGradient>>(poisson);
    check<Mpm<FixedCorotated, CubicBSpline>>(poisson);
  }
}
