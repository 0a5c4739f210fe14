// The report of tissue that is stretched too far (B17): what it sees, and that it changes nothing.
#include <mpmpbd/effects/stretch_limit.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>
#include <mpmpbd/testing/effect_laws.hpp>
#include <mpmpbd/testing/samples.hpp>

#include "catch.hpp"
#include "stability/block.hpp"

using namespace test;

namespace {

Lame<double> const soft = lame(1e4, 0.3);
struct Plain : Scene<Mpm<StableNeoHookean>> {};
struct Watched : Scene<Mpm<StableNeoHookean>, StretchLimit> {};

template <class T> bool seen(Mat3<double> const& F, double most) {
  mpmpbd::detail::Archetype<StretchLimit, T> p{};
  p[particle::Deformation{}] = cast<T>(F);
  return StretchLimit::faults(p, StretchLimit::Parameters<T>{T(most)}) != 0;
}

}  // namespace

TEMPLATE_TEST_CASE("a limit of stretch keeps the laws of an effect", "[effect][stretch_limit]",
                   float, double) {
  for (auto const& law : effect_laws<StretchLimit, TestType>({2.0})) {
    INFO(law.text());
    CHECK(law.holds());
  }
}

TEMPLATE_TEST_CASE("a stretch is seen in any direction, and nothing else is",
                   "[effect][stretch_limit][B17]", float, double) {
  testing::Samples samples(7);
  for (int n = 0; n < 100; ++n) {
    auto const R = samples.rotation(), Q = samples.rotation();
    auto const stretched = [&](double s) {
      return R * testing::Samples::diagonal(s, 0.9, 1.2) * Q;
    };
    CHECK(seen<TestType>(stretched(1.901), 1.9));
    CHECK_FALSE(seen<TestType>(stretched(1.899), 1.9));
    CHECK_FALSE(seen<TestType>(stretched(0.01), 1.9));
    CHECK_FALSE(seen<TestType>(1.89 * R, 1.9));  // |F| is 3.3
  }
}

TEST_CASE("it follows from the distance of particles, 0.95 cells", "[effect][stretch_limit]") {
  double const cell = 3.7e-3;
  CHECK(StretchLimit::of(cell / 2, cell).most == Approx(1.9));
  CHECK(StretchLimit::of(cell / 3, cell).most == Approx(2.85));
  CHECK(StretchLimit::of(cell, cell).most == Approx(1.1));
}

TEST_CASE("what is reported moves as what is not", "[effect][stretch_limit]") {
  auto const end = []<class S>(std::type_identity<S>) {
    Block<S, float> block({}, soft);
    if constexpr (std::is_same_v<S, Watched>) block.run.template set<StretchLimit>({1.2f});
    double const rate = mpmpbd::sqrt(1e4 / block.c.density) / block.c.cell;
    block.stir({}, 0.3 * rate * Mat3<double>{{0.7, -0.9, 0.4, 0.3, -0.5, 0.8, -0.6, 0.2, -0.3}});
    double const h = 0.5 * block.run.suggest_dt(0);
    for (int s = 0; s < 200; ++s) block.run.step(h);
    std::vector<float> x;
    for (std::int64_t p = 0; p < block.size(); ++p)
      for (int a = 0; a < 3; ++a)
        x.push_back(block.run.state().template get<particle::Position>(0, p)[a]);
    return std::tuple(x, block.run.status(0),
                      block.run.state().template get<environment::FaultCount>(0)[6]);
  };
  auto const [plain, none, never] = end(std::type_identity<Plain>{});
  auto const [watched, fault, often] = end(std::type_identity<Watched>{});
  CHECK(plain == watched);
  CHECK(none == 0);
  CHECK(never == 0);
  CHECK(fault == static_cast<std::uint32_t>(Fault::fracture));
  CHECK(often > 1);
  CHECK(often < 200);
}

TEST_CASE("a limit of stretch that is none is refused", "[effect][stretch_limit][parameters]") {
  Block<Watched> block({}, soft);
  CHECK_THROWS_WITH(block.run.set<StretchLimit>({0.0}), Catch::Contains("most = 0"));
}
