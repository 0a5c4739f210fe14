// The sheet: construction, crossings through faces, edges and vertices, sides, distances, volume.
// seconds: 5
#include "catch.hpp"

#include <algorithm>
#include <random>

#include "held_sheet.hpp"
#include "support/sanitized.hpp"

#include <mpmpbd/coupling/embedded_arrays.hpp>
#include <mpmpbd/surface/sheet_picture.hpp>

using namespace mpmpbd;
using Catch::Matchers::Contains;

namespace {

// Under a sanitizer every thirteenth vertex is looked at: another one in each row.
constexpr std::int64_t every = test::sanitized ? 13 : 1;

template <class T> Vec3<T> uniform(std::mt19937& rng, Vec3<T> const& low, Vec3<T> const& high) {
  std::uniform_real_distribution<double> u;
  Vec3<T> x;
  for (int a = 0; a < 3; ++a) x[a] = low[a] + T(u(rng)) * (high[a] - low[a]);
  return x;
}

// Moves every vertex by a smooth field of a few millimetres.
template <class H> void bend(H& held) {
  auto s = held.sheet();
  for (std::int64_t i = 0; i < s.vertices; ++i) {
    auto x = s.vertex(i);
    using T = typename decltype(x)::Scalar;
    T const a = T(200) * x[0], b = T(240) * x[1];
    x += T(0.0015) * vec<T>(sin(b), cos(a), sin(a + b));
    s.vertex.set(i, x);
  }
  held.faults |= held.columns().build(held.sheet());
}

}  // namespace

TEMPLATE_TEST_CASE("the sheet of a box is closed, turns outwards and has its volume",
                   "[surface][sheet]", float, double) {
  using T = TestType;
  auto const mesh = box_sheet(block<T>(), Vec3<int>{{20, 10, 10}});
  REQUIRE_NOTHROW(check_sheet(mesh));
  REQUIRE(mesh.triangles.size() == 2 * 2 * (20 * 10 + 20 * 10 + 10 * 10));
  REQUIRE(mesh.positions.size() == 2 + mesh.triangles.size() / 2);  // Euler: V - E + F = 2
  auto const sheet = sheet_of(mesh);
  REQUIRE(enclosed_volume(sheet) == Approx(0.04 * 0.02 * 0.02).epsilon(50 * epsilon<T>));
  auto const q = sheet_quality(sheet);
  REQUIRE(q.worst_shape == Approx(std::sqrt(3.0) / 2).epsilon(1e-3));
  REQUIRE(q.smallest_area == Approx(2e-6).epsilon(1e-3));
  REQUIRE(q.longest_edge == Approx(0.002 * std::sqrt(2.0)).epsilon(1e-3));
  for (std::int64_t k = 0; k < sheet.triangles; ++k) {
    auto const t = sheet.triangle(k);
    auto const middle = t.at({{T(1) / 3, T(1) / 3}});
    REQUIRE(dot(t.area_normal(), middle - block<T>().centre()) > T(0));
  }
}

TEST_CASE("what is not a closed sheet is refused with the reason", "[surface][sheet]") {
  auto const good = box_sheet(Box<double>{vec(0., 0., 0.), vec(1., 1., 1.)}, Vec3<int>{{2, 2, 2}});
  REQUIRE_NOTHROW(check_sheet(good));
  auto bad = good;
  bad.triangles.pop_back();
  REQUIRE_THROWS_WITH(check_sheet(bad), Contains("give a closed surface"));
  bad = good;
  std::swap(bad.triangles[3][0], bad.triangles[3][1]);
  REQUIRE_THROWS_WITH(check_sheet(bad), Contains("opposite directions"));
  bad = good;
  for (auto& t : bad.triangles) std::swap(t[0], t[1]);
  REQUIRE_THROWS_WITH(check_sheet(bad), Contains("turn inwards"));
  bad = good;
  for (auto& x : bad.positions) x *= 1e150;
  REQUIRE_THROWS_WITH(check_sheet(bad), Contains("its volume is not a finite number"));
  bad = good;
  bad.triangles[5][2] = 99;
  REQUIRE_THROWS_WITH(check_sheet(bad), Contains("triangle 5 names vertex 99; there are 26"));
  bad = good;
  bad.positions[7][1] = std::nan("");
  REQUIRE_THROWS_WITH(check_sheet(bad), Contains("vertex 7 is not finite"));
  bad = good;
  bad.positions.push_back(vec(0., 0., 0.));
  REQUIRE_THROWS_WITH(check_sheet(bad), Contains("vertex 26 belongs to no triangle"));
  bad = good;
  bad.triangles[0][1] = bad.triangles[0][0];
  REQUIRE_THROWS_WITH(check_sheet(bad), Contains("triangle 0 has no area"));
  bad.triangles.resize(3);
  REQUIRE_THROWS_WITH(check_sheet(bad), Contains("at least 4"));
  REQUIRE_THROWS_WITH(box_sheet(block<double>(), Vec3<int>{{2, 0, 2}}), Contains("cells[1] = 0"));
  REQUIRE_THROWS_WITH(box_sheet(Box<double>{}, Vec3<int>{{2, 2, 2}}), Contains("is not above"));
}

