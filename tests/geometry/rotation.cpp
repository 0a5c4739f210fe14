// Quaternions, poses and the motion within a substep.
#include "catch.hpp"

#include <random>

#include <mpmpbd/geometry/pose.hpp>

using namespace mpmpbd;

namespace {
template <class T> Vec3<T> random_vector(std::mt19937& rng, double scale) {
  std::normal_distribution<double> n(0.0, scale);
  double const a = n(rng), b = n(rng), c = n(rng);
  return {{T(a), T(b), T(c)}};
}
}  // namespace

TEMPLATE_TEST_CASE("a quaternion rotates as its matrix does", "[geometry][rotation]", float,
                   double) {
  using T = TestType;
  T const tolerance = 40 * epsilon<T>;
  std::mt19937 rng(1);
  for (int i = 0; i < 500; ++i) {
    auto const r = random_vector<T>(rng, 1.5);
    auto const q = quaternion::from_rotation_vector(r);
    auto const v = random_vector<T>(rng, 1.0);
    REQUIRE(abs(norm(q) - T(1)) <= tolerance);
    REQUIRE(norm(quaternion::matrix(q) * v - quaternion::rotate(q, v)) <=
            tolerance * (T(1) + norm(v)));
    REQUIRE(norm(quaternion::rotate_back(q, quaternion::rotate(q, v)) - v) <=
            tolerance * (T(1) + norm(v)));
    // The axis stays, and the length too.
    REQUIRE(norm(quaternion::rotate(q, r) - r) <= tolerance * (T(1) + norm(r)));
    auto const m = quaternion::matrix(q);
    auto const back = quaternion::from_axes(Vec3<T>{{m(0, 0), m(1, 0), m(2, 0)}},
                                            Vec3<T>{{m(0, 1), m(1, 1), m(2, 1)}},
                                            Vec3<T>{{m(0, 2), m(1, 2), m(2, 2)}});
    REQUIRE(quaternion::distance(back, q) <= 4 * tolerance);
  }
}

TEMPLATE_TEST_CASE("q and -q are the same rotation", "[geometry][rotation]", float, double) {
  using T = TestType;
  std::mt19937 rng(2);
  for (int i = 0; i < 200; ++i) {
    auto const q = quaternion::from_rotation_vector(random_vector<T>(rng, 2.0));
    auto const v = random_vector<T>(rng, 1.0);
    REQUIRE(quaternion::rotate(-q, v) == quaternion::rotate(q, v));
    REQUIRE(quaternion::rotation_vector(-q) == quaternion::rotation_vector(q));
    REQUIRE(quaternion::distance(q, -q) <= 20 * epsilon<T>);
  }
}

TEMPLATE_TEST_CASE("the rotation vector inverts the exponential up to half a turn",
                   "[geometry][rotation]", float, double) {
  using T = TestType;
  for (double angle : {0.0, 1e-30, 1e-12, 1e-6, 1e-3, 0.0099, 0.0101, 0.5, 1.5, 3.0, 3.1415}) {
    Vec3<T> const r = T(angle) * direction(Vec3<T>{{T(1), T(-2), T(0.5)}});
    auto const back = quaternion::rotation_vector(quaternion::from_rotation_vector(r));
    CAPTURE(angle);
    REQUIRE(norm(back - r) <= 8 * epsilon<T> * (T(angle) + (angle > 1 ? T(1) : T(0))));
  }
}

TEST_CASE("an impossible orientation is refused", "[geometry][rotation]") {
  double const nan = std::nan("");
  REQUIRE_THROWS_WITH(quaternion::checked("Needle", Quaternion<double>{}),
                      Catch::Matchers::Contains("Needle: orientation = (0.000000, 0.000000") &&
                          Catch::Matchers::Contains("not all zero"));
  REQUIRE_THROWS_AS(quaternion::checked("Needle", Quaternion<double>{{1, nan, 0, 0}}),
                    std::invalid_argument);
  REQUIRE_THROWS_AS(quaternion::checked("Needle", Quaternion<float>{{INFINITY, 0, 0, 0}}),
                    std::invalid_argument);
  auto const q = quaternion::checked("Needle", Quaternion<double>{{0, 0, -3, 0}});
  REQUIRE(q == Quaternion<double>{{0, 0, -1, 0}});
  // In device code nothing throws: zero stays zero and does not become NaN.
  REQUIRE(quaternion::normalised(Quaternion<double>{}) == Quaternion<double>{});
}

