// seconds: 5
// Threads with frames: what joints measure, what solvers make of it, and of verification.md B24 (folds, turns that are
// counted) and B25 (quaternions that are zero, unnormalised or of the other sign).
#include "catch.hpp"
#include "pbd/framed.hpp"
#include "physics/writhe.hpp"

#include <Eigen/Dense>

#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/scene/plan.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/testing/samples.hpp>

using namespace rods;
using Catch::Matchers::Contains;

namespace {
template <class Solver> struct With : Pbd<Cosserat, Solver> {};
struct Plain : Pbd<Constraints<Distance, Bend>> {};
RodMaterial const soft{3e6, 0.8e-3, 1100};
double const l = 5e-3;
V3 const d3{{0, 0, 1}};

Frame turn(V3 const& axis, double angle) {
  return quaternion::from_axis_angle(direction(axis), angle);
}
// A thread that zigzags and twists a little; its first segment is held, or nothing is.
template <class Body>
RodAssembly<Body> crooked(int beads, bool hold, RestShape rest = RestShape::straight) {
  mpmpbd::testing::Samples samples(7);
  Line points;
  for (int i = 0; i < beads; ++i)
    points.push_back(vec(l * i, 0.0, 0.0) + 0.2 * l * samples.matrix<3>(-1.0, 1.0));
  auto const frames = twisted(frames_along(points), 1.7);
  RodAssembly<Body> rod;
  add_framed_thread(rod, points, frames, soft, rest);
  if (hold) rod.prescribe(0), rod.prescribe(1), rod.prescribe_frame(0);
  return rod;
}
}  // namespace

TEST_CASE("a body without frames stores none", "[constraint][frames]") {
  STATIC_REQUIRE(!Plain::has_frames);
  STATIC_REQUIRE(!contains<Plain::AllFields, frame::Orientation>);
  STATIC_REQUIRE(!contains<Plain::AllFields, frame::Previous>);
  STATIC_REQUIRE(!contains<Plain::AllFields, instance<Distance>::FrameIndex>);
  STATIC_REQUIRE(contains<With<Xpbd<2>>::AllFields, frame::AngularVelocity>);
  STATIC_REQUIRE(!contains<With<Xpbd<2>>::AllFields, instance<BendTwist>::Index>);
  STATIC_REQUIRE(contains<With<Jacobi<2>>::AllFields, frame::Correction>);
  STATIC_REQUIRE(!contains<Pbd<Constraints<Distance>, Jacobi<2>>::AllFields, frame::Correction>);
}

TEST_CASE("a bend is the angle between segments, up to pi, whatever the twist",
          "[constraint][frames]") {
  mpmpbd::testing::Samples samples(5);
  for (double bend : {1e-6, 0.3, 1.5, 3.0, 3.14})
    for (double twisting : {-3.1, -0.4, 0.0, 1e-7, 2.0, 3.1}) {
      Frame const first = turn(samples.unit_vector(), 2.0);
      V3 const axis = quaternion::rotate(turn(d3, samples.uniform(-3.0, 3.0)), vec(1.0, 0.0, 0.0));
      auto const second =
          quaternion::product(first, quaternion::product(turn(axis, bend), turn(d3, twisting)));
      auto const c = joint(first, second).value;
      CAPTURE(bend, twisting);
      CHECK(std::hypot(c[0], c[1]) == Approx(bend).epsilon(1e-8));
      CHECK(c[2] == Approx(twisting).margin(1e-12).epsilon(1e-8));
      // The same seen from the other end: everything changes its sign.
      CHECK(norm(joint(second, first).value + c) < 1e-12);
    }
}

TEST_CASE("frames carried along a curve have no twist, and turns add up", "[constraint][frames]") {
  Line helix;
  for (int i = 0; i < 40; ++i)
    helix.push_back(vec(3 * l * std::cos(0.5 * i), 3 * l * std::sin(0.5 * i), 0.3 * l * i));
  auto const frames = frames_along(helix);
  double carried = 0, added = 0;
  auto const more = twisted(frames, 9.0);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    carried = max(carried, abs(joint(frames[i - 1], frames[i]).value[2]));
    added += joint(more[i - 1], more[i]).value[2];
  }
  CHECK(carried < 1e-14);
  CHECK(added == Approx(9.0).epsilon(1e-12));
}