TEMPLATE_TEST_CASE("inside is found for any point, also below edges and vertices",
                   "[surface][side]", float, double) {
  using T = TestType;
  auto held = held_block<T>();
  REQUIRE(held.faults == 0);
  auto const sheet = held.sheet();
  auto const columns = held.columns();
  auto const box = block<T>();
  std::mt19937 rng(1);
  for (int i = 0; i < test::repeats(5000); ++i) {
    auto const x = uniform(rng, vec<T>(0, 0, 0), vec<T>(T(0.052), T(0.032), T(0.03)));
    if (abs(box.distance(x)) < T(1e-6)) continue;
    REQUIRE(is_inside(sheet, columns, x) == box.contains(x));
  }
  // Exactly below vertices, edges and diagonals of the top: the ray goes through seams.
  for (std::int64_t v = 0; v < sheet.vertices; v += every)
    for (std::int64_t w : {v, (v * 7 + 3) % sheet.vertices}) {
      auto const p = T(0.5) * (sheet.vertex(v) + sheet.vertex(w));
      for (T z : {T(0.0001), T(0.0052), T(0.0139), T(0.0231), T(0.0299)}) {
        Vec3<T> const x = vec<T>(p[0], p[1], z);
        bool const beside = box.distance(vec<T>(x[0], x[1], T(0.014))) < T(-1e-6);
        CAPTURE(v, w, z);
        if (beside) REQUIRE(is_inside(sheet, columns, x) == (z > box.low[2] && z < box.high[2]));
      }
    }
  // Far outside of the columns.
  REQUIRE_FALSE(is_inside(sheet, columns, vec<T>(T(-5), T(0.01), T(0.01))));
  REQUIRE_FALSE(is_inside(sheet, columns, vec<T>(T(0.02), T(7), T(0.01))));
}

TEMPLATE_TEST_CASE(
    "a path through a closed sheet crosses it an even number of times, seams included",
    "[surface][crossing]", float, double) {
  using T = TestType;
  auto held = held_block<T>();
  auto const deformed = GENERATE(false, true);
  if (deformed) bend(held);
  REQUIRE(held.faults == 0);
  auto const sheet = held.sheet();
  auto const columns = held.columns();
  std::mt19937 rng(2);
  int through_seams = 0;
  for (std::int64_t v = 0; v < sheet.vertices; v += every) {
    // From outside, exactly towards a vertex, an edge's middle or a random point, to the far
    // outside.
    auto const c = sheet.corners((v * 2) % sheet.triangles);
    auto const edge = T(0.5) * (sheet.vertex(c[0]) + sheet.vertex(c[1]));
    for (auto const& aim : {sheet.vertex(v), edge, uniform(rng, block<T>().low, block<T>().high)}) {
      for (int trial = 0; trial < 4; ++trial) {
        auto d = direction(uniform(rng, vec<T>(T(-1), T(-1), T(-1)), vec<T>(T(1), T(1), T(1))));
        if (trial == 0) d = vec<T>(0, 0, 1);
        if (trial == 1) d = vec<T>(0, T(-1), 0);
        Vec3<T> const p = aim - T(0.0625) * d, q = aim + T(0.0625) * d;
        auto const found = crossings(sheet, columns, p, q);
        auto const back = crossings(sheet, columns, q, p);
        CAPTURE(v, trial, found.count);
        REQUIRE(found.count % 2 == 0);
        REQUIRE(back.count % 2 == 0);
        through_seams += found.count > 0;
        // In order, in and out in turn.
        for (int i = 0; i < found.count; ++i) {
          REQUIRE(found.list[i].leaving == (i % 2 == 1));
          if (i > 0) REQUIRE(found.list[i].share >= found.list[i - 1].share - T(100) * epsilon<T>);
          auto const x = position(sheet, found.list[i].mark);
          REQUIRE(norm(x - (p + found.list[i].share * (q - p))) < T(60) * epsilon<T>);
        }
      }
    }
  }
  REQUIRE(through_seams > 1000 / every);
}

