// Threads from a line and a material; colours; what is refused.
#include "catch.hpp"
#include "pbd/rig.hpp"

#include <mpmpbd/pbd/constraints/pin.hpp>

using namespace rods;
using Catch::Matchers::Contains;

namespace {
struct Body : Pbd<Constraints<Distance, Bend>> {};
struct Banded : Pbd<Constraints<Distance, Bend>, DirectBanded<1>> {};
RodMaterial const nylon{2e9, 0.115e-3, 1140};
}  // namespace

TEST_CASE("a thread weighs what its wire weighs and resists as E and r say",
          "[constraint][builder]") {
  RodAssembly<Body> rod;
  auto const range = add_thread(rod, straight({{0, 0, 0}}, {{0.06, 0.08, 0}}, 41), nylon);
  CHECK(range.segments() == 40);
  double mass = 0;
  for (auto b = range.first; b < range.last; ++b) mass += 1 / rod.inverse_mass(b);
  CHECK(mass == Approx(1140 * pi<double> * square(0.115e-3) * 0.1).epsilon(1e-12));
  CHECK(rod.inverse_mass(0) == Approx(2 * rod.inverse_mass(1)));
  Rig<Body> const rig(rod);
  double const l = 0.1 / 40;
  auto const d = rig.store.get<instance<Distance>::Parameters>(0, 3);
  CHECK(d[0] == Approx(l));
  CHECK(d[1] == Approx(l / (2e9 * pi<double> * square(0.115e-3))));
  auto const b = rig.store.get<instance<Bend>::Parameters>(0, 3);
  CHECK(b[0] == 0.0);
  CHECK(b[1] == Approx(l / nylon.bending_stiffness()));
}

TEST_CASE("beads lie at equal distance along a polyline", "[constraint][builder]") {
  Line const corner{{{0, 0, 0}}, {{0.03, 0, 0}}, {{0.03, 0.05, 0}}};
  auto const points = along(corner, 9);
  REQUIRE(points.size() == 9);
  CHECK(norm(points[2] - vec(0.02, 0.0, 0.0)) < 1e-15);
  CHECK(norm(points[4] - vec(0.03, 0.01, 0.0)) < 1e-15);
  CHECK(points[8] == corner[2]);
  RodAssembly<Body> rod;
  add_thread(rod, corner, 3, nylon, RestShape::as_placed);
  CHECK(Rig<Body>(rod).residual<Bend>() < 1e-15);
}

TEST_CASE("two threads share an environment", "[constraint][builder]") {
  RodAssembly<Banded> rod;
  auto const a = add_thread(rod, straight({{0, 0, 0}}, {{0.02, 0, 0}}, 6), nylon);
  auto const b = add_thread(rod, straight({{0, 0.1, 0}}, {{0.02, 0.1, 0}}, 4), nylon);
  CHECK(a.last == b.first);
  CHECK(rod.instances<Distance>() == 8);
  CHECK(rod.instances<Bend>() == 6);
  // Each moves as if alone.
  rod.prescribe(a.first);
  Rig<Banded> both(rod);
  RodAssembly<Banded> alone;
  add_thread(alone, straight({{0, 0, 0}}, {{0.02, 0, 0}}, 6), nylon);
  alone.prescribe(0);
  Rig<Banded> one(alone);
  for (int s = 0; s < 50; ++s) both.step(1e-4), one.step(1e-4);
  for (std::int64_t k = 0; k < 6; ++k) CHECK(norm(both.x(k) - one.x(k)) < 1e-12);
  CHECK(both.x(b.first)[2] == Approx(-gravity * 1e-8 * 50 * 51 / 2));
}

