// Effects on nodes and beads: gravity, damping, pinned and driven regions, walls (B45, A4.3).
#include "catch.hpp"

#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/pinned_region.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/lattice.hpp>
#include <mpmpbd/testing/effect_laws.hpp>

namespace {
using namespace mpmpbd;

template <class E, class T> void require_all(parameters_t<parameter_owner_t<E>, double> const& k) {
  auto const laws = effect_laws<E, T>(k);
  REQUIRE(laws.size() >= 3);
  for (auto const& law : laws) {
    INFO(E::name.view() << ": " << law.text());
    CHECK(law.holds());
  }
}

template <class T>
using Node = Local<T, Fields<node::Position, node::Velocity, node::Mass, node::InverseMass>>;
template <class T> Node<T> moving(Vec3<T> const& x, Vec3<T> const& v) {
  Node<T> n{};
  n[node::Position{}] = x;
  n[node::Velocity{}] = v;
  n[node::Mass{}] = T(2.5e-6);
  n[node::InverseMass{}] = {{T(4e5), T(4e5), T(4e5)}};
  return n;
}
template <class T> Tick<T> tick_of(double dt) { return {T(dt), T(dt), 3}; }
}  // namespace

TEMPLATE_TEST_CASE("effects on motion pass their laws", "[effect][laws]", float, double) {
  using T = TestType;
  require_all<Gravity, T>({{0.3, -1.0, -9.81}});
  require_all<Gravity::OnBeads, T>({{0.3, -1.0, -9.81}});
  require_all<Damping, T>({35.0});
  require_all<Damping, T>({1e5});
  require_all<Damping::OnBeads, T>({35.0});
  require_all<PinnedRegion, T>({{-0.1, -0.2, 0.0}, {0.3, 0.5, 0.6}});
  require_all<DrivenRegion, T>({{-0.1, -0.2, 0.0}, {0.3, 0.5, 0.6}, {0.1, 0.2, -0.3}});
  require_all<Wall<Sticky, 0, Side::low>, T>({0.1});
  require_all<Wall<Slip, 1, Side::high>, T>({0.1});
  require_all<Wall<Separating, 2, Side::low>, T>({0.1});
  require_all<Walls<Sticky>, T>({{-0.1, -0.2, 0.0}, {0.3, 0.5, 0.6}});
  require_all<Walls<Slip>, T>({{-0.1, -0.2, 0.0}, {0.3, 0.5, 0.6}});
  require_all<Walls<Separating>, T>({{-0.1, -0.2, 0.0}, {0.3, 0.5, 0.6}});
}

TEMPLATE_TEST_CASE("gravity and damping over an 8 x range of dt", "[effect][gravity][damping]",
                   float, double) {
  using T = TestType;
  double const time = 0.24, rate = 3.7, g = -9.81;
  for (double const dt : {0.024, 0.012, 0.006, 0.003}) {
    auto const steps = static_cast<int>(std::lround(time / dt));
    auto falls = moving<T>({}, {{T(0.4), T(0), T(1.5)}}), slows = falls;
    T height = 0;
    for (int n = 0; n < steps; ++n) {
      Gravity::apply(falls, parameters_t<Gravity, T>{{T(0), T(0), T(g)}}, tick_of<T>(dt));
      height += T(dt) * falls[node::Velocity{}][2];
      Damping::apply(slows, parameters_t<Damping, T>{T(rate)}, tick_of<T>(dt));
    }
    // Each step rounds once or twice: half an ulp of the largest value met, per operation.
    double const rounding = 4 * steps * double(epsilon<T>);
    CHECK(double(falls[node::Velocity{}][2]) == Approx(1.5 + g * time).margin(4 * rounding));
    CHECK(falls[node::Velocity{}][0] == T(0.4));
    // B9: symplectic Euler, x = v t + g dt^2 n (n + 1) / 2.
    CHECK(double(height) ==
          Approx(1.5 * time + g * dt * dt * steps * (steps + 1) / 2).margin(rounding));
    CHECK(double(slows[node::Velocity{}][2]) ==
          Approx(1.5 * std::exp(-rate * time)).epsilon(rounding));
  }
}

