// The needle's arc: exact geometry, nearest point across every branch, contact points.
#include "catch.hpp"

#include <mpmpbd/geometry/arc.hpp>

using namespace mpmpbd;

namespace {
double constexpr turn = 6.283185307179586;
template <class T> Arc<T> half_circle() { return {T(0.0064), T(turn / 2), T(0.0004), T(0.003)}; }
}  // namespace

TEMPLATE_TEST_CASE("points of the arc lie on it and tangents point to the tip", "[needle][arc]",
                   float, double) {
  using T = TestType;
  for (double angle : {0.3, 2.0, 3.2, 4.7, turn}) {
    Arc<T> const arc{T(0.0064), T(angle), T(0.0004), T(0)};
    T const h = T(1e-3) * arc.length();
    REQUIRE(arc.point(T(0)) == Vec3<T>{{arc.radius, T(0), T(0)}});
    for (int i = 0; i <= 50; ++i) {
      T const s = arc.length() * T(i) / T(50);
      REQUIRE(abs(norm(arc.point(s)) - arc.radius) <= 4 * epsilon<T> * arc.radius);
      REQUIRE(abs(norm(arc.tangent(s)) - T(1)) <= 4 * epsilon<T>);
      auto const secant = (T(1) / (T(2) * h)) * (arc.point(s - h) - arc.point(s + h));
      REQUIRE(norm(secant - arc.tangent(s)) <= T(2e-5) + T(4000) * epsilon<T>);
    }
  }
}

TEMPLATE_TEST_CASE("the nearest point is found on every side of the branch of atan2",
                   "[needle][arc]", float, double) {
  using T = TestType;
  for (double angle : {0.3, 2.0, 3.141592653589793, 3.2, 4.7, 6.2, turn}) {
    Arc<T> const arc{T(0.32), T(angle), T(0.02), T(0)};
    for (int i = 0; i <= 400; ++i) {
      T const s = arc.length() * T(i) / T(400);
      for (T off : {T(0.7), T(1), T(1.4)}) {
        auto x = off * arc.point(s);
        x[2] = T(0.05);
        CAPTURE(angle, i, off);
        T const found = arc.nearest(x);
        REQUIRE(found >= T(0));
        REQUIRE(found <= arc.length());
        // On a full turn both ends are the same place.
        REQUIRE(norm(arc.point(found) - arc.point(s)) <= 8 * epsilon<T>);
        T const expected = sqrt(square(abs(off - T(1)) * arc.radius) + square(T(0.05)));
        REQUIRE(abs(arc.distance(x) - expected) <= 8 * epsilon<T>);
      }
    }
  }
}

TEMPLATE_TEST_CASE("the nearest point does not jump where the local angle passes pi",
                   "[needle][arc]", float, double) {
  using T = TestType;
  Arc<T> const arc{T(0.32), T(4.7), T(0.02), T(0)};
  T const pi_ = pi<T>;
  T previous =
      arc.nearest(vec<T>(T(0.32) * cos(pi_ - T(0.01)), T(0.32) * sin(-(pi_ - T(0.01))), T(0)));
  for (int i = -99; i <= 100; ++i) {
    T const a = pi_ + T(1e-4) * T(i);
    T const s = arc.nearest(vec<T>(T(0.32) * cos(a), -T(0.32) * sin(a), T(0)));
    REQUIRE(abs(s - previous - T(0.32e-4)) <= 8 * epsilon<T>);
    previous = s;
  }
  // Exactly at pi, with both signs of zero.
  REQUIRE(arc.nearest(vec<T>(T(-1), T(0), T(0))) == Approx(0.32 * 3.14159265).epsilon(1e-6));
  REQUIRE(arc.nearest(vec<T>(T(-1), -T(0), T(0))) == Approx(0.32 * 3.14159265).epsilon(1e-6));
}

TEMPLATE_TEST_CASE("in the gap the nearer end is taken, on the axis the tip", "[needle][arc]",
                   float, double) {
  using T = TestType;
  auto const arc = half_circle<T>();
  // The gap is the half plane y > 0; the tip is at +x, the blunt end at -x.
  REQUIRE(arc.nearest(vec<T>(T(0.001), T(0.01), T(0))) == T(0));
  REQUIRE(arc.nearest(vec<T>(T(-0.001), T(0.01), T(0))) == arc.length());
  REQUIRE(arc.nearest(vec<T>(T(0.006), T(1e-12), T(0))) == T(0));
  REQUIRE(arc.nearest(vec<T>(T(0), T(0), T(0.3))) == T(0));
  REQUIRE(arc.distance(vec<T>(T(0), T(0), T(0.0048))) == Approx(0.008).epsilon(1e-6));
}