TEMPLATE_TEST_CASE("a straight way down through a vertex, an edge or a face is one crossing",
                   "[surface][crossing]", float, double) {
  using T = TestType;
  auto held = held_block<T>();
  auto const sheet = held.sheet();
  auto const columns = held.columns();
  auto const box = block<T>();
  int tested = 0;
  for (std::int64_t v = 0; v < sheet.vertices; v += every) {
    auto const x = sheet.vertex(v);
    if (x[2] != box.high[2] || box.distance(vec<T>(x[0], x[1], T(0.014))) > T(-1e-4)) continue;
    for (auto const& off : {vec<T>(0, 0, 0), vec<T>(T(0.001), 0, 0), vec<T>(T(0.001), T(0.001), 0),
                            vec<T>(T(0.0003), T(0.0011), 0)}) {
      if (box.distance(x + off) > T(1e-6)) continue;
      auto const found = crossings(sheet, columns, x + off + vec<T>(0, 0, T(0.001)),
                                   x + off - vec<T>(0, 0, T(0.001)));
      REQUIRE(found.count == 1);
      REQUIRE_FALSE(found.list[0].leaving);
      REQUIRE(found.list[0].share == Approx(0.5).epsilon(1e-4));
      // Stopping exactly on the surface belongs to the first part of the way, not to the second.
      REQUIRE(crossings(sheet, columns, x + off + vec<T>(0, 0, T(0.001)), x + off).count == 1);
      REQUIRE(crossings(sheet, columns, x + off, x + off - vec<T>(0, 0, T(0.001))).count == 0);
      // No way at all, and a way within the surface.
      REQUIRE(crossings(sheet, columns, x + off, x + off).count == 0);
      REQUIRE(crossings(sheet, columns, x + off, x + off + vec<T>(T(0.0007), 0, 0)).count == 0);
      ++tested;
    }
  }
  REQUIRE(tested > 600 / every);
}

TEMPLATE_TEST_CASE("one large motion through a corner finds both crossings in order",
                   "[surface][crossing]", float, double) {
  using T = TestType;
  auto held = held_block<T>();
  auto const box = block<T>();
  // In through the top, out through the side, in one step of 6 mm = 3 cells.
  Vec3<T> const p = vec<T>(T(0.0431), T(0.0163), box.high[2] + T(0.001)),
                q = vec<T>(T(0.0471), T(0.0163), box.high[2] - T(0.003));
  auto const found = crossings(held.sheet(), held.columns(), p, q);
  REQUIRE(found.count == 2);
  REQUIRE_FALSE(found.list[0].leaving);
  REQUIRE(found.list[1].leaving);
  REQUIRE(position(held.sheet(), found.list[0].mark)[2] == Approx(box.high[2]).epsilon(1e-6));
  REQUIRE(position(held.sheet(), found.list[1].mark)[0] == Approx(box.high[0]).epsilon(1e-6));
  REQUIRE_FALSE(found.more);
  // More than the list holds: the first are kept, and it is said.
  auto const one = crossings<1>(held.sheet(), held.columns(), p, q);
  REQUIRE(one.more);
  REQUIRE(one.count == 1);
  REQUIRE_FALSE(one.list[0].leaving);
}