TEST_CASE("damping never reverses a velocity", "[effect][damping]") {
  for (double const rate_dt : {0.1, 1.0, 100.0, 1e6}) {  // B45
    auto n = moving<double>({}, {{0.4, -0.3, 1.5}});
    Damping::apply(n, parameters_t<Damping, double>{rate_dt / 1e-3}, tick_of<double>(1e-3));
    CHECK(n[node::Velocity{}][0] >= 0.0);
    CHECK(n[node::Velocity{}][1] <= 0.0);
    CHECK(n[node::Velocity{}][0] == Approx(0.4 * std::exp(-rate_dt)));
  }
}

TEST_CASE("damping of rate zero is the scene without it, to the bit", "[effect][damping]") {
  auto n = moving<float>({}, {{0.4f, -0.3f, 1.5f}});
  Damping::apply(n, parameters_t<Damping, float>{0.0f}, tick_of<float>(1e-3));
  CHECK(n[node::Velocity{}] == vec(0.4f, -0.3f, 1.5f));
}

TEST_CASE("a bead of prescribed motion neither falls nor slows", "[effect][gravity][damping]") {
  detail::Archetype<Gravity::OnBeads, double> bead{};
  bead[bead::Velocity{}] = {{0.1, 0.2, 0.3}};
  Gravity::OnBeads::apply(bead, parameters_t<Gravity, double>{{0, 0, -9.81}},
                          tick_of<double>(1e-2));
  Damping::OnBeads::apply(bead, parameters_t<Damping, double>{40.0}, tick_of<double>(1e-2));
  CHECK(bead[bead::Velocity{}] == vec(0.1, 0.2, 0.3));
  bead[bead::InverseMass{}] = 2e4;
  Gravity::OnBeads::apply(bead, parameters_t<Gravity, double>{{0, 0, -9.81}},
                          tick_of<double>(1e-2));
  CHECK(bead[bead::Velocity{}][2] == Approx(0.3 - 0.0981));
}

TEMPLATE_TEST_CASE("a pinned region holds its nodes and tells contact", "[effect][pin]", float,
                   double) {
  using T = TestType;
  parameters_t<PinnedRegion, T> const k{{T(0.01), T(0.02), T(0.03)}, {T(0.02), T(0.04), T(0.05)}};
  auto const held = [&](T x, T y, T z) {
    auto n = moving<T>({{x, y, z}}, {{T(1.5), T(-0.5), T(0.25)}});
    PinnedRegion::apply(n, k, tick_of<T>(1e-4));
    bool const still = n[node::Velocity{}] == Vec3<T>{};
    CHECK(still == (n[node::InverseMass{}] == Vec3<T>{}));
    CHECK((still || n[node::Velocity{}] == Vec3<T>{{T(1.5), T(-0.5), T(0.25)}}));
    return still;
  };
  CHECK(held(T(0.015), T(0.03), T(0.04)));
  CHECK(held(T(0.01), T(0.02), T(0.03)));  // the border belongs to it
  CHECK(held(T(0.02), T(0.04), T(0.05)));
  CHECK_FALSE(held(T(0.0099), T(0.03), T(0.04)));
  CHECK_FALSE(held(T(0.015), T(0.041), T(0.04)));
  CHECK_FALSE(held(T(0.015), T(0.03), T(0.0501)));
  CHECK_FALSE(held(std::numeric_limits<T>::quiet_NaN(), T(0.03), T(0.04)));
}

