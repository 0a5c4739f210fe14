// Planes, boxes, polylines, triangles.
#include "catch.hpp"

#include <random>
#include <vector>

#include <mpmpbd/geometry/box.hpp>
#include <mpmpbd/geometry/plane.hpp>
#include <mpmpbd/geometry/polyline.hpp>
#include <mpmpbd/geometry/triangle.hpp>

using namespace mpmpbd;

TEST_CASE("distance to a plane and to a box", "[geometry]") {
  Plane<double> const plane{vec(0.0, 0.0, 0.02), direction(vec(0.0, 3.0, 4.0))};
  REQUIRE(plane.distance(vec(7.0, 0.0, 0.02)) == Approx(0).margin(1e-15));
  REQUIRE(plane.distance(vec(0.0, 0.3, 0.42)) == Approx(0.5));
  REQUIRE(plane.distance(plane.nearest(vec(1.0, 2.0, -3.0))) == Approx(0).margin(1e-15));

  Box<double> const box{vec(-1.0, 0.0, 2.0), vec(1.0, 4.0, 3.0)};
  REQUIRE(box.volume() == Approx(8));
  REQUIRE(box.distance(vec(0.0, 2.0, 2.5)) == Approx(-0.5));
  REQUIRE(box.distance(vec(0.0, 2.0, 2.1)) == Approx(-0.1));
  REQUIRE(box.distance(vec(4.0, 8.0, 2.5)) == Approx(5.0));
  REQUIRE(box.distance(vec(1.0, 4.0, 3.0)) == 0.0);
  REQUIRE(box.contains(vec(1.0, 4.0, 3.0)));
  REQUIRE_THROWS_WITH(check_box(Box<double>{vec(0.0, 0.0, 0.0), vec(1.0, 0.0, 1.0)}),
                      Catch::Matchers::Contains("high[1] = 0.000000 m is not above low[1]"));
}

TEST_CASE("the nearest point of a polyline; coincident points do no harm", "[geometry]") {
  std::vector<Vec3<double>> const p{vec(0.0, 0.0, 0.0), vec(1.0, 0.0, 0.0), vec(1.0, 0.0, 0.0),
                                    vec(1.0, 2.0, 0.0)};
  auto const at = [&](std::int64_t i) { return p[static_cast<std::size_t>(i)]; };
  auto const line = [&](Vec3<double> const& x) {
    return nearest_on_polyline(at, std::int64_t(p.size()), x);
  };
  REQUIRE(line(vec(0.25, -1.0, 0.0)).weight == Approx(0.25));
  REQUIRE(line(vec(0.25, -1.0, 0.0)).distance == Approx(1));
  REQUIRE(line(vec(2.0, 1.0, 0.0)).piece == 2);
  REQUIRE(line(vec(2.0, 3.0, 0.0)).distance == Approx(std::sqrt(2.0)));
  REQUIRE(line(vec(-3.0, 4.0, 0.0)).distance == Approx(std::sqrt(20.0)));
  REQUIRE(nearest_on_polyline(at, 0, vec(0.0, 0.0, 0.0)).piece == -1);
  REQUIRE(nearest_on_polyline(at, 1, vec(0.0, 3.0, 4.0)).distance == Approx(5));
  REQUIRE(polyline_length<double>(at, 4) == Approx(3));
}

TEMPLATE_TEST_CASE("the nearest point of a triangle beats a fine search", "[geometry]", float,
                   double) {
  using T = TestType;
  std::mt19937 rng(5);
  std::normal_distribution<double> n;
  auto v = [&] { return Vec3<T>{{T(n(rng)), T(n(rng)), T(n(rng))}}; };
  int features[3] = {0, 0, 0};
  for (int trial = 0; trial < 300; ++trial) {
    Triangle<T> const t{v(), v(), v()};
    auto const p = T(2) * v();
    auto const best = nearest_on_triangle(t, p);
    ++features[static_cast<int>(best.feature)];
    T const found = norm(p - t.at(best.weights));
    REQUIRE(best.weights[0] >= T(0));
    REQUIRE(best.weights[1] >= T(0));
    REQUIRE(best.weights[0] + best.weights[1] <= T(1) + 4 * epsilon<T>);
    T searched = T(1e9);
    for (int i = 0; i <= 40; ++i)
      for (int j = 0; i + j <= 40; ++j)
        searched = min(searched, norm(p - t.at({{T(i) / T(40), T(j) / T(40)}})));
    REQUIRE(found <= searched + 20 * epsilon<T>);
    REQUIRE(found >= searched - T(0.1));
  }
  for (int f : features) REQUIRE(f > 10);
  // Without area: the edge.
  Triangle<T> const flat{vec<T>(0, 0, 0), vec<T>(1, 0, 0), vec<T>(2, 0, 0)};
  REQUIRE(norm(flat.at(nearest_on_triangle(flat, vec<T>(T(1.5), T(1), T(0))).weights) -
               vec<T>(T(1.5), T(0), T(0))) <= 4 * epsilon<T>);
}
