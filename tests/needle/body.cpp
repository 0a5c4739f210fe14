// The free needle: mass and inertia against quadrature, and what free motion conserves.
#include "catch.hpp"

#include <random>

#include <mpmpbd/needle/arc_needle.hpp>
#include <mpmpbd/needle/body.hpp>

using namespace mpmpbd;

namespace {
template <class T> NeedleBody<T> steel_needle(double angle = 3.141592653589793) {
  return NeedleBody<T>::of(Arc<T>{T(0.0064), T(angle), T(0.0004), T(0)}, T(7900));
}
template <class T> Pose<T> tilted() {
  return {vec<T>(T(0.011), T(-0.02), T(0.03)),
          quaternion::from_rotation_vector(vec<T>(T(0.4), T(-1.2), T(0.7)))};
}
}  // namespace

TEST_CASE("mass, centre and inertia of an arc equal their integrals", "[needle][inertia]") {
  for (double angle : {0.05, 0.8, 2.0, 3.141592653589793, 4.4, 6.283185307179586}) {
    Arc<double> const arc{0.0064, angle, 0.0011, 0.0};
    double const density = 7900;
    auto const body = NeedleBody<double>::of(arc, density);
    // Midpoint rule over the torus piece: angle, wire radius, wire angle.
    int const na = 400, nr = 60, nw = 60;
    double mass = 0;
    Vec3<double> first{};
    Mat3<double> second{};
    for (int i = 0; i < na; ++i)
      for (int j = 0; j < nr; ++j)
        for (int k = 0; k < nw; ++k) {
          double const a = -angle * (i + 0.5) / na, r = arc.wire_radius * (j + 0.5) / nr,
                       w = 6.283185307179586 * (k + 0.5) / nw;
          double const rho = arc.radius + r * std::cos(w);
          Vec3<double> const x = vec(rho * std::cos(a), rho * std::sin(a), r * std::sin(w));
          double const m =
              density * rho * r * (angle / na) * (arc.wire_radius / nr) * (6.283185307179586 / nw);
          mass += m;
          first += m * x;
          second += m * outer(x, x);
        }
    CAPTURE(angle);
    REQUIRE(body.mass == Approx(mass).epsilon(1e-10));
    REQUIRE(norm(body.centre - (1 / mass) * first) < 2e-5 * arc.radius);
    Vec3<double> const c = (1 / mass) * first;
    second -= mass * outer(c, c);
    Mat3<double> const inertia = trace(second) * Mat3<double>::identity() - second;
    double const scale = norm(inertia);
    for (int k = 0; k < 3; ++k) {
      Vec3<double> e{};
      e[k] = 1.0;
      REQUIRE(norm(body.times_inertia(Pose<double>::identity(), e) - inertia * e) < 5e-4 * scale);
    }
  }
}

TEST_CASE("a thin full circle is a ring, a short arc is a rod", "[needle][inertia]") {
  auto const ring = NeedleBody<double>::of({1.0, 2 * pi<double>, 1e-6, 0.0}, 1000.0);
  REQUIRE(norm(ring.centre) < 1e-15);
  REQUIRE(ring.inertia[0] == Approx(ring.mass / 2));
  REQUIRE(ring.inertia[2] == Approx(ring.mass));
  auto const rod = NeedleBody<double>::of({100.0, 0.01, 1e-9, 0.0}, 1000.0);
  REQUIRE(rod.inertia[2] == Approx(rod.mass / 12).epsilon(1e-4));
}

