// Scripted and commanded motion: exact poses, consistent velocities, smooth starts, refusals.
#include "catch.hpp"

#include <mpmpbd/needle/kinematic.hpp>
#include <mpmpbd/needle/points.hpp>
#include <mpmpbd/needle/suture_path.hpp>

using namespace mpmpbd;
using Catch::Matchers::Contains;

namespace {
template <class T> using NeedleTable = Table<T, Needles, needle::State>;

// Preset `paper`: z is up, the surface is at z = 1.
SuturePath paper() {
  return SuturePath::between(vec(0.7, 0.5, 1.0), vec(1.3, 0.5, 1.0), vec(0.0, 0.0, 1.0), 0.32);
}
Arc<double> paper_arc() { return {0.32, 3.141592653589793, 0.02, 0.1}; }
}  // namespace

TEST_CASE("progress is smooth, monotonic and ends at one", "[needle][script]") {
  for (double ramp : {0.01, 0.1, 0.37, 0.5}) {
    REQUIRE(smooth_progress(-1.0, ramp) == 0.0);
    REQUIRE(smooth_progress(0.0, ramp) == 0.0);
    REQUIRE(smooth_progress(1.0, ramp) == 1.0);
    REQUIRE(smooth_progress(7.0, ramp) == 1.0);
    REQUIRE(smooth_progress(0.5, ramp) == Approx(0.5).epsilon(1e-14));
    double const h = 1e-4;
    double before = 0.0, speed_before = 0.0, peak = 0.0;
    for (int i = 1; i <= 10000; ++i) {
      double const p = smooth_progress(i * h, ramp);
      double const speed = (p - before) / h;
      REQUIRE(p >= before);
      REQUIRE(std::abs(speed - speed_before) <= 1.6 * h / ramp / (1.0 - ramp));  // no jump of speed
      peak = std::max(peak, speed);
      before = p;
      speed_before = speed;
    }
    REQUIRE(peak == Approx(1.0 / (1.0 - ramp)).epsilon(1e-4));
    REQUIRE(speed_before < 3.0 * h / ramp);
  }
}

TEST_CASE("the path of preset paper", "[needle][path]") {
  auto const p = paper();
  REQUIRE(p.height == Approx(0.1114).epsilon(1e-3));
  REQUIRE(p.angle * 180 / 3.14159265358979 == Approx(139.3).epsilon(1e-3));
  REQUIRE(p.depth == Approx(0.2086).epsilon(1e-3));
  REQUIRE(norm(p.centre - vec(1.0, 0.5, 1.0 + p.height)) < 1e-15);
  // The tip starts above the surface, is at the markers at the right angles, and is deepest half
  // way.
  Vec3<double> const tip = vec(0.32, 0.0, 0.0);
  REQUIRE(to_world(p.pose(-0.35), tip)[2] > 1.05);
  REQUIRE(norm(to_world(p.pose(0.0), tip) - p.entry) < 1e-15);
  REQUIRE(norm(to_world(p.pose(p.angle), tip) - p.exit) < 1e-15);
  REQUIRE(norm(to_world(p.pose(p.angle / 2), tip) - vec(1.0, 0.5, 1.0 - p.depth)) < 1e-15);
  // The wire follows the tip: at the moment of exit it fills the channel, back to the entry and
  // past it.
  auto const arc = paper_arc();
  REQUIRE(norm(to_world(p.pose(p.angle), arc.point(p.angle * 0.32)) - p.entry) < 1e-15);
  // The tip moves along its tangent.
  auto const later = to_world(p.pose(1e-6), tip) - to_world(p.pose(-1e-6), tip);
  REQUIRE(norm(direction(later) - quaternion::rotate(p.pose(0.0).orientation, arc.tangent(0.0))) <
          1e-9);
}

TEST_CASE("a path follows markers that have moved and turned", "[needle][path]") {
  auto const q = quaternion::from_rotation_vector(vec(0.4, -1.0, 2.0));
  auto const p = paper();
  auto const r = SuturePath::between(quaternion::rotate(q, p.entry), quaternion::rotate(q, p.exit),
                                     quaternion::rotate(q, vec(0.3, 0.0, 1.0)), 0.32);
  REQUIRE(norm(r.centre - quaternion::rotate(q, p.centre)) < 1e-14);
  REQUIRE(norm(r.axis - quaternion::rotate(q, p.axis)) < 1e-14);
  REQUIRE(r.angle == Approx(p.angle).epsilon(1e-13));
}

