// seconds: 5
// B22, B23, B24, B26, B27 of verification.md: what must stay finite, and how.
#include "catch.hpp"
#include "pbd/rig.hpp"

#include <mpmpbd/testing/samples.hpp>

using namespace rods;

namespace {
using Stretch = Constraints<Distance>;
using Rod = Constraints<Distance, Bend>;
template <class Set, class Solver> struct With : Pbd<Set, Solver> {};
RodMaterial const soft{3e6, 0.8e-3, 1100};

template <class Body, class T> bool same(Rig<Body, T> const& a, Rig<Body, T> const& b) {
  for (std::int64_t i = 0; i < a.beads(); ++i)
    if (!(a.x(i) == b.x(i) && a.v(i) == b.v(i))) return false;
  return true;
}
// Two segments of length l that turn by `turn` in the x-y plane, joint at the origin.
Line joint(double l, double turn) {
  return {{{-l, 0, 0}}, {{0, 0, 0}}, {{l * std::cos(turn), l * std::sin(turn), 0}}};
}
template <class Body, class T> double turn_at(Rig<Body, T> const& rig, std::int64_t b) {
  auto const d1 = cast<double>(rig.x(b) - rig.x(b - 1)), d2 = cast<double>(rig.x(b + 1) - rig.x(b));
  return std::atan2(norm(cross(d1, d2)), dot(d1, d2));
}
}  // namespace

TEMPLATE_TEST_CASE("B22: beads that coincide separate, always the same way", "[constraint][hard]",
                   (std::pair<Xpbd<20>, float>), (std::pair<Xpbd<20>, double>),
                   (std::pair<Jacobi<60>, float>), (std::pair<Jacobi<60>, double>),
                   (std::pair<DirectBanded<4>, float>), (std::pair<DirectBanded<4>, double>)) {
  using Body = With<Rod, typename TestType::first_type>;
  using T = typename TestType::second_type;
  double const l = 4e-3;
  for (int together : {2, 3, 7}) {  // beads 2 and 3; 2, 3, 4; all
    CAPTURE(together);
    auto run = [&] {
      RodAssembly<Body> rod;
      add_thread(rod, straight({{0.1, 0.2, 0.3}}, {{0.1, 0.2 + 6 * l, 0.3}}, 7), soft);
      Rig<Body, T> rig(rod);
      std::int64_t const from = together == 7 ? 0 : 2;
      for (std::int64_t b = from; b < from + together && b < 7; ++b)
        rig.store.template set<bead::Position>(0, b, rig.x(from));
      for (int s = 0; s < 300; ++s) {
        rig.step(1e-3, 0.0);
        for (std::int64_t b = 0; b < 7; ++b)  // let it come to rest
          rig.store.template set<bead::Velocity>(0, b, T(0.9) * rig.v(b));
      }
      return rig;
    };
    auto const rig = run(), again = run();
    CHECK(rig.finite());
    CHECK(same(rig, again));
    for (std::int64_t b = 1; b < 7; ++b)
      CHECK(double(norm(rig.x(b) - rig.x(b - 1))) == Approx(l).epsilon(1e-2));
  }
}

TEMPLATE_TEST_CASE("B22: a segment driven through zero length stays finite", "[constraint][hard]",
                   Xpbd<8>, Jacobi<8>, DirectBanded<2>) {
  using Body = With<Rod, TestType>;
  RodAssembly<Body> rod;
  double const l = 5e-3;
  add_thread(rod, straight({{0, 0.1, 0}}, {{4 * l, 0.1, 0}}, 5), soft);
  rod.prescribe(0);
  rod.prescribe(4, {{-0.3, 0, 0}});  // through the fixed end and beyond
  Rig<Body, float> rig(rod);
  for (int s = 0; s < 600; ++s) {
    rig.step(2e-4);
    REQUIRE(rig.finite());
  }
  CHECK(rig.x(4)[0] == Approx(0.02 - 0.3 * 0.12).epsilon(1e-4));
  for (std::int64_t b = 0; b < 5; ++b) CHECK(double(norm(rig.x(b) - rig.x(0))) < 0.05);
  // Let go, its segments find their length again.
  rig.store.template set<bead::InverseMass>(0, 4, float(2 / (soft.line_density() * l)));
  for (int s = 0; s < 3000; ++s) {
    rig.step(2e-4, 0.0);
    for (std::int64_t b = 1; b < 5; ++b)
      rig.store.template set<bead::Velocity>(0, b, 0.98F * rig.v(b));
  }
  for (std::int64_t b = 1; b < 5; ++b)
    CHECK(double(norm(rig.x(b) - rig.x(b - 1))) == Approx(l).epsilon(1e-2));
}

TEMPLATE_TEST_CASE("B23: a straight joint at rest feels nothing", "[bend][hard]", float, double) {
  using Body = With<Rod, Xpbd<4>>;
  RodAssembly<Body> rod;
  Line points;
  for (int i = 0; i < 3; ++i)
    points.push_back(double(i) * (1.0 / 512) * vec(1.0, -2.0, 4.0));  // exact in binary
  add_thread(rod, points, soft);
  Rig<Body, TestType> rig(rod);
  auto const before = rig.x(2);
  for (int s = 0; s < 50; ++s) rig.step(1e-3, 0.0);
  CHECK(norm(rig.x(2) - before) <= 4 * epsilon<TestType> * norm(before));
  CHECK(std::abs(rig.store.template get<instance<Bend>::Multiplier>(0, 0)) <=
        1e-6 * soft.bending_stiffness());
}