TEMPLATE_TEST_CASE("a body and its inverse inertia agree", "[needle][inertia]", float, double) {
  using T = TestType;
  auto const body = steel_needle<T>();
  auto const pose = tilted<T>();
  Vec3<T> const w = vec<T>(T(3), T(-5), T(2));
  REQUIRE(norm(body.divided_by_inertia(pose, body.times_inertia(pose, w)) - w) <=
          100 * epsilon<T> * norm(w));
  // The mobility of a point is the velocity change that an impulse makes there; symmetric when
  // swapped.
  Vec3<T> const a = to_world(pose, vec<T>(T(0.0064), T(0), T(0))),
                b = to_world(pose, vec<T>(T(-0.0064), T(0), T(0)));
  Vec3<T> const j = vec<T>(T(1e-6), T(-2e-6), T(5e-7));
  Twist<T> const after = body.kicked(pose, Twist<T>{}, j, a);
  auto const dv = velocity_at(pose, after, b);
  REQUIRE(norm(body.mobility(pose, b, a) * j - dv) <= 200 * epsilon<T> * norm(dv));
  auto const m = body.mobility(pose, a, b), n = transpose(body.mobility(pose, b, a));
  REQUIRE(norm(m - n) <= 200 * epsilon<T> * norm(m));
}

TEMPLATE_TEST_CASE(
    "free motion conserves momentum and angular momentum to rounding and bounds the energy",
    "[needle][motion]", float, double) {
  using T = TestType;
  auto const body = steel_needle<T>();
  auto pose = tilted<T>();
  // Close to the axis of the middle moment: it tumbles, so every axis takes part.
  REQUIRE(body.inertia[1] < body.inertia[0]);
  REQUIRE(body.inertia[0] < body.inertia[2]);
  Vec3<T> const spin = quaternion::rotate(
      pose.orientation, quaternion::rotate(body.principal, vec<T>(T(60), T(0.3), T(0.2))));
  Twist<T> twist{vec<T>(T(0.05), T(-0.02), T(0.01)), spin};
  auto const p0 = body.momentum(pose, twist);
  auto const l0 = body.angular_momentum(pose, twist, body.centre_of_mass(pose));
  T const e0 = body.kinetic_energy(pose, twist);
  Vec3<T> const x0 = body.centre_of_mass(pose), v0 = body.velocity_of_centre(pose, twist);
  T const dt = T(1e-4);
  T worst_p = 0, worst_l = 0, worst_e = 0, worst_w = 0;
  int const steps = 20000;
  for (int i = 0; i < steps; ++i) {
    body.advance(pose, twist, dt);
    worst_p = max(worst_p, norm(body.momentum(pose, twist) - p0) / norm(p0));
    worst_l =
        max(worst_l,
            norm(body.angular_momentum(pose, twist, body.centre_of_mass(pose)) - l0) / norm(l0));
    worst_e = max(worst_e, abs(body.kinetic_energy(pose, twist) - e0) / e0);
    worst_w = max(worst_w, norm(twist.angular - spin) / norm(spin));
  }
  INFO("p " << worst_p << " L " << worst_l << " E " << worst_e << " tumbling " << worst_w);
  REQUIRE(worst_p <= 2e4 * epsilon<T>);
  REQUIRE(worst_l <= (sizeof(T) == 4 ? 1e3 : 2e4) * epsilon<T>);
  REQUIRE(worst_e <= T(2e-5) + 2e4 * epsilon<T>);
  REQUIRE(worst_w > T(0.5));  // it does tumble
  REQUIRE(norm(body.centre_of_mass(pose) - x0 - T(steps) * dt * v0) <= 2e4 * epsilon<T> * T(0.1));
}

TEST_CASE("the rotation is of second order and can be run backwards", "[needle][motion]") {
  auto const body = steel_needle<double>();
  auto run = [&](int n, double time) {
    auto pose = tilted<double>();
    Twist<double> twist{{}, vec(40.0, 30.0, -20.0)};
    for (int i = 0; i < n; ++i) body.advance(pose, twist, time / n);
    return std::pair{pose, twist};
  };
  auto const exact = run(64000, 0.2).first;
  double const e1 = quaternion::distance(run(500, 0.2).first.orientation, exact.orientation);
  double const e2 = quaternion::distance(run(1000, 0.2).first.orientation, exact.orientation);
  REQUIRE(std::log2(e1 / e2) == Approx(2.0).margin(0.1));

  auto [pose, twist] = run(1000, 0.2);
  for (int i = 0; i < 1000; ++i) body.advance(pose, twist, -0.2 / 1000);
  REQUIRE(quaternion::distance(pose.orientation, tilted<double>().orientation) < 1e-10);
}