TEMPLATE_TEST_CASE("distance, side, nearest point and normal", "[surface][distance]", float,
                   double) {
  using T = TestType;
  auto held = held_block<T>();
  auto const sheet = held.sheet();
  auto const columns = held.columns();
  auto const box = block<T>();
  std::mt19937 rng(4);
  T const reach = T(0.003);
  int found = 0;
  for (int i = 0; i < test::repeats(4000); ++i) {
    auto const x = uniform(rng, vec<T>(0, 0, 0), vec<T>(T(0.052), T(0.032), T(0.03)));
    auto const s = nearest_on_sheet(sheet, columns, x, reach);
    T const exact = box.distance(x);
    if (abs(exact) < T(1e-6)) continue;
    REQUIRE(s.inside == (exact < 0));
    REQUIRE(s.found == (abs(exact) < reach));
    if (!s.found) {
      REQUIRE(abs(s.distance) == reach);
      continue;
    }
    ++found;
    REQUIRE(s.distance == Approx(exact).margin(20 * epsilon<T> * T(0.05)));
    REQUIRE(norm(s.point - position(sheet, s.mark)) == T(0));
    REQUIRE(norm(s.normal) == Approx(1));
    // Along the normal the distance grows.
    T const h = T(2e-5);
    REQUIRE(box.distance(x + h * s.normal) ==
            Approx(exact + h).margin(T(0.02) * h + 20 * epsilon<T> * T(0.05)));
  }
  REQUIRE(found > test::repeats(500));
}

TEMPLATE_TEST_CASE(
    "columns find what a test of all triangles finds, after motion within the margin too",
    "[surface][columns]", float, double) {
  using T = TestType;
  auto held = held_block<T>();
  bend(held);
  // Move by less than the margin without a rebuild.
  auto const s = held.sheet();
  for (std::int64_t i = 0; i < s.vertices; ++i)
    s.vertex.set(i, s.vertex(i) + vec<T>(T(0.0003), T(-0.00035), T(0.0004)));
  auto const columns = held.columns();
  std::mt19937 rng(5);
  for (int i = 0; i < test::repeats(400); ++i) {
    auto const x = uniform(rng, block<T>().low, block<T>().high + vec<T>(0, 0, T(0.003)));
    auto const near = nearest_on_sheet(s, columns, x, T(0.004));
    auto const all = mark_at(s, x);
    T const d = norm(x - position(s, all));
    if (d < T(0.0035)) {
      REQUIRE(near.found);
      REQUIRE(abs(near.distance) == d);
    }
    // The parity by brute force.
    int crossed = 0;
    auto const line = SheetLine<T>::along(x, 2);
    for (std::int64_t k = 0; k < s.triangles; ++k) {
      auto const t = s.triangle(k);
      auto const hit = cross_projected(line.project(t.a), line.project(t.b), line.project(t.c));
      crossed += hit.hit && hit.z > T(0);
    }
    REQUIRE(near.inside == (crossed % 2 == 1));
  }
  // Built twice, the lists are the same.
  auto const before = held.items.template planes<sheet::Item>();
  REQUIRE(held.columns().build(held.sheet()) == 0);
  auto const once = held.items.template planes<sheet::Item>();
  REQUIRE(held.columns().build(held.sheet()) == 0);
  REQUIRE(once == held.items.template planes<sheet::Item>());
}

namespace {
// Lanes that come in the opposite order.
struct Backwards : mpmpbd::Solo {
  template <class F> void each(int n, F const& f) const {
    while (n-- > 0) f(n);
  }
};
}  // namespace

// Points and paths on a grid of half edges meet many triangles at the same place.
TEST_CASE("no question to the sheet hangs on the order of the lists", "[surface][columns]") {
  auto held = held_block<float>();
  auto const sheet = held.sheet();
  auto const in_order = held.columns();
  auto const n = static_cast<std::size_t>(in_order.columns()) + 1;
  std::vector<int> first(n, 77), item(static_cast<std::size_t>(in_order.capacity), 77);
  auto const backwards = make_columns(
      in_order.origin, 1 / in_order.inverse_width, in_order.count[0], in_order.count[1],
      in_order.margin, IntegerRow{first.data()}, IntegerRow{item.data()}, in_order.capacity);
  REQUIRE(backwards.build(Backwards{}, sheet) == 0);
  bool differ = false;
  for (std::size_t c = 0; c < n; ++c) {
    REQUIRE(first[c] == in_order.first(std::int64_t(c)));
    if (c == 0) continue;
    std::vector<int> list(item.begin() + first[c - 1], item.begin() + first[c]), other;
    for (int k = first[c - 1]; k < first[c]; ++k)
      other.push_back(static_cast<int>(in_order.item(k)));
    differ |= list != other;
    std::sort(list.begin(), list.end());
    std::sort(other.begin(), other.end());
    REQUIRE(list == other);
  }
  REQUIRE(differ);
  auto const b = block<float>();
  int near = 0, crossed = 0;
  for (int i = 0; i < 21; ++i)
    for (int j = 0; j < 21; ++j) {
      auto const share = [](int k) { return float(k) / 20; };
      Vec3<float> const size = b.high - b.low;
      auto const x =
          vec(b.low[0] + share(i) * size[0], b.low[1] + share(j) * size[1], b.high[2] + 0.0005f);
      auto const one = nearest_on_sheet(sheet, in_order, x, 0.004f),
                 other = nearest_on_sheet(sheet, backwards, x, 0.004f);
      near += one.found;
      REQUIRE(one.mark.triangle == other.mark.triangle);
      REQUIRE(one.distance == other.distance);
      auto const through = x - vec(0.0f, 0.0f, 2 * size[2]);
      auto const here = crossings(sheet, in_order, x, through),
                 there = crossings(sheet, backwards, x, through);
      crossed += here.count;
      REQUIRE(here.count == there.count);
      for (int k = 0; k < here.count; ++k)
        REQUIRE(here.list[k].mark.triangle == there.list[k].mark.triangle);
    }
  REQUIRE(near > 400);
  REQUIRE(crossed > 600);
}