TEST_CASE("a driven region moves its nodes whatever pulls at them", "[effect][pin]") {
  parameters_t<DrivenRegion, double> const k{
      {0.01, 0.02, 0.03}, {0.02, 0.04, 0.05}, {0.0, 0.07, 0.0}};
  auto inside = moving<double>({{0.015, 0.03, 0.04}}, {{1.5, -0.5, 0.25}}), outside = inside;
  outside[node::Position{}][0] = 0.5;
  DrivenRegion::apply(inside, k, tick_of<double>(1e-4));
  DrivenRegion::apply(outside, k, tick_of<double>(1e-4));
  CHECK(inside[node::Velocity{}] == vec(0.0, 0.07, 0.0));
  CHECK(inside[node::InverseMass{}] == vec(0.0, 0.0, 0.0));
  CHECK(outside[node::Velocity{}] == vec(1.5, -0.5, 0.25));
}

TEMPLATE_TEST_CASE("walls stick, slip or let go", "[effect][wall]", float, double) {
  using T = TestType;
  double const plane = 0.0125;
  auto const after = [&]<class Condition, Side side>(std::type_identity<Condition>,
                                                     std::integral_constant<Side, side>, double z,
                                                     double vz) {
    using W = Wall<Condition, 2, side>;
    auto n = moving<T>({{T(0.1), T(0.2), T(z)}}, {{T(1.5), T(-0.5), T(vz)}});
    W::apply(n, parameters_t<W, T>{T(plane)}, tick_of<T>(1e-4));
    // Contact feels no mass along an axis that is held, and all of it along the others.
    for (int a = 0; a < 3; ++a)
      CHECK((n[node::InverseMass{}][a] == T(0)) == (n[node::Velocity{}][a] == T(0)));
    return n[node::Velocity{}];
  };
  std::type_identity<Sticky> const sticky;
  std::type_identity<Slip> const slip;
  std::type_identity<Separating> const separating;
  std::integral_constant<Side, Side::low> const low;
  std::integral_constant<Side, Side::high> const high;
  auto const v = [](double x, double y, double z) { return vec(T(x), T(y), T(z)); };

  for (double const inside_the_wall : {0.01, plane}) {
    CHECK(after(sticky, low, inside_the_wall, -0.25) == v(0, 0, 0));
    CHECK(after(sticky, low, inside_the_wall, 0.25) == v(0, 0, 0));
    CHECK(after(slip, low, inside_the_wall, -0.25) == v(1.5, -0.5, 0));
    CHECK(after(slip, low, inside_the_wall, 0.25) == v(1.5, -0.5, 0));
    CHECK(after(separating, low, inside_the_wall, -0.25) == v(1.5, -0.5, 0));
    CHECK(after(separating, low, inside_the_wall, 0.25) == v(1.5, -0.5, 0.25));
  }
  CHECK(after(sticky, low, 0.013, -0.25) == v(1.5, -0.5, -0.25));
  CHECK(after(sticky, high, 0.013, -0.25) == v(0, 0, 0));
  CHECK(after(slip, high, 0.013, 0.25) == v(1.5, -0.5, 0));
  CHECK(after(separating, high, 0.013, 0.25) == v(1.5, -0.5, 0));
  CHECK(after(separating, high, 0.013, -0.25) == v(1.5, -0.5, -0.25));
  CHECK(after(separating, high, 0.012, 0.25) == v(1.5, -0.5, 0.25));
}