TEMPLATE_TEST_CASE("the suture script: no gap between substeps, on its own circle, free at the end",
                   "[needle][script]", float, double) {
  using T = TestType;
  auto const path = paper();
  auto const arc = paper_arc();
  SutureMotion how;
  how.pull = vec(0.05, 0.0, 0.2);
  auto const script = suture_script(path, arc, how);
  REQUIRE(script.duration() == Approx(10.0).epsilon(1e-14));

  NeedleTable<T> table(2, 1);
  auto const view = table.view();
  Arc<T> const wire{T(arc.radius), T(arc.angle), T(arc.wire_radius), T(arc.taper)};
  auto const points = ArcPoints<T>::over(wire, T(0.1));
  std::int64_t const item = 1;
  kinematic::reset(view, item, script);

  int const steps = 2500, substeps = 4;
  double const step = 0.004;
  T gap = 0, off_circle = 0, peak_speed = 0, jump = 0;
  Vec3<T> last_velocity{};
  for (int i = 0; i < steps * substeps; ++i) {
    double const t0 = i * (step / substeps), t1 = (i + 1) * (step / substeps);
    T const dt = T(t1 - t0);
    kinematic::begin_scripted(view, item, script, t0, t1);
    auto const pose = needle::pose(view, item);
    auto const sweep = Sweep<T>::of(pose, needle::twist(view, item), dt);
    auto const tip = needle_point(wire, points, 0, pose, sweep);
    auto const end = swage_point(wire, pose, sweep);
    kinematic::finish_scripted(view, item, script, t1);
    auto const next = needle::pose(view, item);
    gap = max(gap, norm(tip.position + dt * tip.velocity - to_world(next, wire.point(T(0)))));
    gap = max(gap,
              norm(end.position + dt * end.velocity - to_world(next, wire.point(wire.length()))));
    if (t1 <= 6.0)
      off_circle =
          max(off_circle,
              abs(norm(to_world(next, wire.point(T(0))) - cast<T>(path.centre)) - wire.radius));
    peak_speed = max(peak_speed, norm(tip.velocity));
    jump = max(jump, norm(tip.velocity - last_velocity));
    last_velocity = tip.velocity;
  }
  INFO("gap " << gap << " off circle " << off_circle << " peak " << peak_speed << " jump " << jump);
  REQUIRE(gap <= 12 * epsilon<T>);
  REQUIRE(off_circle <= 8 * epsilon<T>);
  REQUIRE(peak_speed < T(0.5));
  REQUIRE(jump < T(0.01));
  auto const pose = needle::pose(view, item);
  // Free: all of the needle is above the surface, and pulled on.
  for (int i = 0; i < points.count(); ++i)
    REQUIRE(needle_point(wire, points, i, pose, Sweep<T>{}).position[2] > T(1.2));
  // Environment 0 was never written.
  REQUIRE(table.template get<needle::Orientation>(0, 0) == Quaternion<T>{});
  // The same script gives the same pose again: nothing is remembered outside the fields.
  kinematic::reset(view, item, script);
  kinematic::finish_scripted(view, item, script, 10.0);
  REQUIRE(needle::pose(view, item).position == pose.position);
  REQUIRE(needle::pose(view, item).orientation == pose.orientation);
}

TEST_CASE("driving ends with the tip out and the blunt end not yet in", "[needle][script]") {
  auto const path = paper();
  auto const arc = paper_arc();
  auto const script = suture_script(path, arc);
  REQUIRE(to_world(script.pose(0.0), arc.point(0.0))[2] > 1.05);
  REQUIRE(to_world(script.pose(0.0), arc.point(arc.length()))[2] > 1.05);
  REQUIRE(to_world(script.pose(6.0), arc.point(0.0))[2] > 1.1);
  REQUIRE(to_world(script.pose(6.0), arc.point(arc.length()))[2] > 1.0);
  double deepest = 2.0;
  for (int i = 0; i <= 1000; ++i)
    deepest = std::min(deepest, to_world(script.pose(i * 0.006), arc.point(0.0))[2]);
  REQUIRE(deepest == Approx(1.0 - path.depth).epsilon(1e-4));
}