TEST_CASE("too few items for the columns sets the overflow bit and writes nothing beyond",
          "[surface][columns]") {
  auto const mesh = box_sheet(block<double>(), Vec3<int>{{20, 10, 10}});
  Held<double> held(mesh, 0.002, 0.0005, {{0.0, 0.0}}, 26, 16, 500);
  REQUIRE(has(held.faults, Fault::overflow));
  auto const columns = held.columns();
  for (std::int64_t c = 0; c < columns.columns(); ++c) {
    REQUIRE(columns.first(c) <= columns.first(c + 1));
    REQUIRE(columns.first(c + 1) <= 500);
  }
  // Environment 0 was not touched.
  auto const& plane = held.items.planes<sheet::Item>();
  for (std::size_t i = 0; i < 500; ++i) REQUIRE(plane[i] == 0);
}

TEMPLATE_TEST_CASE("tracers and marks move with the tissue", "[surface][advect]", float, double) {
  using T = TestType;
  auto held = held_block<T>();
  auto s = held.sheet();
  auto const mark = mark_at(s, vec<T>(T(0.0201), T(0.0163), T(0.0245)));
  auto const start = position(s, mark);
  REQUIRE(norm(start - vec<T>(T(0.0201), T(0.0163), T(0.024))) < T(1e-8));
  T const volume = enclosed_volume(s);
  // A rigid turn about z and a shift: volume and shape stay.
  T const dt = T(1e-4);
  Vec3<T> const centre = block<T>().centre(), omega = vec<T>(0, 0, T(3));
  for (int step = 0; step < 100; ++step)
    for (std::int64_t i = 0; i < s.vertices; ++i)
      advect(
          s.vertex, i,
          [&](Vec3<T> const& x) { return cross(omega, x - centre) + vec<T>(T(0.1), 0, 0); }, dt);
  REQUIRE(enclosed_volume(s) == Approx(volume).epsilon(2e-4));
  REQUIRE(norm(position(s, mark) - start) > T(8e-4));
  // The affine motion of the mark is that of its place (explicit Euler, exact for affine fields).
  auto x = start;
  for (int step = 0; step < 100; ++step)
    x += dt * (cross(omega, x - centre) + vec<T>(T(0.1), 0, 0));
  REQUIRE(norm(position(s, mark) - x) < T(400) * epsilon<T> * T(0.05));
}

TEMPLATE_TEST_CASE(
    "the picture of a sheet has its triangles, unit normals outwards, and sharp edges",
    "[surface][picture]", float, double) {
  using T = TestType;
  auto held = held_block<T>();
  render::Mesh mesh;
  for (int again = 0; again < 2; ++again) picture_of(held.sheet(), mesh);
  REQUIRE(mesh.triangles.size() == static_cast<std::size_t>(held.sheet().triangles));
  REQUIRE(mesh.normals.size() == mesh.positions.size());
  for (auto const& t : mesh.triangles) {
    Vec3<float> const& a = mesh.positions[static_cast<std::size_t>(t[0])];
    auto const n = direction(cross(mesh.positions[static_cast<std::size_t>(t[1])] - a,
                                   mesh.positions[static_cast<std::size_t>(t[2])] - a));
    for (int c = 0; c < 3; ++c)
      REQUIRE(dot(n, mesh.normals[static_cast<std::size_t>(t[c])]) > 0.999f);
  }
}