TEST_CASE("B25: q and -q are one frame, and its length does not count",
          "[constraint][frames][hard]") {
  mpmpbd::testing::Samples samples(9);
  for (int n = 0; n < 50; ++n) {
    Frame const a = turn(samples.unit_vector(), samples.uniform(-3.0, 3.0)),
                b = turn(samples.unit_vector(), samples.uniform(-3.0, 3.0));
    auto const same = joint(a, b), flipped = joint(-a, b), both = joint(-a, -b);
    CHECK(same.value == flipped.value);
    CHECK(same.value == both.value);
    CHECK(gradient<0>(same) == gradient<0>(flipped));
    CHECK(gradient<1>(same) == gradient<1>(flipped));
    auto const longer = joint(3.7 * a, 1e-3 * b);
    CHECK(norm(longer.value - same.value) < 1e-12);
    CHECK(norm(gradient<1>(longer) - gradient<1>(same)) < 1e-11 * norm(gradient<1>(same)));
  }
}

TEST_CASE("B25: a frame without length is refused when it is made, and feels nothing later",
          "[constraint][frames][hard]") {
  RodAssembly<With<Xpbd<4>>> rod;
  CHECK_THROWS_WITH(rod.add_frame({}, 1e-9), Contains("orientation") && Contains("not a rotation"));
  CHECK_THROWS_WITH(rod.add_frame({{1, std::nan(""), 0, 0}}, 1e-9), Contains("not a rotation"));
  CHECK_THROWS_WITH(rod.add_frame(quaternion::identity<double>(), 0.0), Contains("inertia = 0.0"));
  CHECK(rod.frames() == 0);
  rod.add_frame({{0, 0, 5, 0}}, 1e-9);
  CHECK(norm(rod.orientation(0)) == 1.0);

  auto const nothing = joint({}, turn(d3, 1.0));
  CHECK(norm(nothing.value) == 0.0);
  CHECK(norm(gradient<1>(nothing)) == 0.0);
  Rig<With<Xpbd<4>>, float> rig(crooked<With<Xpbd<4>>>(6, true));
  rig.store.set<frame::Orientation>(0, 3, {});
  for (int s = 0; s < 50; ++s) rig.step(1e-3);
  CHECK(rig.finite());
}

TEMPLATE_TEST_CASE("B25: the sign of a quaternion moves nothing", "[constraint][frames][hard]",
                   Xpbd<5>, Jacobi<5>, DirectFrames<2>) {
  auto const rod = crooked<With<TestType>>(9, true);
  Rig<With<TestType>> rig(rod), other(rod);
  for (std::int64_t f = 0; f < 8; f += 3)
    other.store.template set<frame::Orientation>(0, f, -frame_at(other, f));
  for (int s = 0; s < 30; ++s) rig.step(1e-3), other.step(1e-3);
  CHECK(distance(rig, other) < 1e-15);
  CHECK(norm(frame_at(rig, 3) + frame_at(other, 3)) < 1e-12);
}
namespace {
// A straight thread of 40 joints whose last frame has been turned against the held first one.
template <class Body> struct Turned {
  static constexpr int segments = 41;
  Rig<Body> rig;
  Frame start;

  explicit Turned(bool held_straight) : rig(thread(held_straight)) {
    start = frame_at(rig, segments - 1);
  }
  static RodAssembly<Body> thread(bool held_straight) {
    RodAssembly<Body> rod;
    add_framed_thread(rod, straight({{0, 0, 0}}, {{l * segments, 0, 0}}, segments + 1), soft);
    for (std::int64_t b = 0; b <= segments; ++b)
      if (held_straight || b < 2 || b >= segments - 1) rod.prescribe(b);
    rod.prescribe_frame(0);
    rod.prescribe_frame(segments - 1);
    return rod;
  }
  void turn_to(double angle) {
    rig.store.template set<frame::Orientation>(0, segments - 1,
                                               quaternion::product(start, turn(d3, angle)));
    rig.step(1e-3, 0.0);
  }
  // Twist, and writhe of the curve along the frames' own axes with its ends drawn out [rad].
  double link() const {
    V3 at = -1e6 * l * vec(1.0, 0.0, 0.0);
    Line points{at, {}};
    for (int f = 0; f < segments; ++f)
      points.push_back(points.back() + l * quaternion::rotate(frame_at(rig, f), d3));
    points.push_back(points.back() - at);
    double off = 0;
    for (auto const& p : points) off = max(off, std::hypot(p[1], p[2]));
    double const writhing = off > 1e-4 * l ? writhe(points) : 0.0;  // of a line: rounding only
    return total_twist(rig) + 2 * pi<double> * writhing;
  }
};
}  // namespace