TEST_CASE("a steady turn about a principal axis is exact at any step", "[needle][motion]") {
  auto const body = steel_needle<double>();
  auto pose = tilted<double>();
  Vec3<double> const axis = quaternion::rotate(pose.orientation, vec(0.0, 0.0, 1.0));
  Twist<double> twist{{}, 10.0 * axis};
  Vec3<double> const x0 = pose.position, com0 = body.centre_of_mass(pose);
  twist.linear = -cross(twist.angular, body.arm(pose));  // about the centre of mass
  for (int i = 0; i < 5000; ++i) body.advance(pose, twist, 0.0123);
  REQUIRE(norm(twist.angular - 10.0 * axis) < 1e-10);
  REQUIRE(norm(body.centre_of_mass(pose) - com0) < 1e-13);
  REQUIRE(std::abs(norm(pose.position - com0) - norm(x0 - com0)) < 1e-13);
}

TEST_CASE("an impulse changes momentum, angular momentum and energy as it must",
          "[needle][motion]") {
  auto const body = steel_needle<double>(4.0);
  auto const pose = tilted<double>();
  Twist<double> const before{vec(0.1, 0.2, -0.1), vec(10.0, -20.0, 5.0)};
  Vec3<double> const at = to_world(pose, vec(0.0, -0.0064, 0.0)), j = vec(2e-5, -1e-5, 3e-5),
                     about = vec(0.3, 0.1, -0.2);
  auto const after = body.kicked(pose, before, j, at);
  REQUIRE(norm(body.momentum(pose, after) - body.momentum(pose, before) - j) <
          1e-14 * norm(j) + 1e-18);
  auto const dl =
      body.angular_momentum(pose, after, about) - body.angular_momentum(pose, before, about);
  REQUIRE(norm(dl - cross(at - about, j)) < 1e-12 * norm(dl));
  auto const mean = 0.5 * (velocity_at(pose, before, at) + velocity_at(pose, after, at));
  REQUIRE(body.kinetic_energy(pose, after) - body.kinetic_energy(pose, before) ==
          Approx(dot(j, mean)).epsilon(1e-10));
}

TEST_CASE("needle parameters are checked, alone and together", "[needle][parameters]") {
  using Catch::Matchers::Contains;
  ArcNeedle::Parameters<double> k{0.32, 3.1, 0.02, 0.1, 400.0, 100.0};
  auto const domain = vec(2.4, 1.4, 1.6);
  REQUIRE_NOTHROW(check_needle<ArcNeedle>(k, domain));
  auto bad = k;
  bad.radius = 0.8;
  REQUIRE_THROWS_WITH(check_needle<ArcNeedle>(bad, domain),
                      Contains("radius = 0.800000 m") && Contains("(0, 0.7]"));
  bad = k;
  bad.cutting_force = 500.0;
  REQUIRE_THROWS_WITH(check_needle<ArcNeedle>(bad, domain),
                      Contains("cutting_force = 500.000000 N") && Contains("[0, 400]"));
  bad = k;
  bad.wire_radius = 0.4;
  REQUIRE_THROWS_WITH(check_needle<ArcNeedle>(bad, domain), Contains("wire_radius"));
  FreeArcNeedle::Parameters<float> free{0.0064f, 3.1f, 0.0004f, 0.001f, 0.15f, 0.05f, -1.0f};
  REQUIRE_THROWS_WITH((check_needle<FreeArcNeedle, float>(free, vec(1.f, 1.f, 1.f))),
                      Contains("FreeArcNeedle: density = -1.0"));
}
