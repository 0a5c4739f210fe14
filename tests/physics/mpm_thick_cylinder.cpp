// A2.12: a thick cylinder in plane strain, pressed from outside, against Lame's solution
// s_r = -p (1 - ri^2/r^2) / (1 - ri^2/ro^2).
// seconds: 4
// on a device
#include <cmath>

#include <mpmpbd/effects/body_force.hpp>
#include <mpmpbd/effects/damping.hpp>

#include "catch.hpp"
#include "physics/plane_strain.hpp"

using namespace test;

namespace {

constexpr double young = 1e5, poisson = 0.3, density = 1050.0;  // [Pa] [1] [kg/m^3]
constexpr double outer = 0.08, inner = outer / 2;               // radii [m]
constexpr double pressure = 1e-3 * young;                       // small strains

// Lame's solution; `far` is the pressure far from the bore [Pa].
constexpr double far = pressure / (1.0 - inner * inner / (outer * outer));
double exact_stress(double r) { return -far * (1.0 - inner * inner / (r * r)); }
double exact_displacement(double r) {
  return -far * (1.0 + poisson) / young * ((1.0 - 2.0 * poisson) * r + inner * inner / r);
}

struct Errors {
  double inside, middle;  // of the displacement of the innermost and of a middle ring, relative
  double stress;          // L2 of the radial stress, relative
};

// Particles on rings half a cell apart, so that the faces are round and the volume is exact.
template <class Body> class Cylinder {
 public:
  explicit Cylinder(int cells)  // along the outer radius
      : dx_(outer / cells), half_(cells + margin), run_(options()) {
    run_.template set<NeoHookean>(lame(young, poisson));
    run_.template set<Walls<Slip>>(layer_walls(dx_, 2));
    pure_flip(run_);
    run_.template set<Damping>({2.0 * slowest()});
    for (int k = 0; k < cells; ++k) add_ring(inner + 0.5 * dx_ * (k + 0.5));
    press();
  }

  Errors rest() {
    constexpr int steps = 100;
    double before = 0.0;
    for (int s = 0; s < steps; ++s) {
      if (s == 9 * steps / 10) before = moved(0);
      run_.step(10.0 / slowest() / steps);
    }
    CHECK(run_.status(0) == 0);
    CHECK_THAT(moved(0), WithinRel(before, 1e-3));
    auto const n = rings_.size();
    return {error(0), error(n / 2), stress_error()};
  }

 private:
  static constexpr int margin = 3;  // cells
  struct Ring {
    double radius, volume;  // of a particle
    std::int64_t first, end;
  };

  // Of the breathing ring, which is stiffer than a thin one [1/s].
  static double slowest() { return std::sqrt(young / density) / outer; }
  SimulationOptions options() const {
    auto o = layer_options(dx_, 2 * half_ + 1, 2 * half_ + 1,
                           static_cast<std::size_t>(16 * half_ * half_));
    o.substeps = 0;
    return o;
  }
  void add_ring(double r) {
    auto const n = static_cast<int>(std::lround(2.0 * pi<double> * r / (0.5 * dx_)));
    std::vector<Vec3<double>> points;
    for (int i = 0; i < n; ++i) {
      double const angle = 2.0 * pi<double> * (i + 0.5) / n;
      points.push_back(vec(half_ * dx_ + r * std::cos(angle), half_ * dx_ + r * std::sin(angle),
                           layer_middle * dx_));
    }
    double const volume = 2.0 * pi<double> * r * 0.5 * dx_ * dx_ / n;
    run_.add_particles(0, points, density, volume);
    auto const first = rings_.empty() ? 0 : rings_.back().end;
    rings_.push_back({r, volume, first, first + n});
  }
  // The pressure on the outermost ring.
  void press() {
    auto const& ring = rings_.back();
    double const mass = density * ring.volume * double(ring.end - ring.first);
    double const push = pressure * 2.0 * pi<double> * outer * dx_ / mass;
    for (auto p = ring.first; p < ring.end; ++p)
      run_.state().template set<particle::BodyForce>(0, p, -push * outward(p));
  }
  template <class F> auto get(std::int64_t p) const { return run_.state().template get<F>(0, p); }
  Vec3<double> arm(std::int64_t p) const {
    auto const x = get<particle::Position>(p);
    return vec(x[0] - half_ * dx_, x[1] - half_ * dx_, 0.0);
  }
  Vec3<double> outward(std::int64_t p) const { return direction(arm(p)); }
  // Mean radial displacement of a ring [m].
  double moved(std::size_t k) const {
    auto const& ring = rings_[k];
    double sum = 0.0;
    for (auto p = ring.first; p < ring.end; ++p) sum += norm(arm(p)) - ring.radius;
    return sum / double(ring.end - ring.first);
  }
  double error(std::size_t k) const { return moved(k) / exact_displacement(rings_[k].radius) - 1; }
  // A cell from either face on: there the shapes see half a cell of nothing.
  double stress_error() const {
    auto const material = run_.state().template parameters<NeoHookean>(0);
    double off = 0.0, size = 0.0;
    for (auto const& ring : rings_) {
      if (ring.radius < inner + dx_ || ring.radius > outer - dx_) continue;
      double const exact = exact_stress(ring.radius);
      for (auto p = ring.first; p < ring.end; ++p) {
        Local<double, Fields<particle::Deformation>> q{};
        q[particle::Deformation{}] = get<particle::Deformation>(p);
        auto const n = outward(p);
        double const s = dot(n, NeoHookean::kirchhoff(q, material) * n) /
                         determinant(q[particle::Deformation{}]);
        off += (s - exact) * (s - exact);
        size += exact * exact;
      }
    }
    return std::sqrt(off / size);
  }

  double dx_;
  int half_;  // of the grid [cells]
  std::vector<Ring> rings_;
  LayerRun<Body, BodyForce, Damping> run_;
};

template <class... Policies> using Body = Mpm<NeoHookean, Policies...>;

// On 8 and 12 cells between the faces.
template <class Body> void check() {
  auto const coarse = Cylinder<Body>(16).rest(), fine = Cylinder<Body>(24).rest();
  CAPTURE(Body::Transfer::name.view(), Body::Form::name.view());
  CAPTURE(coarse.inside, coarse.middle, coarse.stress, fine.inside, fine.middle, fine.stress);
  CHECK_THAT(fine.inside, WithinAbs(0.0, 0.01));
  CHECK_THAT(fine.middle, WithinAbs(0.0, 0.01));
  for (auto const& e : {coarse, fine}) CHECK(e.stress <= 0.1);  // as of A2.8's column
  CHECK(std::abs(fine.inside) < std::abs(coarse.inside));
  CHECK(std::abs(fine.middle) < std::abs(coarse.middle));
}

}  // namespace

TEST_CASE("A thick cylinder bears pressure as Lame's", "[mpm][order]") {
  check<Body<Apic, QuadraticBSpline, WeightGradient>>();
  check<Body<Apic, QuadraticBSpline, Mls>>();
}
