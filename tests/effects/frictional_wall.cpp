// Coulomb friction at a wall: what one substep takes from a node.
#include "catch.hpp"

#include <mpmpbd/effects/frictional_wall.hpp>
#include <mpmpbd/testing/effect_laws.hpp>

using namespace mpmpbd;

namespace {
using Ground = FrictionalWall<2, Side::low>;
using Ceiling = FrictionalWall<2, Side::high>;

template <class W> Vec3<double> after(Vec3<double> const& v, double z, double mu) {
  detail::Archetype<W, double> n{};
  n[node::Velocity{}] = v;
  n[node::Position{}] = vec(0.3, 0.4, z);
  W::apply(n, typename W::template Parameters<double>{0.1, mu}, Tick<double>{2e-3, 2e-3, 4});
  return n[node::Velocity{}];
}
}  // namespace

TEMPLATE_TEST_CASE("a wall with friction passes the laws of a boundary", "[effect][laws][wall]",
                   float, double) {
  for (double mu : {0.0, 0.3, 2.0}) {
    for (auto const& law : effect_laws<Ground, TestType>({0.1, mu})) {
      INFO(mu << ": " << law.text());
      CHECK(law.holds());
    }
    for (auto const& law : effect_laws<FrictionalWall<1, Side::high>, TestType>({0.1, mu})) {
      INFO(mu << ": " << law.text());
      CHECK(law.holds());
    }
  }
}

TEST_CASE("a node pressed on a wall slides or sticks as Coulomb says", "[effect][wall]") {
  Vec3<double> const v = vec(0.3, -0.4, -0.2);  // 0.5 m/s along, 0.2 m/s into the ground
  CHECK(norm(after<Ground>(v, 0.1, 0.5) - 0.8 * vec(0.3, -0.4, 0.0)) < 1e-15);
  CHECK(norm(after<Ground>(v, 0.1, 0.0) - vec(0.3, -0.4, 0.0)) < 1e-15);
  CHECK(norm(after<Ground>(v, 0.1, 2.5)) == 0.0);         // just sticks
  CHECK(norm(after<Ground>(v, 0.1, 1e3)) == 0.0);         // and is not thrown back
  CHECK(norm(after<Ground>(v, 0.1001, 2.5) - v) == 0.0);  // above it
  CHECK(norm(after<Ceiling>(v, 0.2, 2.5) - v) == 0.0);    // moves away
  CHECK(norm(after<Ceiling>(-v, 0.2, 0.5) - 0.8 * vec(-0.3, 0.4, 0.0)) < 1e-15);
}

TEST_CASE("a wall with friction has the name of one", "[effect][wall]") {
  CHECK(Ground::name.view() == "frictional wall z low");
  CHECK(Ceiling::name.view() == "frictional wall z high");
}

TEST_CASE("a negative friction coefficient is refused", "[effect][wall][refusal]") {
  CHECK_THROWS_WITH((check_parameters<Ground, double>({0.1, -0.2})),
                    Catch::Contains("coefficient = -0.2"));
}
