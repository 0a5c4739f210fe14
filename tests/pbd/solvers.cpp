// The three solvers against each other, against a dense solve, and on different numbers of lanes.
#include "catch.hpp"
#include "pbd/rig.hpp"

#include <Eigen/Dense>

#include <mpmpbd/pbd/constraints/half_space.hpp>
#include <mpmpbd/pbd/constraints/minimum_distance.hpp>
#include <mpmpbd/pbd/constraints/pin.hpp>
#include <mpmpbd/testing/samples.hpp>

using namespace rods;

namespace {
using Stretch = Constraints<Distance>;
using Rod = Constraints<Distance, Bend>;
RodMaterial const soft{3e6, 0.8e-3, 1100};

// A thread that zigzags a little, with velocities and two free ends or a fixed one.
template <class Body>
RodAssembly<Body> crooked(int beads, bool hold, RestShape rest = RestShape::straight) {
  mpmpbd::testing::Samples samples(7);
  Line points;
  for (int i = 0; i < beads; ++i)
    points.push_back(vec(5e-3 * i, 0.0, 0.0) + 1e-3 * samples.matrix<3>(-1.0, 1.0));
  RodAssembly<Body> rod;
  add_thread(rod, points, soft, rest);
  if (hold) rod.prescribe(0);
  return rod;
}
template <class Set, class Solver> struct With : Pbd<Set, Solver> {};
}  // namespace

TEST_CASE("solvers agree at convergence where the problem is linear", "[constraint][solver]") {
  // Along a vertical line all gradients are constant. 12 links of 1.7e-4 m/N below a fixed bead.
  double const h = 0.004;
  auto run = [&]<class Solver>(Solver) {
    using Body = With<Stretch, Solver>;
    Rig<Body> rig(chain<Body>(straight({{0.1, 0.1, 0.5}}, {{0.1, 0.1, 0.2}}, 13), 0.013, 1.7e-4));
    for (int s = 0; s < 5; ++s) rig.step(h);
    return rig;
  };
  auto const direct = run(DirectBanded<1>{});
  auto const seidel = run(Xpbd<3000>{});
  auto const jacobi = run(Jacobi<12000>{});
  double const moved = norm(direct.x(12) - vec(0.1, 0.1, 0.2));
  CHECK(moved > 1e-3);
  CHECK(distance(direct, seidel) < 1e-9 * moved);
  CHECK(distance(direct, jacobi) < 1e-9 * moved);
}

TEST_CASE("solvers agree at convergence on a bent rod as far as gradients turn",
          "[constraint][bend][solver]") {
  // Each correction uses its own gradient, so paths differ by the square of the turn within a substep.
  auto gap = [](double speed) {
    Rig<With<Rod, DirectBanded<8>>> direct(
        crooked<With<Rod, DirectBanded<8>>>(12, true, RestShape::as_placed));
    Rig<With<Rod, Xpbd<4000>>> seidel(
        crooked<With<Rod, Xpbd<4000>>>(12, true, RestShape::as_placed));
    Rig<With<Rod, Jacobi<12000>>> jacobi(
        crooked<With<Rod, Jacobi<12000>>>(12, true, RestShape::as_placed));
    shake(direct, speed), shake(seidel, speed), shake(jacobi, speed);
    double const h = 2e-4;
    direct.project(h), seidel.project(h), jacobi.project(h);
    CHECK(direct.residual<Distance>() < 1e-12);
    CHECK(direct.residual<Bend>() < 1e-9);
    CHECK(seidel.residual<Distance>() < 1e-12);
    CHECK(seidel.residual<Bend>() < 1e-9);
    CHECK(jacobi.residual<Distance>() < 1e-10);
    return std::max(distance(direct, seidel), distance(direct, jacobi)) / (speed * h);
  };
  double const coarse = gap(0.4), fine = gap(0.1);
  INFO("difference / motion: " << coarse << ", " << fine);
  CHECK(coarse < 2e-2);
  CHECK(fine < 0.3 * coarse);
}