TEMPLATE_TEST_CASE(
    "B23: a straight joint bends to the angle it wants, and stays straight if it wants none",
    "[bend][hard]", Xpbd<10>, Jacobi<40>, DirectBanded<3>) {
  using Body = With<Rod, TestType>;
  double const l = 3e-3;
  for (auto const& [wanted, noise] :
       {std::pair{pi<double> / 2, 0.0}, {pi<double> / 2, 1e-9}, {0.0, 1e-9}, {pi<double>, 1e-9}}) {
    CAPTURE(wanted, noise);
    auto run = [&, wanted = wanted, noise = noise] {
      mpmpbd::testing::Samples samples(21);
      RodAssembly<Body> rod;
      for (auto const& p : joint(l, 0.0))
        rod.add_bead(p + noise * l * samples.matrix<3>(-1.0, 1.0), 2e-5);
      rod.template add<Distance>({0, 1}, {l, 0.0});
      rod.template add<Distance>({1, 2}, {l, 0.0});
      rod.template add<Bend>({0, 1, 2}, {wanted, soft.bend_compliance(l)});
      Rig<Body> rig(rod);
      for (int s = 0; s < 3000; ++s) {
        rig.step(1e-3, 0.0);
        for (std::int64_t b = 0; b < 3; ++b)
          rig.store.template set<bead::Velocity>(0, b, 0.98 * rig.v(b));
      }
      return rig;
    };
    auto const rig = run();
    CHECK(rig.finite());
    CHECK(turn_at(rig, 1) == Approx(wanted).epsilon(1e-3).margin(1e-8));
    CHECK(same(rig, run()));
  }
}

TEMPLATE_TEST_CASE("B24: a folded joint opens", "[bend][hard]", (std::pair<Xpbd<10>, float>),
                   (std::pair<Xpbd<10>, double>), (std::pair<Jacobi<40>, double>),
                   (std::pair<DirectBanded<3>, float>), (std::pair<DirectBanded<3>, double>)) {
  using Body = With<Rod, typename TestType::first_type>;
  using T = typename TestType::second_type;
  double const l = 3e-3;
  RodAssembly<Body> rod;
  add_thread(rod, joint(l, pi<double> * 0.5), soft);
  Rig<Body, T> rig(rod);
  rig.store.template set<bead::Position>(0, 2, rig.x(0));  // antiparallel, exactly
  // The torque of a fold is pi EI/l, not more.
  rig.project(1e-9);
  CHECK(std::abs(double(rig.store.template get<instance<Bend>::Multiplier>(0, 0))) ==
        Approx(pi<double> * soft.bending_stiffness() / l).epsilon(1e-5));
  for (int s = 0; s < 3000; ++s) {
    rig.step(1e-3, 0.0);
    for (std::int64_t b = 0; b < 3; ++b)
      rig.store.template set<bead::Velocity>(0, b, T(0.98) * rig.v(b));
    REQUIRE(rig.finite());
  }
  CHECK(turn_at(rig, 1) < 1e-2);
}

TEMPLATE_TEST_CASE("B26: any compliance from 1e-12 to 1e6", "[constraint][hard]",
                   (std::pair<Xpbd<20>, float>), (std::pair<Xpbd<20>, double>),
                   (std::pair<DirectBanded<2>, float>), (std::pair<DirectBanded<2>, double>)) {
  using Body = With<Stretch, typename TestType::first_type>;
  double free_fall = 0;
  double before = 0;
  for (double a : {0.0, 1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6}) {
    Rig<Body, typename TestType::second_type> rig(
        chain<Body>(straight({{0, 0, 0.2}}, {{0, 0, 0.1}}, 11), 0.004, a));
    for (int s = 0; s < 200; ++s) rig.step(1e-3);
    CHECK(rig.finite());
    double const sag = rig.length() - 0.1;
    CHECK(sag > -1e-6);
    CHECK(sag >= before - 1e-4);  // softer chains are longer at that time
    before = sag;
    free_fall = 0.5 * gravity * 0.2 * 0.2 * 1.01;
    CHECK(sag < free_fall);
  }
  CHECK(before > 0.9 * free_fall);
}

