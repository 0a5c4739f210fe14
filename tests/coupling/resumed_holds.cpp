// An exchange begins with the holds of the one before: fewer trials, the same contact.
#include <cmath>
#include <numbers>

#include "catch.hpp"
#include "coupling/rig.hpp"

namespace {

using namespace test;
using mpmpbd::dot;
using mpmpbd::norm;

using Rough =
    mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::Friction, mpmpbd::NoDrag, false>;

constexpr double dx = 0.04, friction = 0.3, push = 0.02;
constexpr double degree = std::numbers::pi / 180.0;

// One point of a needle that is moved by hand, in tissue at rest.
struct OnePoint : Rig<double, Rough> {
  explicit OnePoint(Contact contact) : Rig(9, 9, 9, dx) {
    for (auto& m : mass) m = 3e-4;
    for (auto& w : inverse_mass) w = {{1 / 3e-4, 1 / 3e-4, 1 / 3e-4}};
    dt = previous_dt = 0.002;
    rest_density = 3e-4 / (dx * dx * dx);
    this->friction = {::friction, 0.0};
    needle.motion = Motion::kinematic;
    mpmpbd::ContactPoint<double> p{};
    p.position = {{0.165, 0.171, 0.158}};
    p.axis = {{0, 0, -1}};
    p.length = dx, p.radius = 1e-3;
    p.segment = -1;
    p.contact = contact;
    needle.centre = p.position;
    allocate({p});
  }
  // Moves the point at this velocity against tissue at rest. Returns whether a trial was wrong.
  bool push_at(Vec3<double> const& v) {
    for (auto& u : velocity) u = {};
    needle.velocity = v;
    REQUIRE(couple() == 0u);
    return view().scratch->revised != 0;
  }
  Vec3<double> impulse_aside() const {
    auto const& p = points[0];
    return p.impulse - dot(p.axis, p.impulse) * p.axis;
  }
};
Vec3<double> towards(double angle) {
  return {{0.1 * std::cos(angle), 0.1 * std::sin(angle), -push}};
}

}  // namespace

TEST_CASE("friction turns with the slip, without a trial where it turns little",
          "[coupling][friction][warm_start]") {
  for (double const turn : {0.0, 10.0, 20.0, 40.0, 120.0}) {
    CAPTURE(turn);
    OnePoint r(Contact::surface);
    CHECK(r.push_at(towards(0)));  // what it had before says nothing: tried in stick
    for (int step = 1; step < 20; ++step) {
      bool const wrong = r.push_at(towards(step * turn * degree));
      CHECK(wrong == (turn > 30));
      auto const aside = r.impulse_aside(), slip = r.slip(0);
      auto const slips = slip - dot(r.points[0].axis, slip) * r.points[0].axis;
      double const normal = dot(r.points[0].axis, r.points[0].impulse);
      CHECK(normal > 0);
      CHECK_THAT(norm(aside), WithinRel(friction * normal, 1e-9));
      CHECK(dot(aside, slips) < -0.9995 * norm(aside) * norm(slips));
    }
  }
}

TEST_CASE("a point that slid and comes to rest sticks", "[coupling][friction][warm_start]") {
  OnePoint r(Contact::surface);
  r.push_at(towards(0));
  CHECK_FALSE(r.push_at(towards(0)));
  r.push_at({{1e-4, 0, -push}});
  auto const slip = r.slip(0);
  CHECK(std::hypot(slip[0], slip[1]) < 1e-9);
  CHECK(norm(r.impulse_aside()) < 0.9 * friction * dot(r.points[0].axis, r.points[0].impulse));
}

TEST_CASE("a tip stays at its cap until less will do", "[coupling][tip][warm_start]") {
  OnePoint r(Contact::tip);
  auto& tip = r.points[0];
  tip.force_cap = 1e-4;
  CHECK(r.push_at(towards(0)));
  CHECK_FALSE(r.push_at(towards(0)));
  CHECK_THAT(dot(tip.axis, tip.impulse), WithinRel(tip.force_cap * r.dt, 1e-9));
  CHECK(r.push_at({{0, 0, -1e-4}}));
  CHECK(dot(tip.axis, tip.impulse) < 0.9 * tip.force_cap * r.dt);
  CHECK(std::abs(r.slip(0)[2]) < 1e-9);
}