TEMPLATE_TEST_CASE("the banded elimination is the dense solve", "[constraint][bend][solver]",
                   Stretch, Rod) {
  using Body = With<TestType, DirectBanded<1>>;
  double const h = 7e-4;
  for (bool hold : {false, true}) {
    auto const rod = crooked<Body>(17, hold);
    Rig<Body> rig(rod), before(rod);
    shake(rig, 0.3), shake(before, 0.3);
    auto env = before.environment();
    Body::predict(Solo{}, env, Tick<double>{h, h, 0});

    // The dense system from the same constraints at the predicted positions.
    struct Row {
      Eigen::VectorXd gradient;
      double alpha, value;
      std::int64_t slot;
      bool bend;
    };
    std::vector<Row> rows;
    auto const n = 3 * before.beads();
    auto add = [&]<class C>(std::type_identity<C>) {
      for (std::int64_t i = 0; i < env.template live<Instances<C>>(); ++i) {
        auto const one = mpmpbd::detail::load_instance<C>(env, i);
        Row row{Eigen::VectorXd::Zero(n), one.compliance, one.at.value[0], i,
                std::is_same_v<C, Bend>};
        auto put = [&](int p, auto const& g) {
          for (int a = 0; a < 3; ++a) row.gradient(3 * one.slots[p] + a) = g[a];
        };
        put(0, gradient<0>(one.at));
        put(1, gradient<1>(one.at));
        if constexpr (point_count<C> == 3) put(2, gradient<2>(one.at));
        rows.push_back(row);
        if constexpr (HasAcross<C>) {  // the same joint out of its plane
          auto const side = C::across(one.x, one.k);
          Row second{Eigen::VectorXd::Zero(n), one.compliance / side.value[0], 0.0, -1, true};
          std::swap(row, second);
          put(0, gradient<0>(side)), put(1, gradient<1>(side)), put(2, gradient<2>(side));
          rows.push_back(row);
        }
      }
    };
    for_each_type(typename TestType::List{}, add);
    auto const m = static_cast<Eigen::Index>(rows.size());
    Eigen::MatrixXd J(m, n), A(m, m);
    Eigen::VectorXd w(n), r(m);
    for (std::int64_t b = 0; b < before.beads(); ++b)
      w.segment<3>(3 * b).setConstant(env.template get<bead::InverseMass>(b));
    for (Eigen::Index i = 0; i < m; ++i)
      J.row(i) = rows[static_cast<std::size_t>(i)].gradient,
      r(i) = -rows[static_cast<std::size_t>(i)].value;
    A = h * h * J * w.asDiagonal() * J.transpose();
    for (Eigen::Index i = 0; i < m; ++i) A(i, i) += rows[static_cast<std::size_t>(i)].alpha;
    Eigen::VectorXd const f = A.ldlt().solve(r);
    Eigen::VectorXd const move = h * h * (w.asDiagonal() * (J.transpose() * f));

    rig.project(h);
    double worst_force = 0, worst_move = 0;
    for (Eigen::Index i = 0; i < m; ++i) {
      auto const& row = rows[static_cast<std::size_t>(i)];
      if (row.slot < 0) continue;
      double got = 0;
      if constexpr (TestType::template has<Bend>) {
        got = row.bend ? rig.store.template get<instance<Bend>::Multiplier>(0, row.slot)
                       : rig.store.template get<instance<Distance>::Multiplier>(0, row.slot);
      } else {
        got = rig.store.template get<instance<Distance>::Multiplier>(0, row.slot);
      }
      worst_force = std::max(worst_force, std::abs(got - f(i)) / f.cwiseAbs().maxCoeff());
    }
    for (std::int64_t b = 0; b < rig.beads(); ++b)
      for (int a = 0; a < 3; ++a)
        worst_move = std::max(worst_move, std::abs(rig.x(b)[a] - before.x(b)[a] - move(3 * b + a)) /
                                              move.cwiseAbs().maxCoeff());
    INFO("forces " << worst_force << ", displacements " << worst_move);
    CHECK(worst_force < 1e-10);
    CHECK(worst_move < 1e-10);
    CHECK(rig.faults == 0);
  }
}