// Sweeps that have not converged gather the twist at the end that is turned, and its joint passes pi: Xpbd<60> loses
// count here.
TEMPLATE_TEST_CASE("B24: a straight thread keeps count of ten turns", "[constraint][frames][hard]",
                   Jacobi<40>, DirectFrames<2>) {
  Turned<With<TestType>> thread(true);
  double worst = 0;
  int const steps = 3000;
  for (int s = 1; s <= steps; ++s) {
    double const imposed = 20 * pi<double> * s / steps;
    thread.turn_to(imposed);
    worst = max(worst, abs(total_twist(thread.rig) - imposed));
  }
  CHECK(worst < 1e-5);
  CHECK(thread.rig.finite());
}

// From four turns on it buckles, and twist becomes writhe.
TEST_CASE("B24: a free thread keeps count of ten turns as twist and writhe",
          "[constraint][frames][hard]") {
  Turned<With<DirectFrames<2>>> thread(false);
  double worst = 0, least_twist = 1;
  int const steps = 4000;
  for (int s = 1; s <= steps; ++s) {
    double const imposed = 20 * pi<double> * s / steps;
    thread.turn_to(imposed);
    if (s % 20) continue;
    worst = max(worst, abs(thread.link() - imposed));
    least_twist = std::min(least_twist, total_twist(thread.rig) / imposed);
  }
  CAPTURE(worst, least_twist);
  CHECK(worst < 1e-5);
  CHECK(least_twist < 1 - 1e-4);
  CHECK(thread.rig.faults == 0);
}

// The limit that BendTwist names: turns of one joint are counted modulo a whole one.
TEST_CASE("B24: the twist of one joint jumps from pi to -pi", "[constraint][frames][hard]") {
  Frame const first = turn(vec(1.0, 2.0, -1.0), 0.7);
  auto const twist_of = [&](double angle) {
    return joint(first, quaternion::product(first, turn(d3, angle))).value[2];
  };
  CHECK(twist_of(pi<double> - 1e-6) == Approx(pi<double> - 1e-6).epsilon(1e-9));
  CHECK(twist_of(pi<double> + 1e-6) == Approx(-pi<double> + 1e-6).epsilon(1e-9));
  CHECK(abs(twist_of(pi<double>)) == Approx(pi<double>).epsilon(1e-9));
  CHECK(abs(twist_of(2 * pi<double>)) < 1e-9);
}

