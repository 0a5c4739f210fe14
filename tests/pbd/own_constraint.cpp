// The constraint of docs/concepts/constraint.md, and wrong ones that the law suite has to catch.
#include "catch.hpp"
#include "pbd/rig.hpp"

#include <fstream>
#include <sstream>

#include <mpmpbd/testing/constraint_laws.hpp>

// [doc: constraint]
#include <mpmpbd/pbd/body.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>

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
// [end]

using namespace rods;

namespace {
// A line of the page, without the blanks around it.
std::string slurp(std::string const& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}
std::string here() { return __FILE__; }

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

TEST_CASE("the constraint of the page keeps the laws and works", "[constraint][doc]") {
  for (auto const& law : constraint_laws<Tether, double>({7e-3, 2e-4}, 20e-3)) {
    INFO(law.text());
    CHECK(law.holds());
  }
  RodAssembly<Suture> rod;
  for (int i = 0; i < 2; ++i) rod.add_bead({{0.0, 0.0, -0.004 * i}}, 0.002);
  rod.prescribe(0);
  rod.add<Tether>({0, 1}, {0.01, 0.0});
  Rig<Suture> rig(rod);
  for (int s = 0; s < 20; ++s) rig.step(1e-3);
  CHECK(rig.x(1)[2] == Approx(-0.004 - gravity * 1e-6 * 210));  // free fall while slack
  for (int s = 0; s < 300; ++s) rig.step(1e-3);
  CHECK(rig.x(1)[2] == Approx(-0.01));
  CHECK(rig.store.get<instance<Tether>::Multiplier>(0, 0) == Approx(0.002 * gravity));
}

TEST_CASE("the page shows the code that is compiled here", "[constraint][doc]") {
  auto const source = slurp(here());
  auto const from =
      source.find("// [doc: constraint]\n") + std::string("// [doc: constraint]\n").size();
  auto const code = source.substr(from, source.find("// [end]") - from);
  auto const folder = here().substr(0, here().rfind("tests/"));
  auto const page = slurp(folder + "docs/concepts/constraint.md");
  REQUIRE(!page.empty());
  CHECK(page.find(code) != std::string::npos);
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