TEST_CASE("the band is as narrow as the chain allows", "[constraint][solver]") {
  STATIC_REQUIRE(Chain<TypeList<Distance>>::half_band == 1);
  STATIC_REQUIRE(Chain<TypeList<Distance, Bend>>::half_band == 4);
  STATIC_REQUIRE(Chain<TypeList<Bend>>::half_band == 2);
  // The solver gives a joint two rows, along and across: 3 x 3 blocks, half bandwidth 2.
  STATIC_REQUIRE(std::is_same_v<rows_t<Rod>, TypeList<Distance, Bend, Across<Bend>>>);
  STATIC_REQUIRE(Chain<rows_t<Rod>>::half_band == 7);
}

TEMPLATE_TEST_CASE("bits do not depend on the number of lanes", "[constraint][bend][solver]",
                   Xpbd<6>, Jacobi<6>, DirectBanded<2>, SmallSteps<3>) {
  auto run = [](auto team) {
    using Body = With<Rod, TestType>;
    Rig<Body, float, decltype(team)> rig(crooked<Body>(23, true), VisitOrder::coloured, team);
    shake(rig, 0.2);
    for (int s = 0; s < 40; ++s) rig.step(5e-4);
    return rig;
  };
  auto const alone = run(Solo{});
  for (int lanes : {2, 7, 32}) {
    auto const shared = run(Lanes{lanes});
    bool same = true;
    for (std::int64_t b = 0; b < alone.beads(); ++b)
      same = same && alone.x(b) == shared.x(b) && alone.v(b) == shared.v(b);
    CHECK(same);
  }
}

TEMPLATE_TEST_CASE("a free rod keeps its momentum", "[constraint][bend][solver]", Xpbd<5>,
                   Jacobi<5>, DirectBanded<2>) {
  using Body = With<Rod, TestType>;
  Rig<Body> rig(crooked<Body>(15, false));
  shake(rig, 0.3);
  auto momentum = [&] {
    Vec3<double> p{};
    for (std::int64_t b = 0; b < rig.beads(); ++b)
      p += 1 / rig.store.template get<bead::InverseMass>(0, b) * rig.v(b);
    return p;
  };
  double scale = 0;
  for (std::int64_t b = 0; b < rig.beads(); ++b)
    scale += norm(rig.v(b)) / rig.store.template get<bead::InverseMass>(0, b);
  auto const before = momentum();
  for (int s = 0; s < 100; ++s) rig.step(3e-4, 0.0);
  CHECK(norm(momentum() - before) < 1e-10 * scale);
}

TEST_CASE("mass splitting is stable where every bead has many constraints",
          "[constraint][solver]") {
  // A complete graph of 9 beads: each is in 8 constraints at once. Jacobi without splitting overshoots.
  using Body = With<Stretch, Jacobi<4>>;
  mpmpbd::testing::Samples samples(5);
  RodAssembly<Body> rod;
  for (int i = 0; i < 9; ++i) rod.add_bead(3e-3 * samples.matrix<3>(-1.0, 1.0), 2e-5);
  for (std::int64_t i = 0; i < 9; ++i)
    for (std::int64_t j = 0; j < i; ++j)
      rod.add<Distance>({i, j}, {1.1 * norm(rod.position(i) - rod.position(j)), 0.0});
  Rig<Body> rig(rod);
  double before = 1e300;
  for (int s = 0; s < 30; ++s) {
    rig.project(1e-3);
    for (std::int64_t b = 0; b < 9; ++b) rig.store.set<bead::Velocity>(0, b, {});
    double const now = rig.residual<Distance>();
    CHECK(now <= before * 1.001);
    before = now;
  }
  CHECK(before < 1e-6);
}