TEST_CASE("six walls are six walls", "[effect][wall]") {
  testing::Samples random(41);
  using W = Walls<Separating>;
  for (int s = 0; s < 500; ++s) {
    auto const start = moving<double>(random.matrix<3>(-0.3, 0.7), random.matrix<3>(-2, 2));
    auto all = start, one = start;
    W::apply(all, parameters_t<W, double>{{-0.1, -0.2, 0.0}, {0.3, 0.5, 0.6}},
             tick_of<double>(1e-4));
    auto const wall = [&]<class One>(std::type_identity<One>, double position) {
      One::apply(one, parameters_t<One, double>{position}, tick_of<double>(1e-4));
    };
    wall(std::type_identity<Wall<Separating, 0, Side::low>>{}, -0.1);
    wall(std::type_identity<Wall<Separating, 1, Side::low>>{}, -0.2);
    wall(std::type_identity<Wall<Separating, 2, Side::low>>{}, 0.0);
    wall(std::type_identity<Wall<Separating, 0, Side::high>>{}, 0.3);
    wall(std::type_identity<Wall<Separating, 1, Side::high>>{}, 0.5);
    wall(std::type_identity<Wall<Separating, 2, Side::high>>{}, 0.6);
    CHECK(all[node::Velocity{}] == one[node::Velocity{}]);
  }
  CHECK(Walls<Slip>::name.view() == "slip walls");
  CHECK(Wall<Sticky, 2, Side::high>::name.view() == "sticky wall z high");
}

TEST_CASE("effect parameters out of bounds are refused by name", "[effect][parameters]") {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH((check_parameters<Damping, double>({-1.0})), Catch::Contains("rate"));
  CHECK_THROWS_WITH((check_parameters<Gravity, double>({{0.0, nan, -9.81}})),
                    Catch::Contains("g_y"));
  CHECK_THROWS_WITH((check_parameters<PinnedRegion, double>({{0, 0, 0}, {1, 1, nan}})),
                    Catch::Contains("high_z"));
  CHECK_THROWS_WITH((check_parameters<Wall<Slip, 0, Side::low>, double>({nan})),
                    Catch::Contains("position"));
}

// A plane at i dx, as a user writes it, is where the lattice has its nodes i, whatever both were rounded to.
TEMPLATE_TEST_CASE("walls and boxes on a plane of nodes hold these nodes", "[effect][wall]", float,
                   double) {
  using T = TestType;
  using Low = Wall<Sticky, 0, Side::low>;
  using High = Wall<Sticky, 0, Side::high>;
  auto const up = vec(T(0.3), T(0), T(0));
  int wrong = 0;
  for (int k = 1; k <= 200; ++k) {
    double const dx = 1.3e-4 * k;
    auto const lattice = Lattice<T>::make(T(dx), 64, 8, 8);
    for (int i = 1; i < 60; ++i) {
      auto const plane = static_cast<T>(i * dx);
      auto const holds = [&]<class E>(std::type_identity<E>, int node, auto const& parameters) {
        auto n = moving<T>(lattice.position(node, 0, 0), up);
        E::apply(n, parameters, tick_of<T>(1e-4));
        return n[node::Velocity{}][0] == T(0);
      };
      using std::type_identity;
      Low::Parameters<T> const wall{plane};
      PinnedRegion::Parameters<T> const box{{plane, T(0), T(0)}, {plane, T(1), T(1)}};
      wrong += !holds(type_identity<Low>{}, i, wall) + holds(type_identity<Low>{}, i + 1, wall);
      wrong += !holds(type_identity<High>{}, i, wall) + holds(type_identity<High>{}, i - 1, wall);
      for (int node : {i - 1, i, i + 1})
        wrong += holds(type_identity<PinnedRegion>{}, node, box) != (node == i);
      // A difference that is rounded once, as a compiler that joins products to sums would have it, is within what counts as on the plane.
      wrong += std::fma(T(i), lattice.dx, -plane) > 4 * epsilon<T> * plane;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a box whose low corner is beyond its high one is refused", "[effect][refusal]") {
  CHECK_THROWS_WITH((check_parameters<PinnedRegion, double>({{0.0, 0.2, 0.0}, {1.0, 0.1, 1.0}})),
                    Catch::Contains("PinnedRegion: high_y = 0.1") && Catch::Contains("[0.2, inf)"));
  CHECK_THROWS_WITH(
      (check_parameters<DrivenRegion, double>({{0.0, 0.0, 2.0}, {1.0, 1.0, 1.0}, {}})),
      Catch::Contains("DrivenRegion: high_z = 1.0") && Catch::Contains("[2, inf)"));
}