TEMPLATE_TEST_CASE("B24: a framed thread folded by pi stays finite and opens",
                   "[constraint][frames][hard]", (std::pair<Xpbd<20>, float>),
                   (std::pair<Xpbd<20>, double>), (std::pair<DirectFrames<4>, float>),
                   (std::pair<DirectFrames<4>, double>)) {
  using Body = With<typename TestType::first_type>;
  using T = typename TestType::second_type;
  auto const line = straight({{0, 0, 0}}, {{4 * l, 0, 0}}, 5);
  RodAssembly<Body> rod;
  add_framed_thread(rod, line, soft);
  rod.prescribe(0), rod.prescribe(1), rod.prescribe_frame(0);
  Rig<Body, T> rig(rod);
  for (std::int64_t b = 3; b < 5; ++b)  // segments 2 and 3 lie on 1 and 0
    rig.store.template set<bead::Position>(0, b, rig.x(4 - b));
  // Half a turn about an axis of the cross-section: antiparallel, exactly.
  Frame const folded = quaternion::product(frame_at(rig, 1), Frame{{0, 1, 0, 0}});
  for (std::int64_t f = 2; f < 4; ++f)
    rig.store.template set<frame::Orientation>(0, f, cast<T>(folded));
  auto const at = joint(frame_at(rig, 1), frame_at(rig, 2));
  CHECK(std::hypot(at.value[0], at.value[1]) == Approx(pi<double>).epsilon(1e-6));
  CHECK(is_finite(gradient<1>(at)));
  for (int s = 0; s < 3000; ++s) {
    rig.step(1e-3, 0.0);
    for (std::int64_t b = 2; b < 5; ++b)
      rig.store.template set<bead::Velocity>(0, b, T(0.98) * rig.v(b));
    REQUIRE(rig.finite());
  }
  for (std::int64_t b = 1; b < 5; ++b) CHECK(double(norm(rig.x(b) - cast<T>(line[b]))) < 1e-2 * l);
}

TEST_CASE("rods with bad frames are refused with name and value",
          "[constraint][frames][builder][B13]") {
  RodAssembly<With<DirectFrames<2>>> rod;
  auto const line = straight({{0, 0, 0}}, {{0.02, 0, 0}}, 4);
  std::vector<Frame> const two(2, quaternion::identity<double>());
  CHECK_THROWS_WITH(add_framed_thread(rod, line, two, soft),
                    Contains("frames = 2") && Contains("3 segments"));
  CHECK(rod.beads() == 0);
  std::vector<Frame> turned_nowhere(3, quaternion::identity<double>());
  turned_nowhere.back() = {};
  CHECK_THROWS_WITH(add_framed_thread(rod, line, turned_nowhere, soft), Contains("frames"));
  CHECK(rod.beads() == 0);
  CHECK(rod.frames() == 0);
  add_framed_thread(rod, line, soft);
  auto const lone = rod.add_bead({{0.03, 0, 0}}, 1e-6);
  CHECK_THROWS_WITH(rod.add<StretchShear>({lone - 1, lone, 1}, {l, 0, 0}),
                    Contains("given twice at frame 1"));
  CHECK_THROWS_WITH(rod.add<BendTwist>({0, 3}, {}), Contains("frame 3 does not exist"));
  CHECK_THROWS_WITH(rod.add<BendTwist>({1, 1}, {}), Contains("frame 1 twice"));
  CHECK_THROWS_WITH(rod.add<BendTwist>({0, 2}, {}), Contains("do not follow each other"));
  CHECK_THROWS_WITH(rod.add<BendTwist>({0, 1}, {}), Contains("given twice"));
  CHECK_THROWS_WITH(rod.prescribe_frame(9), Contains("frame 9"));
  CHECK_THROWS_WITH(RodMaterial({3e6, 1e-3, 1100, 1.0, 0.51}).check(), Contains("poisson_ratio"));
}

TEST_CASE("a 3-0 thread twists as its wire does", "[constraint][frames][builder]") {
  RodMaterial const nylon{2e9, 0.115e-3, 1140};
  CHECK(nylon.torsional_stiffness() == Approx(1.96e-7).epsilon(2e-3));
  CHECK(nylon.torsional_stiffness() / nylon.bending_stiffness() == Approx(1 / 1.4));
}

