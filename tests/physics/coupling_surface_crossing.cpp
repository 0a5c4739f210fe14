// A line that goes through the surface of the tissue, point by point, is held gradually: no point should
// take hold with a jerk.
// on a device
#include "catch.hpp"

#include "physics/tissue_block.hpp"
#include "physics/units.hpp"

namespace {

using namespace test;

// A rigid line along z that moves sideways at a given speed, above and in a block at rest.
template <class T> struct Crossing {
  using Form =
      mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;
  static constexpr double spacing = 0.5;
  Units unit;
  double surface;  // in cells
  Rig<T, Form> rig{16, 16, 18, T(unit.length)};

  Crossing(double jitter, double surface_) : surface(surface_) {
    Tissue<T> tissue;
    tissue.dx = T(unit.length);
    tissue.density = rig.rest_density = T(unit.density);
    tissue.dt = T(0);
    auto const corner = [&](double x, double z) { return unit.length * mpmpbd::vec(x, x, z); };
    tissue.fill(corner(3, surface - 7), corner(13, surface), jitter);
    tissue.scatter(rig);
    std::vector<mpmpbd::ContactPoint<T>> points(12);
    for (auto& p : points) {
      p.axis = mpmpbd::vec(T(0), T(0), T(1));
      p.length = T(spacing * unit.length);
      p.segment = -1;
    }
    rig.allocate(points);
    rig.needle.motion = Motion::kinematic;
    rig.needle.velocity = mpmpbd::vec(T(unit.speed()), T(0), T(0));
  }
  // Impulse on the tissue in one exchange from rest, while the tip is this deep; in node masses times speed.
  double impulse(double depth, double least) {
    std::fill(rig.velocity.begin(), rig.velocity.end(), Vec3<T>{});
    for (std::size_t k = 0; k < rig.points.size(); ++k) {
      auto& p = rig.points[k];
      double const z = surface - depth + spacing * (double(k) + 0.5);
      p.position = mpmpbd::cast<T>(unit.length * mpmpbd::vec(8.1, 7.8, z));
      p.impulse = {};
    }
    auto const x = rig.view();
    mpmpbd::embed_points(mpmpbd::Solo{}, x, rig.nodes());
    for (auto& p : rig.points) p.contact = p.coverage >= T(least) ? Contact::member : Contact::off;
    REQUIRE(exchange_on_back_end(rig, x) == 0u);
    double sum = 0;
    for (auto const& p : rig.points) sum += double(p.impulse[0]);
    return sum / (unit.mass() * unit.speed());
  }
};

// The largest jump within 0.05 cells of depth, over what a whole cell of depth takes.
template <class T> double largest_jump(double jitter, double surface, double least) {
  Crossing<T> c(jitter, surface);
  double const deepest = 4.5;
  double jump = 0, before = 0;
  for (int i = -30; i <= 90; ++i) {
    double const now = c.impulse(deepest * i / 90, least);
    jump = std::max(jump, std::abs(now - before));
    before = now;
  }
  return jump / (before / deepest);
}

}  // namespace

TEMPLATE_TEST_CASE("a line enters the tissue without a jerk", "[coupling][surface]", double,
                   float) {
  for (double jitter : {0.0, 0.5})
    for (int eighth = 0; eighth < 8; ++eighth) {
      double const jump = largest_jump<TestType>(jitter, 10 + eighth / 8.0, 0.25);
      CAPTURE(jitter, eighth, jump);
      CHECK(jump < 0.15);
    }
}

TEST_CASE("points that join late join with a jerk", "[coupling][surface][control]") {
  double const jump = largest_jump<double>(0.5, 10, 0.75);
  CAPTURE(jump);
  CHECK(jump > 0.5);
}