TEST_CASE("50 scripted turns end where they began", "[needle][script]") {
  Pose<double> const start{vec(0.02, -0.3, 0.11),
                           quaternion::from_rotation_vector(vec(1.0, 2.0, 3.0))};
  auto const script =
      Script::at(start).turn(start.position, vec(0.0, 2.0, 1.0), 100 * 3.141592653589793, 50.0);
  REQUIRE(script.end().position == start.position);
  REQUIRE(quaternion::distance(script.end().orientation, start.orientation) < 1e-12);
  for (int i = 0; i <= 5000; ++i) REQUIRE(script.pose(i * 0.01).position == start.position);
  // About a pivot elsewhere the distance to it stays.
  auto const far =
      Script::at(start).turn(vec(1.0, 1.0, 1.0), vec(1.0, 0.0, 0.0), 100 * 3.141592653589793, 50.0);
  double const r = norm(start.position - vec(1.0, 1.0, 1.0));
  for (int i = 0; i <= 500; ++i)
    REQUIRE(norm(far.pose(i * 0.1).position - vec(1.0, 1.0, 1.0)) == Approx(r).epsilon(1e-14));
}

TEST_CASE("moves follow each other; before and after the script the needle rests",
          "[needle][script]") {
  Pose<double> const start{vec(1.0, 2.0, 3.0), quaternion::identity<double>()};
  Pose<double> const goal{vec(0.0, 1.0, -1.0),
                          quaternion::from_rotation_vector(vec(0.1, 0.2, 3.0))};
  auto const script =
      Script::at(start).hold(1.0).go_to(goal, 2.0).shift(vec(0.0, 0.0, 0.5), 1.0, 0.5);
  REQUIRE(script.pose(-5.0).position == start.position);
  REQUIRE(script.pose(0.7).position == start.position);
  REQUIRE(norm(script.pose(3.0).position - goal.position) < 1e-15);
  REQUIRE(quaternion::distance(script.pose(3.0).orientation, goal.orientation) < 1e-14);
  REQUIRE(norm(script.pose(99.0).position - vec(0.0, 1.0, -0.5)) < 1e-15);
  REQUIRE(norm(script.twist(5.0, 5.1).linear) == 0.0);
  REQUIRE(norm(script.twist(0.2, 0.9).angular) == 0.0);
}

TEMPLATE_TEST_CASE("a command that jumps is followed with bounded acceleration", "[needle][script]",
                   float, double) {
  using T = TestType;
  NeedleTable<T> table(1, 1);
  auto const view = table.view();
  kinematic::reset(view, 0, Script::at(Pose<double>::identity()));
  Twist<T> const wanted{vec<T>(T(0.3), T(0), T(-0.4)), vec<T>(T(0), T(2), T(0))};
  T const dt = T(1e-3);
  for (int i = 0; i < 250; ++i) {
    auto const before = needle::twist(view, 0);
    kinematic::begin_commanded(view, 0, wanted, T(4), T(20), dt);
    auto const now = needle::twist(view, 0);
    REQUIRE(norm(now.linear - before.linear) <= T(4) * dt * (1 + 1000 * epsilon<T>));
    REQUIRE(norm(now.angular - before.angular) <= T(20) * dt * (1 + 1000 * epsilon<T>));
    kinematic::finish_commanded(view, 0, dt);
  }
  REQUIRE(needle::twist(view, 0).linear == wanted.linear);
  REQUIRE(needle::twist(view, 0).angular == wanted.angular);
}