TEMPLATE_TEST_CASE("contact points: tip first, a cell or a little more apart, lengths add up",
                   "[needle][arc]", float, double) {
  using T = TestType;
  for (double angle : {0.4, 1.0, 3.14159, 5.0, turn})
    for (int i = 1; i <= 300; ++i) {
      Arc<T> const arc{T(0.0064), T(angle), T(0.0004), T(0)};
      T const dx = T(0.00002) * T(i);
      auto const points = ArcPoints<T>::over(arc, dx);
      T const cells = arc.length() / dx;
      CAPTURE(angle, i, cells);
      if (points.count() > 2) REQUIRE(points.spacing() >= T(0.95) * dx * (1 - 8 * epsilon<T>));
      REQUIRE(points.spacing() <= (cells < 3 ? T(1.9) : T(1.3)) * dx * (1 + 8 * epsilon<T>));
      REQUIRE(points.s(0) == T(0));
      REQUIRE(points.s(points.count() - 1) == arc.length());
      double sum = 0;
      for (int k = 0; k < points.count(); ++k) sum += static_cast<double>(points.ds(k));
      REQUIRE(sum == Approx(static_cast<double>(arc.length())).epsilon(2e-5));
    }
  // A short arc keeps its two ends; one of whole cells has points a cell apart.
  REQUIRE(ArcPoints<T>::over(half_circle<T>(), T(1)).count() == 2);
  // The needle of preset `paper`.
  REQUIRE(ArcPoints<T>::over(Arc<T>{T(0.32), pi<T>, T(0.02), T(0.1)}, T(0.1)).count() == 11);
  for (int n = 2; n < 40; ++n) {
    Arc<T> const arc{T(n) * T(0.0017), T(1), T(0.0004), T(0)};
    CAPTURE(n);
    REQUIRE(ArcPoints<T>::over(arc, T(0.0017)).intervals == n);
  }
}

TEMPLATE_TEST_CASE("the tip is pointed", "[needle][arc]", float, double) {
  using T = TestType;
  auto const arc = half_circle<T>();
  REQUIRE(arc.wire_radius_at(T(0)) == T(0));
  REQUIRE(arc.wire_radius_at(arc.taper / 2) == Approx(0.0002).epsilon(1e-6));
  REQUIRE(arc.wire_radius_at(arc.taper) == arc.wire_radius);
  REQUIRE(arc.wire_radius_at(arc.length()) == arc.wire_radius);
  Arc<T> blunt = arc;
  blunt.taper = 0;
  REQUIRE(blunt.wire_radius_at(T(0)) == arc.wire_radius);
}

TEST_CASE("impossible arcs are refused by name, value and bound", "[needle][arc]") {
  using Catch::Matchers::Contains;
  auto const good = half_circle<double>();
  REQUIRE_NOTHROW(check_arc(good));
  REQUIRE_NOTHROW(check_arc(Arc<float>{0.32f, 2 * pi<float>, 0.02f, 0.0f}));
  auto with = [&](double Arc<double>::*member, double value) {
    auto a = good;
    a.*member = value;
    return a;
  };
  REQUIRE_THROWS_WITH(check_arc(with(&Arc<double>::radius, -1)),
                      Contains("radius = -1.000000 m") && Contains("(0, inf)"));
  REQUIRE_THROWS_WITH(check_arc(with(&Arc<double>::radius, std::nan(""))), Contains("radius"));
  REQUIRE_THROWS_WITH(check_arc(with(&Arc<double>::angle, 0)),
                      Contains("angle = 0.000000 rad") && Contains("(0, 6.28318"));
  REQUIRE_THROWS_WITH(check_arc(with(&Arc<double>::angle, 6.3)), Contains("angle = 6.300000"));
  REQUIRE_THROWS_WITH(check_arc(with(&Arc<double>::wire_radius, 0.0064)),
                      Contains("wire_radius") && Contains("[0, 0.0064)"));
  REQUIRE_THROWS_WITH(check_arc(with(&Arc<double>::taper, 1)), Contains("taper = 1.000000 m"));
  REQUIRE_THROWS_WITH(check_arc(with(&Arc<double>::taper, -1e-3)), Contains("taper"));
}