// One frame on a spring of GJ/l: implicit Euler to rounding, as a spring between beads (A3.1).
TEMPLATE_TEST_CASE("a joint twists as an implicit spring", "[constraint][frames]", Xpbd<1>,
                   DirectFrames<1>) {
  using Body = With<TestType>;
  auto const line = straight({{0, 0, 0}}, {{2 * l, 0, 0}}, 3);
  RodAssembly<Body> rod;
  add_framed_thread(rod, line, twisted(frames_along(line), 0.2), soft);
  for (std::int64_t b = 0; b < 3; ++b) rod.prescribe(b);
  rod.prescribe_frame(0);
  Rig<Body> rig(rod);
  double const k = soft.torsional_stiffness() / l, I = soft.axial_inertia(l),
               h = 0.3 * std::sqrt(I / k);
  double x = 0.2, v = 0, worst = 0;
  for (int n = 0; n < 40; ++n) {
    double const next = (x + h * v) / (1 + h * h * k / I);
    v = (next - x) / h;
    x = next;
    rig.step(h, 0.0);
    worst = max(worst, abs(total_twist(rig) - x));
  }
  CHECK(worst < 1e-12);
  CHECK(rig.faults == 0);
}

TEST_CASE("a free thread with its rest shape stays where it is", "[constraint][frames]") {
  Line helix;
  for (int i = 0; i < 25; ++i)
    helix.push_back(vec(3 * l * std::cos(0.3 * i), 3 * l * std::sin(0.3 * i), 0.3 * l * i));
  using Body = With<DirectFrames<2>>;
  RodAssembly<Body> rod;
  add_framed_thread(rod, helix, twisted(frames_along(helix), 2.5), soft, RestShape::as_placed);
  Rig<Body> rig(rod);
  CHECK(rig.residual<StretchShear>() < 1e-15);
  CHECK(rig.residual<BendTwist>() < 1e-12);
  for (int s = 0; s < 100; ++s) rig.step(1e-3, 0.0);
  for (std::int64_t b = 0; b < 25; ++b)
    CHECK(norm(rig.x(b) - helix[static_cast<std::size_t>(b)]) < 1e-12);
}

TEST_CASE("solvers agree at convergence on a thread with frames, as far as gradients turn",
          "[constraint][frames][solver]") {
  // Each correction uses its own gradient, so paths differ by the square of the turn within a substep.
  auto gap = [](double speed) {
    double const h = 2e-4;
    auto run = [&]<class Solver>(Solver) {
      Rig<With<Solver>> rig(crooked<With<Solver>>(6, true, RestShape::as_placed));
      shake(rig, speed);
      rig.project(h);
      CHECK(rig.template residual<StretchShear>() < 1e-10);
      CHECK(rig.template residual<BendTwist>() < 1e-6);
      return rig;
    };
    auto const direct = run(DirectFrames<8>{});
    auto const seidel = run(Xpbd<6000>{});
    auto const jacobi = run(Jacobi<20000>{});
    return std::max(distance(direct, seidel), distance(direct, jacobi)) / (speed * h);
  };
  double const coarse = gap(0.4), fine = gap(0.1);
  CAPTURE(coarse, fine);
  CHECK(coarse < 2e-2);
  CHECK(fine < 0.3 * coarse);
}

namespace {
// The dense system of all segments and joints at one state: rows of three, columns of beads and then frames.
template <class AnyRig> Eigen::VectorXd dense_displacements(AnyRig& rig, double h) {
  auto env = rig.environment();
  auto const beads = rig.beads(), frames = frames_of(rig);
  auto const rows = 3 * (env.template live<Instances<StretchShear>>() +
                         env.template live<Instances<BendTwist>>());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, 3 * (beads + frames));
  Eigen::VectorXd w(J.cols()), alpha(rows), right(rows);
  Eigen::Index row = 0;
  auto add = [&]<class C>(std::type_identity<C>) {
    for (std::int64_t i = 0; i < env.template live<Instances<C>>(); ++i, row += 3) {
      auto const one = mpmpbd::detail::load_instance<C>(env, i);
      mpmpbd::detail::for_each_kept<C>([&]<class U, class I>(U, I) {
        bool const turns = std::is_same_v<U, unknown::Orientation>;
        auto const column = 3 * (one.slots[I::value] + (turns ? beads : 0));
        auto const& g = gradient<I::value>(one.at);
        for (int a = 0; a < 3; ++a)
          for (int c = 0; c < 3; ++c) J(row + a, column + c) = g(a, c);
        w.segment<3>(column).setConstant(one.weights[I::value]);
      });
      for (int a = 0; a < 3; ++a) {
        alpha(row + a) = one.compliance[a];
        right(row + a) = -one.at.value[a];
      }
    }
  };
  for_each_type(Cosserat::List{}, add);
  Eigen::MatrixXd A = h * h * J * w.asDiagonal() * J.transpose();
  A += Eigen::MatrixXd(alpha.asDiagonal());
  return h * h * (w.asDiagonal() * (J.transpose() * A.ldlt().solve(right)));
}
}  // namespace

