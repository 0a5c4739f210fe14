// A smooth sphere that is pressed into tissue: what it does to a node.
#include "catch.hpp"

#include <mpmpbd/effects/indenter.hpp>
#include <mpmpbd/testing/effect_laws.hpp>

using namespace mpmpbd;

namespace {
Vec3<double> after(Vec3<double> const& v, Vec3<double> const& x, double time) {
  detail::Archetype<Indenter, double> n{};
  n[node::Velocity{}] = v;
  n[node::Position{}] = x;
  Indenter::Parameters<double> const ball{{0.1, 0.2, 0.3}, {0.0, 0.0, -0.5}, 0.02, 0.01};
  Indenter::apply(n, ball, Tick<double>{2e-3, 2e-3, 4, time});
  return n[node::Velocity{}];
}
}  // namespace

TEMPLATE_TEST_CASE("an indenter passes the laws of a boundary", "[effect][laws][indenter]", float,
                   double) {
  // Applied twice it must do what it does once, exactly; with an oblique normal that holds to rounding.
  for (auto const& law :
       effect_laws<Indenter, TestType>({{0.2, 0.2, 0.2}, {0.0, 0.0, 0.0}, 0.3, 1.0})) {
    INFO(law.text());
    CHECK(law.error <= law.limit + 16 * double(epsilon<TestType>));
  }
}

TEST_CASE("a node within the indenter moves along with it, slides and lets go",
          "[effect][indenter]") {
  Vec3<double> const below = vec(0.1, 0.2, 0.285), above = vec(0.1, 0.2, 0.305);
  CHECK(norm(after(vec(0.3, 0.0, 0.1), below, 0.0) - vec(0.3, 0.0, -0.5)) < 1e-15);
  CHECK(norm(after(vec(0.3, 0.0, -0.7), below, 0.0) - vec(0.3, 0.0, -0.7)) == 0.0);  // parts
  CHECK(norm(after(vec(0.0, 0.0, -0.7), above, 0.0) - vec(0.0, 0.0, -0.5)) < 1e-15);
  CHECK(norm(after(vec(0.3, 0.0, 0.1), vec(0.1, 0.2, 0.279), 0.0) - vec(0.3, 0.0, 0.1)) == 0.0);
  // After 4 ms it has come 2 mm lower, and after 10 ms it stands, 5 mm lower.
  CHECK(norm(after(vec(0.0, 0.0, 0.1), vec(0.1, 0.2, 0.2785), 4e-3) - vec(0.0, 0.0, -0.5)) < 1e-15);
  CHECK(norm(after(vec(0.0, 0.0, 0.1), vec(0.1, 0.2, 0.2755), 0.7)) < 1e-15);
  CHECK(norm(after(vec(0.0, 0.0, 0.1), vec(0.1, 0.2, 0.2745), 0.7) - vec(0.0, 0.0, 0.1)) == 0.0);
}
