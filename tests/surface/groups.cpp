// A group of lanes gets the answers of one lane, bit by bit, however many lanes it has.
#include "catch.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <random>

#include "held_sheet.hpp"
#include "support/lanes.hpp"
#include "support/sanitized.hpp"

#include <mpmpbd/surface/channel.hpp>

using namespace mpmpbd;

namespace {

template <class T> bool same(Vec3<T> const& a, Vec3<T> const& b) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}
template <class T> bool same(SurfacePoint<T> const& a, SurfacePoint<T> const& b) {
  return a.found == b.found && a.inside == b.inside && a.distance == b.distance &&
         a.mark.triangle == b.mark.triangle && a.mark.weights[0] == b.mark.weights[0] &&
         a.mark.weights[1] == b.mark.weights[1] && same(a.point, b.point) &&
         same(a.normal, b.normal);
}

// Anywhere in and around the block; on a vertex, the middle of an edge and of a face, and straight above and below
// them, where several triangles are equally near; too far from the surface; outside of the columns.
template <class T, class S> std::vector<Vec3<T>> places(S const& sheet) {
  std::vector<Vec3<T>> x;
  std::mt19937 rng(6);
  std::uniform_real_distribution<double> u;
  for (int i = 0; i < test::repeats(40); ++i)
    x.push_back(vec<T>(T(0.052 * u(rng)), T(0.032 * u(rng)), T(0.03 * u(rng))));
  for (std::int64_t k = 5; k < sheet.triangles; k += test::sanitized ? 797 : 97) {
    auto const t = sheet.triangle(k);
    for (auto const& on : {t.a, T(0.5) * (t.a + t.b), T(1) / T(3) * (t.a + t.b + t.c)})
      for (T h : {T(0), T(0.0005), T(-0.0005)}) x.push_back(on + vec<T>(0, 0, h));
  }
  x.push_back(block<T>().centre());
  x.push_back(vec<T>(T(0.026), T(0.016), T(0.026)));  // the reach away, but for rounding
  x.push_back(vec<T>(T(-5), T(0.01), T(0.03)));
  return x;
}

}  // namespace

TEMPLATE_TEST_CASE("a group finds side and nearest point of one lane", "[surface][group]", float,
                   double) {
  using T = TestType;
  auto held = held_block<T>();
  auto const sheet = held.sheet();
  auto const columns = held.columns();
  T const reach = T(0.002);
  auto const x = places<T>(sheet);
  std::vector<SurfacePoint<T>> expected;
  for (auto const& p : x) expected.push_back(nearest_on_sheet(sheet, columns, p, reach));
  auto const count = [&](auto const& is) {
    return std::count_if(expected.begin(), expected.end(), is);
  };
  REQUIRE(count([](auto const& s) { return s.found; }) > 10);
  REQUIRE(count([](auto const& s) { return !s.found; }) > 2);
  REQUIRE(count([](auto const& s) { return s.found && s.distance == T(0); }) > 1);
  for (int lanes : {1, 5, 32}) {
    std::atomic<int> wrong{0};
    test::run_on_lanes(lanes, [&](auto const& lane) {
      for (std::size_t i = 0; i < x.size(); ++i) {
        wrong += !same(nearest_on_sheet(lane, sheet, columns, x[i], reach), expected[i]);
        wrong += is_inside(lane, sheet, columns, x[i]) != expected[i].inside;
      }
    });
    CHECK(wrong == 0);
  }
}

TEST_CASE("of equally near triangles a group takes the lowest number, as one lane does",
          "[surface][group]") {
  auto held = held_block<double>();
  auto const sheet = held.sheet();
  auto const columns = held.columns();
  // Above a vertex of the flat top all triangles around it are exactly as near.
  std::int64_t v = 0;
  while (sheet.vertex(v)[2] != block<double>().high[2] ||
         block<double>().distance(sheet.vertex(v) - vec(0.0, 0.0, 0.002)) > -0.0019)
    ++v;
  Vec3<double> const x = sheet.vertex(v) + vec(0.0, 0.0, 0.001);
  std::vector<std::int64_t> around;
  for (std::int64_t k = 0; k < sheet.triangles; ++k) {
    auto const c = sheet.corners(k);
    if (c[0] == v || c[1] == v || c[2] == v) around.push_back(k);
  }
  REQUIRE(around.size() >= 4);
  for (int lanes : {1, 5, 32}) {
    std::atomic<int> wrong{0};
    test::run_on_lanes(lanes, [&](auto const& lane) {
      wrong += nearest_on_sheet(lane, sheet, columns, x, 0.002).mark.triangle != around.front();
    });
    CHECK(wrong == 0);
  }
}

TEST_CASE("the lanes of a group share the triangles of a rectangle of columns",
          "[surface][columns][group]") {
  auto held = held_block<float>();
  auto const columns = held.columns();
  auto const low = vec<float>(0.011f, 0.009f, 0), high = vec<float>(0.0191f, 0.0132f, 0);
  std::vector<std::int64_t> expected;
  for (int j = columns.column(1, low[1]); j <= columns.column(1, high[1]); ++j)
    for (int i = columns.column(0, low[0]); i <= columns.column(0, high[0]); ++i)
      for (auto k = columns.first(columns.index(i, j)); k < columns.first(columns.index(i, j) + 1);
           ++k)
        expected.push_back(columns.item(k));
  REQUIRE(expected.size() > 100);
  std::vector<std::int64_t> seen;
  columns.for_each(low, high, [&](std::int64_t k) { seen.push_back(k); });
  CHECK(seen == expected);
  std::sort(expected.begin(), expected.end());
  for (int lanes : {5, 32}) {
    std::mutex one_at_a_time;
    seen.clear();
    test::run_on_lanes(lanes, [&](auto const& lane) {
      columns.for_each(lane, low, high, [&](std::int64_t k) {
        std::lock_guard const lock(one_at_a_time);
        seen.push_back(k);
      });
    });
    std::sort(seen.begin(), seen.end());
    CHECK(seen == expected);
  }
}

TEMPLATE_TEST_CASE("a group is as far from a track as one lane", "[channel][group]", float,
                   double) {
  using T = TestType;
  Table<T, Channels, channel::State> channels(1, 2);
  Table<T, ChannelPoints, channel::PointState> track(1, 2 * 40);
  auto const set = channel_set(channels.view(), track.view(), std::int64_t{0});
  REQUIRE(set.open(0, {0, {}}, vec<T>(0, 0, 0)) == 0);
  std::vector<Vec3<T>> x{vec<T>(0, 0, 0), vec<T>(T(0.1), T(0.3), T(-0.2))};
  for (int points = 1; points < 40; points += 13) {
    while (set.track_points(0) < points) {
      T const a = T(0.1) * T(set.track_points(0));
      REQUIRE(set.append(0, vec<T>(a, sin(a), cos(T(3) * a))) == 0);
    }
    x.push_back(set.track(0, points / 2));  // as near to the piece before as to the one after
    for (int lanes : {1, 5, 32}) {
      std::atomic<int> wrong{0};
      test::run_on_lanes(lanes, [&](auto const& lane) {
        for (auto const& p : x) {
          T const d = set.distance_to_track(0, p);
          wrong += set.distance_to_track(lane, 0, p) != d;
          wrong += !set.near_track(lane, 0, p, d) || set.near_track(lane, 1, p, T(9));
        }
      });
      CHECK(wrong == 0);
    }
  }
}