TEST_CASE("the elimination with frames is the dense solve", "[constraint][frames][solver]") {
  using Body = With<DirectFrames<1>>;
  double const h = 7e-4;
  for (bool hold : {false, true}) {
    RodAssembly<Body> rod = crooked<Body>(11, hold);
    add_framed_thread(rod, straight({{0, 0.1, 0}}, {{0.02, 0.1, 0.01}}, 5), soft);  // a second one
    Rig<Body> rig(rod), before(rod);
    shake(rig, 0.05), shake(before, 0.05);
    Body::predict(Solo{}, before.environment(), Tick<double>{h, h, 0});
    auto const move = dense_displacements(before, h);
    rig.project(h);
    double worst = 0;
    for (std::int64_t b = 0; b < rig.beads(); ++b)
      for (int a = 0; a < 3; ++a)
        worst = max(worst, abs(rig.x(b)[a] - before.x(b)[a] - move(3 * b + a)));
    double const most = move.head(3 * rig.beads()).cwiseAbs().maxCoeff();
    double turned = 0, worst_turn = 0;
    for (std::int64_t f = 0; f < frames_of(rig); ++f) {
      auto const turn = quaternion::rotation_vector(
          quaternion::product(frame_at(rig, f), quaternion::conjugate(frame_at(before, f))));
      for (int a = 0; a < 3; ++a)
        worst_turn = max(worst_turn, abs(turn[a] - move(3 * (rig.beads() + f) + a)));
      turned = max(turned, norm(turn));
    }
    CAPTURE(hold, worst, most, worst_turn, turned);
    CHECK(most > 1e-6);
    CHECK(turned < 1.0);  // not shortened
    CHECK(worst < 1e-9 * most);
    CHECK(worst_turn < 1e-9 * turned);
  }
}

TEMPLATE_TEST_CASE("bits with frames do not depend on the number of lanes",
                   "[constraint][frames][solver]", Xpbd<6>, Jacobi<6>, DirectFrames<2>) {
  auto run = [](auto team) {
    using Body = With<TestType>;
    Rig<Body, float, decltype(team)> rig(crooked<Body>(17, true), VisitOrder::coloured, team);
    shake(rig, 0.1);
    for (int s = 0; s < 20; ++s) rig.step(5e-4);
    return rig;
  };
  auto const alone = run(Solo{});
  CHECK(alone.finite());
  for (int lanes : {2, 7, 32}) {
    auto const shared = run(Lanes{lanes});
    bool same = true;
    for (std::int64_t b = 0; b < alone.beads(); ++b)
      same = same && alone.x(b) == shared.x(b) && alone.v(b) == shared.v(b);
    for (std::int64_t f = 0; f < frames_of(alone); ++f)
      same = same && frame_at(alone, f) == frame_at(shared, f);
    CHECK(same);
  }
}

TEMPLATE_TEST_CASE("a free thread with frames keeps its momentum", "[constraint][frames][solver]",
                   Xpbd<5>, Jacobi<5>, DirectFrames<2>) {
  Rig<With<TestType>> rig(crooked<With<TestType>>(12, false));
  shake(rig, 0.1);
  auto momentum = [&] {
    V3 p{};
    for (std::int64_t b = 0; b < rig.beads(); ++b)
      p += 1 / rig.store.template get<bead::InverseMass>(0, b) * rig.v(b);
    return p;
  };
  double scale = 0;
  for (std::int64_t b = 0; b < rig.beads(); ++b)
    scale += norm(rig.v(b)) / rig.store.template get<bead::InverseMass>(0, b);
  auto const before = momentum();
  for (int s = 0; s < 100; ++s) rig.step(3e-4, 0.0);
  CHECK(rig.finite());
  CHECK(norm(momentum() - before) < 1e-10 * scale);
}

