// The code of docs/tutorials/write_a_constraint.md, and wrong constraints that the law suite has to catch.
#include "catch.hpp"
#include "pbd/rig.hpp"
#include "shown.hpp"

#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/pbd/body.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>
#include <mpmpbd/scene/plan.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/testing/constraint_laws.hpp>

// A tether: two beads may come closer than `longest`, but not drift farther apart.
struct Tether {
  using Role = mpmpbd::role::Constraint;
  static constexpr mpmpbd::FixedString name = "Tether";
  using Unknowns = mpmpbd::TypeList<mpmpbd::unknown::Point, mpmpbd::unknown::Point>;
  static constexpr int dimension = 1;
  static constexpr auto kind = mpmpbd::ConstraintKind::inequality;
  static constexpr bool frame_invariant = true;

  template <class T> struct Parameters {
    T longest;     // [m]
    T compliance;  // [m/N]
  };
  static constexpr std::array<mpmpbd::ParameterInfo, 2> parameter_info{
      {mpmpbd::bound::positive("longest", "m"), mpmpbd::bound::not_negative("compliance", "m/N")}};

  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k) {
    using T = typename X::Scalar;
    mpmpbd::Evaluation<Tether, T> e;
    auto const d = get<1>(x) - get<0>(x);
    e.value[0] = k.longest - norm(d);
    gradient<0>(e) = transpose(direction(d));
    gradient<1>(e) = transpose(-direction(d));
    return e;
  }
  template <class T> MPMPBD_HD static T compliance(Parameters<T> const& k) { return k.compliance; }
};

struct Suture : mpmpbd::Pbd<mpmpbd::Constraints<mpmpbd::Distance, Tether>, mpmpbd::Xpbd<8>> {};
struct Tethered : mpmpbd::Scene<Suture, mpmpbd::Gravity> {};

using namespace rods;

namespace {
// Distance with a mistake.
template <int mistake> struct Wrong : Distance {
  template <class T> using Parameters = Distance::Parameters<T>;
  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k) {
    using T = typename X::Scalar;
    auto const right = Distance::evaluate(x, k);
    Evaluation<Wrong, T> e;
    e.value = right.value;
    gradient<0>(e) = gradient<0>(right);
    gradient<1>(e) = gradient<1>(right);
    if (mistake == 1) gradient<1>(e) *= T(2);                        // gradient of something else
    if (mistake == 2) e.value[0] = norm(get<1>(x)) - k.rest_length;  // depends on the place
    if (mistake == 3) gradient<0>(e) *= T(-1), gradient<1>(e) *= T(-1);  // the wrong way
    if (mistake == 4) {  // no direction at zero length
      auto const d = get<1>(x) - get<0>(x);
      gradient<1>(e) = transpose(T(1) / norm(d) * d);
    }
    return e;
  }
};
template <int mistake> bool caught(std::string const& law) {
  return !find_law(constraint_laws<Wrong<mistake>, double>({13e-3, 2.4e-5}, 20e-3), law).holds();
}
}  // namespace

TEST_CASE("a tether keeps the laws of a constraint", "[constraint][tutorial]") {
  for (auto const& law : constraint_laws<Tether, double>({7e-3, 2e-4}, 20e-3)) {
    INFO(law.text());
    CHECK(law.holds());
  }
  for (auto const& law : constraint_laws<Tether, float>({7e-3f, 2e-4f}, 20e-3)) {
    INFO(law.text());
    CHECK(law.holds());
  }
}

TEST_CASE("a tether lets a bead fall until it is taut, and then carries it",
          "[constraint][tutorial]") {
  RodAssembly<Suture> rod;
  for (int i = 0; i < 2; ++i) rod.add_bead({{0.0, 0.0, -0.004 * i}}, 0.002);  // [m], [kg]
  rod.prescribe(0);                                                           // held where it is
  rod.add<Tether>({0, 1}, {0.01, 0.0});                                       // 10 mm, rigid

  Simulation<Tethered, Serial, double> sim({.capacity = rod.capacity()});
  rod.write(sim.state(), 0);
  sim.set<Gravity>({{0.0, 0.0, -9.81}});
  for (int s = 0; s < 20; ++s) sim.step(1e-3);
  auto const z = [&] { return sim.state().get<bead::Position>(0, 1)[2]; };
  CHECK(z() == Approx(-0.004 - 9.81e-6 * 210));  // free fall: h^2 g n (n + 1)/2

  for (int s = 0; s < 300; ++s) sim.step(1e-3);
  CHECK(z() == Approx(-0.01));
  CHECK(sim.state().get<instance<Tether>::Multiplier>(0, 0) == Approx(0.002 * 9.81));  // [N]
  CHECK(plan<Tethered>().find("Tether") != std::string::npos);
}

TEST_CASE("the tutorial shows this constraint", "[constraint][tutorial]") {
  CHECK(blocks_not_in(__FILE__, "tutorials/write_a_constraint.md") == std::vector<std::string>{});
}

TEST_CASE("the law suite catches wrong constraints", "[constraint][laws]") {
  CHECK(!caught<0>("gradient"));
  CHECK(caught<1>("gradient = "));
  CHECK(caught<1>("gradients sum to zero"));
  CHECK(caught<2>("gradient = "));
  CHECK(caught<2>("C is the same after a rigid motion"));
  CHECK(caught<3>("gradient = "));
  CHECK(caught<4>("degenerate"));
}