// Both ends held 10 % too far apart, then one let go: no faster than elastic waves make it.
TEMPLATE_TEST_CASE("B26: an over-constrained rod is bounded and lets go gently",
                   "[constraint][hard]", Xpbd<20>, Jacobi<60>, DirectBanded<2>) {
  using Body = With<Rod, TestType>;
  RodAssembly<Body> rod;
  add_thread(rod, straight({{0, 0, 0}}, {{0.04, 0, 0}}, 21), soft);
  rod.prescribe(0);
  rod.prescribe(20, {{0.4, 0, 0}});
  Rig<Body> rig(rod);
  for (int s = 0; s < 50; ++s) rig.step(2e-4, 0.0);
  rig.store.template set<bead::Velocity>(0, 20, {});
  for (int s = 0; s < 2000; ++s) rig.step(2e-4, 0.0);
  CHECK(rig.finite());
  CHECK(rig.length() == Approx(0.044).epsilon(1e-6));
  // At rest the tension is EA times the strain; iterations that have not converged report less.
  double const tension = 0.1 * soft.axial_stiffness();
  double least = tension, most = 0;
  for (std::int64_t i = 0; i < 20; ++i) {
    double const t = -rig.store.template get<instance<Distance>::Multiplier>(0, i);
    least = std::min(least, t), most = std::max(most, t);
  }
  CHECK(least > 0.0);
  CHECK(most <= tension * (1 + 1e-6));
  if constexpr (std::is_same_v<TestType, DirectBanded<2>>)
    CHECK(least == Approx(tension).epsilon(1e-6));
  double const half_segment = soft.line_density() * 0.04 / 40;
  rig.store.template set<bead::InverseMass>(0, 20, 1 / half_segment);
  double fastest = 0;
  for (int s = 0; s < 200; ++s) {
    rig.step(2e-4, 0.0);
    fastest = std::max(fastest, rig.fastest());
  }
  double const wave = std::sqrt(soft.young_modulus / soft.density);
  INFO("release speed " << fastest << ", elastic " << 0.1 * wave);
  CHECK(rig.finite());
  CHECK(fastest <= 0.1 * wave);
}
TEMPLATE_TEST_CASE("B26: a rigid over-constrained chain is bounded", "[constraint][hard]", Xpbd<20>,
                   Jacobi<20>, DirectBanded<2>) {
  using Body = With<Stretch, TestType>;
  for (double noise : {0.0, 1e-12, 1e-9, 1e-6, 1e-3}) {
    mpmpbd::testing::Samples samples(31);
    auto line = straight({{0, 0, 0}}, {{0.04, 0, 0}}, 21);
    for (auto& p : line) p += noise * 2e-3 * samples.matrix<3>(-1.0, 1.0);
    auto rod = chain<Body>(line, 1e-5, 0.0);
    rod.prescribe(20);
    Rig<Body> rig(rod);
    rig.store.template set<bead::Position>(0, 20, {{0.044, 0, 0}});
    for (int s = 0; s < 500; ++s) rig.step(1e-3);
    CHECK(rig.finite());
    for (std::int64_t b = 0; b < 21; ++b) CHECK(norm(rig.x(b)) < 1.0);
    CHECK(rig.template residual<Distance>() > 1e-5);  // what cannot hold is reported
    if constexpr (std::is_same_v<TestType, DirectBanded<2>>) CHECK(has(rig.faults, Fault::solver));
  }
}

TEMPLATE_TEST_CASE("B27: nothing moves what cannot move", "[constraint][bend][hard]", Xpbd<5>,
                   Jacobi<5>, DirectBanded<2>) {
  using Body = With<Rod, TestType>;
  auto make = [](auto const& hold, double compliance) {
    RodAssembly<Body> rod;
    auto const line = straight({{0.1, 0, 0}}, {{0.13, 0.01, 0.02}}, 9);
    for (auto const& p : line) rod.add_bead(p, 3e-5);
    double const l = norm(line[1] - line[0]);
    for (std::int64_t b = 0; b < 8; ++b)
      rod.template add<Distance>({b, b + 1}, {1.3 * l, compliance});
    for (std::int64_t b = 1; b < 8; ++b)
      rod.template add<Bend>({b - 1, b, b + 1}, {0.5, compliance});
    for (auto b : hold) rod.prescribe(b);
    return Rig<Body>(rod);
  };
  for (double compliance : {0.0, 1e-3}) {
    auto all = make(std::array<std::int64_t, 9>{0, 1, 2, 3, 4, 5, 6, 7, 8}, compliance),
         untouched = all;
    for (int s = 0; s < 20; ++s) all.step(1e-3);
    CHECK(same(all, untouched));
    CHECK(all.faults == 0);

    auto ends = make(std::array<std::int64_t, 2>{0, 8}, compliance);
    auto const first = ends.x(0), last = ends.x(8);
    for (int s = 0; s < 50; ++s) ends.step(1e-3);
    CHECK(ends.finite());
    CHECK(ends.x(0) == first);
    CHECK(ends.x(8) == last);
  }
}

TEST_CASE("one bead and no bead are rods too", "[constraint][hard]") {
  using Body = With<Rod, DirectBanded<2>>;
  RodAssembly<Body> empty;
  Rig<Body> nothing(empty);
  nothing.step(1e-3);
  CHECK(nothing.faults == 0);
  RodAssembly<Body> single;
  single.add_bead({{0.1, 0.2, 0.3}}, 0.002);
  Rig<Body> one(single);
  for (int s = 0; s < 10; ++s) one.step(1e-3);
  CHECK(one.x(0)[2] == Approx(0.3 - gravity * 1e-6 * 55));
}