TEST_CASE("colours share no bead and depend on the instances alone", "[constraint][builder]") {
  std::vector<std::array<std::int64_t, 2>> pairs;
  std::vector<std::array<std::int64_t, 3>> triples;
  for (std::int64_t b = 0; b < 30; ++b) pairs.push_back({b, b + 1});
  for (std::int64_t b = 0; b < 29; ++b) triples.push_back({b, b + 1, b + 2});
  auto count = [](std::vector<int> const& c) { return *std::max_element(c.begin(), c.end()) + 1; };
  CHECK(count(colour_greedily(pairs, 31)) == 2);
  CHECK(count(colour_greedily(triples, 31)) == 3);
  CHECK(colour_greedily(pairs, 31) == colour_greedily(pairs, 31));
  // A net: random pairs.
  std::uint64_t state = 12345;
  auto draw = [&] {
    return static_cast<std::int64_t>(
               (state = state * 6364136223846793005u + 1442695040888963407u) >> 33) %
           40;
  };
  std::vector<std::array<std::int64_t, 2>> net;
  while (net.size() < 200) {
    auto const a = draw(), b = draw();
    if (a != b) net.push_back({a, b});
  }
  auto const colours = colour_greedily(net, 40);
  bool conflict = false;
  for (std::size_t i = 0; i < net.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (colours[i] == colours[j])
        for (auto p : net[i])
          for (auto q : net[j]) conflict = conflict || p == q;
  CHECK(!conflict);
}

TEST_CASE("instances are stored colour by colour", "[constraint][builder]") {
  RodAssembly<Body> rod;
  add_thread(rod, straight({{0, 0, 0}}, {{0.02, 0, 0}}, 8), nylon);
  Rig<Body> const rig(rod);
  std::vector<std::int64_t> first, end;
  for (std::int64_t i = 0; i < 7; ++i) {
    first.push_back(rig.store.get<instance<Distance>::Index>(0, i)[0]);
    end.push_back(rig.store.get<instance<Distance>::ColourEnd>(0, i));
  }
  CHECK(first == std::vector<std::int64_t>{0, 2, 4, 6, 1, 3, 5});
  CHECK(end == std::vector<std::int64_t>{4, 4, 4, 4, 7, 7, 7});
}

TEST_CASE("bad rods are refused with name, value and bound", "[constraint][builder][B13]") {
  RodAssembly<Body> rod;
  auto const line = straight({{0, 0, 0}}, {{0.02, 0, 0}}, 4);
  CHECK_THROWS_WITH(add_thread(rod, line, RodMaterial{2e9, 0.0, 1140}),
                    Contains("radius = 0.0") && Contains("(0, inf)"));
  CHECK_THROWS_WITH(add_thread(rod, line, RodMaterial{-1.0, 1e-3, 1140}),
                    Contains("young_modulus = -1.0"));
  CHECK_THROWS_WITH(add_thread(rod, line, RodMaterial{2e9, 1e-3, std::nan("")}),
                    Contains("density = nan") || Contains("density = -nan"));
  CHECK_THROWS_WITH(add_thread(rod, Line{{{0, 0, 0}}}, nylon),
                    Contains("beads = 1") && Contains("at least 2"));
  CHECK_THROWS_WITH(add_thread(rod, Line{{{0, 0, 0}}, {{0, 0, 0}}}, nylon),
                    Contains("segment 0") && Contains("positive length"));
  CHECK_THROWS_WITH(add_thread(rod, line, 1, nylon), Contains("beads = 1"));
  CHECK(rod.beads() == 0);  // nothing was added
  rod.add_bead({{0, 0, 0}}, 0.001);
  CHECK_THROWS_WITH(rod.add_bead({{0, 0, 0}}, 0.0), Contains("mass = 0.0"));
  CHECK_THROWS_WITH(rod.add<Distance>({0, 1}, {0.1, 0.0}), Contains("bead 1 does not exist"));
  rod.add_bead({{0, 0, 1e-3}}, 0.001);
  CHECK_THROWS_WITH(rod.add<Distance>({1, 1}, {0.1, 0.0}), Contains("bead 1 twice"));
  CHECK_THROWS_WITH(rod.add<Distance>({0, 1}, {0.1, -1e-9}),
                    Contains("compliance") && Contains("[0, inf)"));
  CHECK_THROWS_WITH(rod.add<Distance>({0, 1}, {0.0, 0.0}), Contains("rest_length"));
  CHECK_THROWS_WITH(rod.prescribe(7), Contains("bead 7"));
  CHECK_THROWS_WITH(rod.prescribe(0, {{0.0, std::nan(""), 0.0}}),
                    Contains("RodAssembly::prescribe: velocity"));
  CHECK(rod.instances<Distance>() == 0);

  RodAssembly<Banded> banded;
  for (int i = 0; i < 3; ++i) banded.add_bead({{1e-3 * i, 0, 0}}, 0.001);
  CHECK_THROWS_WITH(banded.add<Distance>({0, 2}, {0.1, 0.0}), Contains("do not follow each other"));
  banded.add<Distance>({0, 1}, {0.1, 0.0});
  CHECK_THROWS_WITH(banded.add<Distance>({0, 1}, {0.1, 0.0}), Contains("given twice"));
}

struct Kick : Field<"kick", "N s", Vector, Beads> {};  // as a coupling keeps one
TEST_CASE("a rod that does not fit writes nothing, and one that does begins without impulses",
          "[constraint][builder][B13]") {
  RodAssembly<Body> rod;
  add_thread(rod, straight({{0, 0, 0}}, {{0.02, 0, 0}}, 4), nylon);
  State<double, union_t<Body::AllFields, Fields<Kick>>> store(1);
  store.table<Beads>().resize(1, rod.beads());
  store.table<Instances<Distance>>().resize(1, rod.instances<Distance>());
  for_each_type(typename decltype(store)::Domains{}, [&]<class D>(std::type_identity<D>) {
    if (store.table<D>().capacity() == 0) store.table<D>().resize(1, 1);
  });
  store.table<Instances<Distance>>().resize(1, rod.instances<Distance>() - 1);
  CHECK_THROWS_AS(rod.write(store, 0), std::out_of_range);
  CHECK(store.table<Beads>().live(0) == 0);
  store.table<Instances<Distance>>().resize(1, 64);
  for_each_type(typename Body::Set::List{},
                [&]<class C>(std::type_identity<C>) { store.table<Instances<C>>().resize(1, 64); });
  CHECK_THROWS_AS(rod.write(store, 1), std::out_of_range);
  store.set<Kick>(0, 2, vec(1.0, 0.0, 0.0));
  rod.write(store, 0);
  CHECK(store.table<Beads>().live(0) == rod.beads());
  CHECK(norm(store.get<Kick>(0, 2)) == 0.0);
}
