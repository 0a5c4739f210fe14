// A needle inside the tissue that is pushed sideways. Its points share the load without pulling against each
// other, for any substep: friction counts the sizes of their impulses. See docs/decisions/0007.
// seconds: 20
// on a device
#include "catch.hpp"

#include <mpmpbd/geometry/arc.hpp>

#include "physics/needle_in_block.hpp"

namespace {

using namespace test;
using Smooth =
    mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;
constexpr double length = 5.3;  // of the needle [cells]

struct Sideways {
  double force = 0;      // [units]
  double roughness = 0;  // sum of the sizes of all impulses / size of their sum
};

// `axis` of the needle, `push` across it, level: unit vectors.
Sideways push(double dt, int intervals, Vec3<double> const& axis, Vec3<double> const& push) {
  NeedleInBlock<double, Smooth> block({.top = 11, .dt = dt});
  double const cell = block.u.length, spacing = length / intervals;
  std::vector<mpmpbd::ContactPoint<double>> points;
  for (int i = 0; i <= intervals; ++i) {
    mpmpbd::ContactPoint<double> p{};
    p.position = cell * (mpmpbd::vec(7.6, 7.7, 6.9) + (i * spacing - length / 2) * axis);
    p.axis = axis;
    p.length = cell * spacing;
    p.segment = -1;
    points.push_back(p);
  }
  block.rig.allocate(points);
  while (block.time < 15) block.step(0.02 * push);
  Vec3<double> sum{};
  double sizes = 0;
  for (auto const& p : block.rig.points) {
    sum += p.impulse;
    sizes += mpmpbd::norm(p.impulse);
  }
  return {mpmpbd::norm(block.force), sizes / mpmpbd::norm(sum)};
}

int intervals() {
  mpmpbd::Arc<double> const wire{.radius = length, .angle = 1, .wire_radius = 0.1, .taper = 0};
  return mpmpbd::ArcPoints<double>::over(wire, 1).intervals;
}

Vec3<double> const along_x = mpmpbd::vec(1.0, 0.0, 0.0), along_z = mpmpbd::vec(0.0, 0.0, 1.0),
                   slanted = mpmpbd::direction(mpmpbd::vec(0.0, 1.0, 1.0));

}  // namespace

TEST_CASE("no two points of a needle pull against each other", "[coupling][needle]") {
  Vec3<double> const diagonal = mpmpbd::direction(mpmpbd::vec(1.0, 1.0, 1.0)),
                     level = mpmpbd::direction(mpmpbd::vec(1.0, -1.0, 0.0));
  for (double dt : {0.2, 0.05}) {
    CAPTURE(dt);
    CHECK(push(dt, intervals(), along_z, along_x).roughness < 1.001);
    CHECK(push(dt, intervals(), slanted, along_x).roughness < 1.001);
    CHECK(push(dt, intervals(), diagonal, level).roughness < 1.001);
  }
}

TEST_CASE("closer points do, and the force is the same", "[coupling][needle][control]") {
  Sideways const ours = push(0.05, intervals(), slanted, along_x),
                 close = push(0.05, 2 * intervals(), slanted, along_x);
  CAPTURE(ours.force, close.force, close.roughness);
  CHECK(close.roughness > 1.5);
  CHECK(std::abs(close.force / ours.force - 1) < 0.05);
}
