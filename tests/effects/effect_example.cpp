// The effect of docs/concepts/effect.md: what is shown there is compiled and tested here.
#include "catch.hpp"
#include "shown.hpp"

#include <array>

#include <mpmpbd/effects/concepts.hpp>
#include <mpmpbd/testing/effect_laws.hpp>

// Everything drifts with a current: v = u + (v - u) exp(-c dt), exact for any dt.
struct Current {
  using Role = mpmpbd::role::Effect;
  static constexpr mpmpbd::FixedString name = "current";
  static constexpr mpmpbd::Slot slot = mpmpbd::Slot::on_grid;
  using Reads = mpmpbd::Fields<mpmpbd::node::Velocity>;
  using Writes = mpmpbd::Fields<mpmpbd::node::Velocity>;

  template <class T> struct Parameters {
    T velocity[3];  // of the current [m/s]
    T rate;         // [1/s]
  };
  static constexpr std::array<mpmpbd::ParameterInfo, 4> parameter_info{
      {mpmpbd::bound::any("u_x", "m/s"), mpmpbd::bound::any("u_y", "m/s"),
       mpmpbd::bound::any("u_z", "m/s"), mpmpbd::bound::not_negative("rate", "1/s")}};

  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& node, K const& k, mpmpbd::Tick<T> const& tick) {
    T const share = -mpmpbd::expm1(-k.rate * tick.dt);
    auto& v = node[mpmpbd::node::Velocity{}];
    for (int a = 0; a < 3; ++a) v[a] += share * (k.velocity[a] - v[a]);
  }
};

TEST_CASE("current keeps the laws of an effect", "[effect][example]") {
  for (auto const& law : mpmpbd::effect_laws<Current, float>({{0.3, 0.0, -0.1}, 35.0})) {
    INFO(law.text());
    CHECK(law.holds());
  }
}

// "v *= 1 - c" per step instead: what a peer ships as drag. Half the step doubles it.
struct PerStep : Current {
  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& node, K const&, mpmpbd::Tick<T> const&) {
    node[mpmpbd::node::Velocity{}] *= T(0.9);
  }
};
TEST_CASE("drag per step does not keep the laws", "[effect][laws]") {
  auto const laws = mpmpbd::effect_laws<PerStep, double>({{0.3, 0.0, -0.1}, 35.0});
  CHECK_FALSE(mpmpbd::find_law(laws, "a step of no length").holds());
  CHECK_FALSE(mpmpbd::find_law(laws, "one step does").holds());
}

TEST_CASE("the page shows this code", "[effect][example]") {
  CHECK(blocks_not_in(__FILE__, "concepts/effect.md") == std::vector<std::string>{});
}