TEMPLATE_TEST_CASE("a steered needle meets a marker that has moved, without a jump",
                   "[needle][steering]", float, double) {
  using T = TestType;
  auto const path = paper();
  auto const script = suture_script(path, paper_arc());
  Table<T, Needles, needle::SteeredState> table(1, 1);
  auto const view = table.view();
  view.template set<needle::Offset>(0, vec(T(1), T(0), T(0)));  // of an episode before
  kinematic::reset(view, 0, script);
  Vec3<double> const moved_exit = path.exit + vec(0.03, 0.02, 0.025);
  auto const offset = path.offset_to(moved_exit);
  REQUIRE(norm(path.offset_to(path.exit)) < 1e-15);
  REQUIRE(std::abs(norm(moved_exit - path.centre - offset) - path.radius) < 1e-15);
  REQUIRE(std::abs(dot(moved_exit - path.centre - offset, path.axis)) < 1e-15);
  REQUIRE(norm(offset) < norm(moved_exit - path.exit));
  T closest = T(1), gap = T(0);
  double const dt = 1e-3;
  for (int i = 0; i < 6000; ++i) {
    auto const wanted = i < 2000 ? Vec3<T>{} : cast<T>(offset);
    auto const before = needle::pose(view, 0);
    kinematic::begin_steered(view, 0, script, i * dt, (i + 1) * dt, wanted, T(0.02));
    auto const twist = needle::twist(view, 0);
    kinematic::finish_steered(view, 0, script, (i + 1) * dt);
    auto const after = needle::pose(view, 0);
    gap = max(gap, norm(before.position + T(dt) * twist.linear - after.position));
    REQUIRE(norm(after.position - before.position) <= T(0.02 * dt) + 8 * epsilon<T>);
    if (i < 2000) REQUIRE(after.position == cast<T>(script.pose((i + 1) * dt).position));
    closest =
        min(closest, norm(to_world(after, vec<T>(T(0.32), T(0), T(0))) - cast<T>(moved_exit)));
  }
  REQUIRE(gap <= 8 * epsilon<T>);
  REQUIRE(closest < T(2e-4));  // the tip moves 0.2 mm per step there
}

TEST_CASE("impossible scripts and paths are refused", "[needle][script]") {
  Pose<double> const start = Pose<double>::identity();
  auto script = [&] { return Script::at(start); };
  REQUIRE_THROWS_WITH(Script::at({vec(0.0, 0.0, 0.0), {}}), Contains("Script: orientation"));
  REQUIRE_THROWS_WITH(Script::at({vec(0.0, std::nan(""), 0.0), quaternion::identity<double>()}),
                      Contains("start position"));
  REQUIRE_THROWS_WITH(script().hold(0.0),
                      Contains("duration = 0.000000 s") && Contains("(0, inf)"));
  REQUIRE_THROWS_WITH(script().shift(vec(1.0, 0.0, 0.0), 1.0, 0.6),
                      Contains("ramp = 0.600000") && Contains("(0, 0.5]"));
  REQUIRE_THROWS_WITH(script().turn(vec(0.0, 0.0, 0.0), vec(0.0, 0.0, 0.0), 1.0, 1.0),
                      Contains("axis"));
  REQUIRE_THROWS_WITH(script().turn(vec(0.0, 0.0, 0.0), vec(0.0, 0.0, 1.0), INFINITY, 1.0),
                      Contains("turn"));
  auto full = script();
  for (int i = 0; i < Script::capacity; ++i) full.hold(1.0);
  REQUIRE_THROWS_WITH(full.hold(1.0), Contains("more than 8 moves"));

  auto const up = vec(0.0, 0.0, 1.0);
  REQUIRE_THROWS_WITH(SuturePath::between(vec(-0.3, 0.0, 0.0), vec(0.3, 0.0, 0.0), up, 0.29),
                      Contains("needle radius = 0.290000 m") && Contains("[0.3, inf)"));
  REQUIRE_THROWS_WITH(SuturePath::between(up, up, up, 0.3), Contains("half the marker distance"));
  REQUIRE_THROWS_WITH(
      SuturePath::between(vec(-0.3, 0.0, 0.0), vec(0.3, 0.0, 0.0), vec(1.0, 0.0, 0.0), 0.32),
      Contains("normal of the surface"));
  auto arc = paper_arc();
  arc.angle = 4.5;  // does not fit above the surface
  REQUIRE_THROWS_WITH(suture_script(paper(), arc), Contains("free angle beside the needle"));
  arc = paper_arc();
  arc.radius = 0.33;
  REQUIRE_THROWS_WITH(suture_script(paper(), arc), Contains("radius = 0.330000 m"));
  SutureMotion how;
  how.approach = 1.0;
  REQUIRE_THROWS_WITH(suture_script(paper(), paper_arc(), how),
                      Contains("approach = 1.000000 rad"));
}