TEMPLATE_TEST_CASE("inequalities push and never pull", "[constraint][solver]", Xpbd<30>,
                   Jacobi<200>) {
  using Body = With<Constraints<Distance, MinimumDistance, HalfSpace>, TestType>;
  double const floor = -0.011;
  RodAssembly<Body> rod;
  RodMaterial const m{2e7, 1e-3, 1100};
  add_thread(rod, straight({{0.0, 0.0, 0.004}}, {{0.03, 0.0, 0.004}}, 7), m);
  for (std::int64_t b = 0; b < 7; ++b)
    rod.template add<HalfSpace>({b}, {0.0, 0.0, 3.0, floor, 0.0});
  rod.template add<MinimumDistance>({0, 6}, {0.025, 0.0});
  Rig<Body> rig(rod);
  for (int s = 0; s < 20; ++s) rig.step(1e-3);
  // In flight nothing touches, and the fall is that of free beads.
  CHECK(rig.x(3)[2] == Approx(0.004 - gravity * 1e-6 * 20 * 21 / 2).epsilon(1e-9));
  for (std::int64_t i = 0; i < 7; ++i)
    CHECK(rig.store.template get<instance<HalfSpace>::Multiplier>(0, i) == 0.0);
  for (int s = 0; s < 400; ++s) rig.step(1e-3);
  double weight = 0, carried = 0;
  for (std::int64_t b = 0; b < 7; ++b) {
    CHECK(rig.x(b)[2] == Approx(floor).margin(1e-7));
    weight += gravity / rig.store.template get<bead::InverseMass>(0, b);
    double const push = rig.store.template get<instance<HalfSpace>::Multiplier>(0, b);
    CHECK(push >= 0.0);
    carried += push;
  }
  CHECK(carried == Approx(weight).epsilon(1e-6));  // the floor's force is an output, in newtons
}

TEST_CASE("a pin is a spring of its compliance", "[constraint][solver]") {
  using Body = With<Constraints<Pin>, Xpbd<1>>;
  RodAssembly<Body> rod;
  rod.add_bead({{0.02, -0.01, 0.3}}, 0.004);
  rod.add<Pin>({0}, {0.02, -0.01, 0.3, 0.15});
  Rig<Body> rig(rod);
  for (int s = 0; s < 4000; ++s) rig.step(0.02);
  CHECK(0.3 - rig.x(0)[2] == Approx(0.004 * gravity * 0.15).epsilon(1e-9));
  CHECK(rig.store.get<instance<Pin>::Multiplier>(0, 0)[2] == Approx(0.004 * gravity).epsilon(1e-9));
}

TEST_CASE("constraints that a coupling takes are left out", "[constraint][solver]") {
  using Body = With<Rod, DirectBanded<8>>;
  Rig<Body> rig(crooked<Body>(9, false));
  shake(rig, 0.5);
  auto const env = rig.environment();
  Tick<double> const tick{4e-4, 4e-4, 0};
  std::vector<V3> start;
  for (std::int64_t b = 0; b < rig.beads(); ++b) start.push_back(rig.x(b));
  Body::predict(Solo{}, env, tick);
  double const stretched = rig.residual<Distance>();
  Body::solve<TypeList<Distance>>(Solo{}, env, tick);
  CHECK(rig.residual<Bend>() < 1e-6);
  CHECK(rig.residual<Distance>() > 0.5 * stretched);
  for (std::int64_t i = 0; i < rig.beads() - 1; ++i)
    CHECK(rig.store.get<instance<Distance>::Multiplier>(0, i) == 0.0);
  // As velocity changes: beads stay where they were.
  Body::finish_as_velocity(Solo{}, env, tick);
  for (std::int64_t b = 0; b < rig.beads(); ++b)
    CHECK(rig.x(b) == start[static_cast<std::size_t>(b)]);
  STATIC_REQUIRE(
      std::is_same_v<without_t<TypeList<Distance, Bend>, TypeList<Distance>>, TypeList<Bend>>);
}

TEST_CASE("a rod stores what its policies declare and nothing else", "[constraint][solver]") {
  STATIC_REQUIRE(contains<With<Rod, Jacobi<2>>::AllFields, bead::Correction>);
  STATIC_REQUIRE(!contains<With<Rod, Xpbd<2>>::AllFields, bead::Correction>);
  STATIC_REQUIRE(!contains<With<Stretch, Xpbd<2>>::AllFields, instance<Bend>::Index>);
  STATIC_REQUIRE(on_t<With<Stretch, Xpbd<2>>::AllFields, Beads>::count == 4);
  STATIC_REQUIRE(std::is_same_v<Pbd<Xpbd<3>, Rod>::Set, Rod>);  // in any order
  STATIC_REQUIRE(std::is_same_v<Pbd<Rod>::Solver, Xpbd<8>>);    // with a default
}