TEMPLATE_TEST_CASE("a body that turns about its own origin stays on its circle for 50 turns",
                   "[geometry][rotation]", float, double) {
  using T = TestType;
  T const radius = T(0.0064), dt = T(1e-3);
  Pose<T> pose{{{T(0.0201), T(-0.013), T(0.0022)}},
               quaternion::from_rotation_vector(Vec3<T>{{T(0.3), T(1), T(-2)}})};
  Vec3<T> const axis = quaternion::rotate(pose.orientation, Vec3<T>{{T(0), T(0), T(1)}});
  Vec3<T> const centre = pose.position, tip{{radius, T(0), T(0)}};
  Vec3<T> const start = to_world(pose, tip);
  int const steps = 50 * 1000;
  Twist<T> const twist{{}, T(2 * 3.14159265358979323846) / (1000 * dt) * axis};
  T off_circle = 0, off_plane = 0;
  for (int i = 0; i < steps; ++i) {
    pose = moved(pose, twist, dt);
    auto const r = to_world(pose, tip) - centre;
    off_circle = max(off_circle, abs(norm(r) - radius));
    off_plane = max(off_plane, abs(dot(r, axis)));
  }
  INFO("off circle " << off_circle / radius << ", off plane " << off_plane / radius);
  REQUIRE(pose.position == centre);
  REQUIRE(abs(norm(pose.orientation) - T(1)) <= 4 * epsilon<T>);
  REQUIRE(off_circle <=
          20 * epsilon<T> * norm(centre));  // rounding of one sum, not of 50,000 steps
  REQUIRE(off_plane <= 1e4 * epsilon<T> * radius);
  // The phase is a sum of 50,000 roundings.
  REQUIRE(norm(to_world(pose, tip) - start) <= 2e4 * epsilon<T> * radius);
}

TEMPLATE_TEST_CASE("the mean velocity of a substep carries a point exactly, at any angle",
                   "[geometry][rotation]", float, double) {
  using T = TestType;
  std::mt19937 rng(3);
  for (double angle : {0.0, 1e-9, 1e-3, 0.3, 2.0, 3.1, 6.0, 40.0})
    for (int i = 0; i < 20; ++i) {
      T const dt = T(0.004);
      Pose<T> const pose{random_vector<T>(rng, 0.02),
                         quaternion::from_rotation_vector(random_vector<T>(rng, 1.0))};
      Twist<T> const twist{random_vector<T>(rng, 0.5),
                           T(angle) / dt * direction(random_vector<T>(rng, 1.0))};
      Vec3<T> const body = random_vector<T>(rng, 0.01);
      Vec3<T> const x0 = to_world(pose, body), x1 = to_world(moved(pose, twist, dt), body);
      auto const u = Sweep<T>::of(pose, twist, dt).mean_velocity(x0);
      CAPTURE(angle);
      REQUIRE(norm(x0 + dt * u - x1) <= 40 * epsilon<T> * T(0.05) * T(1 + angle));
      if (angle == 0) REQUIRE(u == velocity_at(pose, twist, x0));
    }
}

TEMPLATE_TEST_CASE("the twist between two poses leads from one to the other",
                   "[geometry][rotation]", float, double) {
  using T = TestType;
  std::mt19937 rng(4);
  for (int i = 0; i < 100; ++i) {
    Pose<T> const a{random_vector<T>(rng, 1),
                    quaternion::from_rotation_vector(random_vector<T>(rng, 1))};
    Pose<T> b{random_vector<T>(rng, 1), quaternion::from_rotation_vector(random_vector<T>(rng, 1))};
    if (i % 2) b.orientation = -b.orientation;
    T const dt = T(0.01);
    auto const c = moved(a, twist_between(a, b, dt), dt);
    REQUIRE(norm(c.position - b.position) <= 10 * epsilon<T>);
    REQUIRE(quaternion::distance(c.orientation, b.orientation) <= 30 * epsilon<T>);
  }
}