TEST_CASE("nothing moves a frame that cannot move", "[constraint][frames][hard]") {
  using Body = With<DirectFrames<2>>;
  auto rod = crooked<Body>(7, false);
  for (std::int64_t b = 0; b < 7; ++b) rod.prescribe(b);
  for (std::int64_t f = 0; f < 6; ++f) rod.prescribe_frame(f);
  Rig<Body> rig(rod);
  for (int s = 0; s < 20; ++s) rig.step(1e-3);
  for (std::int64_t f = 0; f < 6; ++f) CHECK(frame_at(rig, f) == rod.orientation(f));
  CHECK(rig.faults == 0);
}

TEST_CASE("a joint between frames that have no segments in a row is reported",
          "[constraint][frames][solver]") {
  using Body = With<DirectFrames<2>>;
  RodAssembly<Body> rod;
  for (int i = 0; i < 2; ++i) rod.add_frame(turn(d3, 0.1 * i), 1e-9);
  rod.add<BendTwist>({0, 1}, {0, 0, 0, 1.0, 1.0});
  Rig<Body> rig(rod);
  rig.step(1e-3);
  CHECK(has(rig.faults, Fault::solver));
}

// Tension acts along the segments as they were predicted, so that a mode of frequency w moves by
// x[n+1] = (1 - (w h)^2)(2 x[n] - x[n-1]), which is stable up to (w h)^2 = 4/3; the fastest mode of a thread without
// stiffness has w^2 = 4 T/(m l).
TEST_CASE("a taut thread with frames is calm while h^2 T/(m l) is below 1/3",
          "[constraint][frames][solver]") {
  using Body = With<DirectFrames<2>>;
  RodMaterial const fine{3e6, 0.02 * l, 1100};
  auto sway = [&](double limit) {
    RodAssembly<Body> rod;
    add_framed_thread(rod, straight({{0, 0, 0}}, {{20 * l, 0, 0}}, 21), fine);
    rod.prescribe(0);
    rod.prescribe(20);
    Rig<Body> rig(rod);
    double const strain = 5e-3, tension = strain * fine.axial_stiffness();
    for (std::int64_t b = 0; b < 21; ++b)
      rig.store.set<bead::Position>(0, b,
                                    {{(1 + strain) * l * double(b), 0, b == 10 ? 1e-6 : 0.0}});
    double const h = std::sqrt(limit * fine.line_density() * square(l) / tension);
    for (int s = 0; s < 400; ++s) rig.step(h, 0.0);
    double most = 0;
    for (std::int64_t b = 0; b < 21; ++b) most = max(most, abs(rig.x(b)[2]));
    return most;
  };
  double const below = sway(0.3), above = sway(0.4);
  CAPTURE(below, above);
  CHECK(below < 1e-7);
  CHECK(above > 1e-5);
}

namespace {
struct Suture : Pbd<Cosserat, DirectFrames<2>> {};
struct Hangs : Scene<Suture, Gravity> {};
}  // namespace

TEST_CASE("a thread with frames runs in a scene", "[constraint][frames][scene]") {
  RodAssembly<Suture> rod;
  add_framed_thread(rod, straight({{0, 0, 0}}, {{0.05, 0, 0}}, 11), soft);
  rod.prescribe(0), rod.prescribe(1), rod.prescribe_frame(0);
  Simulation<Hangs, Serial, double> sim({.capacity = rod.capacity()});
  rod.write(sim.state(), 0);
  sim.set<Gravity>({{0.0, 0.0, -gravity}});
  Rig<Suture> rig(rod);
  for (int s = 0; s < 50; ++s) sim.step(1e-3), rig.step(1e-3);
  CHECK(sim.state().get<bead::Position>(0, 10)[2] < -1e-3);
  CHECK(norm(sim.state().get<bead::Position>(0, 10) - rig.x(10)) < 1e-12);
  CHECK(plan<Hangs>().find("frame") != std::string::npos);
}
