// B4, B5, B8, B9, B11, B41: particles in awkward places of the grid, and scenes in which there is nothing.
// seconds: 5
#include <cmath>
#include <set>

#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>
#include <mpmpbd/testing/batch_laws.hpp>

#include "catch.hpp"
#include "physics/needle_in_gel.hpp"
#include "physics/thread_in_gel.hpp"
#include "stability/block.hpp"

using namespace test;

namespace {

Lame<double> const soft = lame(1.3e4, 0.4);

template <class Body> struct Alone : Scene<Body> {};
template <class... Policies> struct Tissue : Mpm<NeoHookean, Policies...> {};

// Flies 1.7 cells in each of four steps, far below the limit of elastic waves.
Block<Alone<Tissue<>>> flight(int substeps, double h) {
  Block<Alone<Tissue<>>> block({.nodes = {{24, 12, 12}}, .substeps = substeps}, soft);
  block.stir(vec(1.7 * block.c.cell / h, 0.0, 0.0), {});
  for (int s = 0; s < 4; ++s) block.run.step(h);
  return block;
}

}  // namespace

TEST_CASE("a particle that moves 1.7 cells in a step is reported or sub-stepped",
          "[stability][B4]") {
  double const h = 1e-5;
  auto const start = BlockCase{}.positions();
  auto const strict = flight(1, h);
  CHECK(strict.run.status(0) == (Fault::speed | Fault::time_step));
  CHECK(strict.sums().finite);
  CHECK(strict.sums().inside);

  auto const automatic = flight(0, h);
  CHECK(automatic.run.status(0) == 0);
  CHECK(automatic.run.state().get<environment::Substeps>(0) == 5);  // 1.7 / (0.8 0.5), rounded up
  auto const way = vec(4 * 1.7 * automatic.c.cell, 0.0, 0.0);
  for (auto const* block : {&strict, &automatic})
    for (std::int64_t p = 0; p < block->size(); ++p) {
      auto const at = start[static_cast<std::size_t>(p)] + way;
      CHECK(norm(block->get<particle::Position>(p) - at) < 1e-13);
    }
}

namespace {

// Places along an axis of n nodes, in cells: the first and the last that a particle may have, a number
// beside each, and the same around a node, a cell's middle and a place between.
template <class Shape, class T> std::vector<T> awkward_places(int n, T dx) {
  T const low = lowest_cell<Shape, T>() * dx, high = highest_cell<Shape, T>(n) * dx;
  std::vector<T> all{low, std::nextafter(low, high), high, std::nextafter(high, low)};
  for (double const cells : {5.0, 4.5, 4.25})
    for (T const towards : {low, high}) {
      T const at = static_cast<T>(cells) * dx;
      all.push_back(at);
      all.push_back(std::nextafter(at, towards));
    }
  return all;
}

// A lone particle keeps its affine motion through the grid, and all its weights are those of a mean.
template <class Body, class T> void check_place(Vec3<T> const& x) {
  using Shape = typename Body::Shape;
  Block<Alone<Body>, T> one({.cells = {{1, 1, 1}}, .nodes = {{9, 9, 9}}, .per_axis = 1}, soft);
  auto const lattice = one.run.lattice();
  auto const stencil = Stencil<T, Shape>::at(lattice, x);
  CHECK(stencil.inside(lattice));
  for (T const f : stencil.f) {
    T sum = 0;
    for (int i = 0; i < Shape::width; ++i) {
      CHECK(Shape::weight(i, f) >= T(0));
      sum += Shape::weight(i, f);
    }
    CHECK(mpmpbd::abs(sum - 1) <= 4 * epsilon<T>);
  }
  Vec3<double> v{};  // inwards, so that it does not leave
  for (int a = 0; a < 3; ++a) v[a] = (x[a] < T(4) * lattice.dx ? 1.0 : -1.0) * (0.11 + 0.03 * a);
  Mat3<double> const L{{3.0, -9.0, 4.0, 7.0, -2.0, 5.0, -6.0, 1.0, -4.0}};
  one.template set<particle::Position>(0, cast<double>(x));
  one.template set<particle::Velocity>(0, v);
  one.template set<particle::Affine>(0, L);
  double const h = 1e-7;
  one.run.step(h);
  double const rounding = 64 * double(epsilon<T>);
  CHECK(one.run.status(0) == 0);
  CHECK(norm(one.template get<particle::Velocity>(0) - v) < rounding * norm(v));
  // A gradient is a difference of speeds over a cell.
  double const rate = norm(L) + norm(v) / one.c.cell;
  CHECK(norm(one.affine(0) - L) < rounding * rate);
  auto const F = Mat3<double>::identity() + h * L;
  CHECK(norm(one.template get<particle::Deformation>(0) - F) < rounding * (1 + h * rate));
}

template <class Body, class T> void check_places() {
  auto const places = awkward_places<typename Body::Shape, T>(9, static_cast<T>(BlockCase{}.cell));
  T const ordinary = static_cast<T>(4.37 * BlockCase{}.cell);
  for (T const a : places) {
    CAPTURE(a);
    check_place<Body, T>(vec(a, a, a));
    for (int axis = 0; axis < 3; ++axis) {
      Vec3<T> x = vec(ordinary, ordinary, ordinary);
      x[axis] = a;
      check_place<Body, T>(x);
    }
  }
}

}  // namespace

// Not the linear shape: alone at a node, its particle has no neighbour to tell a gradient from.
TEMPLATE_TEST_CASE("a particle may be on a node, on a face, at the border and one ulp beside",
                   "[stability][B5]", float, double) {
  check_places<Tissue<QuadraticBSpline, Mls>, TestType>();
  check_places<Tissue<QuadraticBSpline, Tpic, WeightGradient>, TestType>();
  check_places<Tissue<CubicBSpline, Mls>, TestType>();
  check_places<Tissue<CubicBSpline, Tpic, WeightGradient>, TestType>();
}

namespace {

// A block that swings, so many cells from the origin along x: its places there and its strains.
template <class T> struct Far {
  Block<Alone<Tissue<>>, T> block;
  explicit Far(int shift)
      : block({.low = vec(4.13 + shift, 4.27, 4.41), .nodes = {{12 + shift, 12, 12}}}, soft) {
    Mat3<double> const L{{30.0, -90.0, 40.0, 70.0, -20.0, 50.0, -60.0, 10.0, -40.0}};
    block.stir(vec(0.2, -0.1, 0.15), L);
    for (int s = 0; s < steps; ++s) block.run.step(3e-4);
  }
  static constexpr int steps = 60;
};

template <class T> void check_shift() {
  Far<T> const near(0);
  for (int const shift : {1, 16, 256, 4096, 8192}) {
    Far<T> const far(shift);
    auto const way = vec(shift * far.block.c.cell, 0.0, 0.0);
    double moved = 0, strained = 0;  // differences [cells], [1]
    for (std::int64_t p = 0; p < near.block.size(); ++p) {
      moved = max(moved, norm(far.block.template get<particle::Position>(p) - way -
                              near.block.template get<particle::Position>(p)) /
                             far.block.c.cell);
      strained = max(strained, norm(far.block.template get<particle::Deformation>(p) -
                                    near.block.template get<particle::Deformation>(p)));
    }
    // Each step rounds a position of so many cells once.
    double const rounding = Far<T>::steps * double(epsilon<T>) * (shift + 12);
    CAPTURE(shift, moved / rounding, strained / rounding);
    CHECK(moved < rounding);
    CHECK(strained < rounding);
    CHECK(far.block.run.status(0) == 0);
  }
}

}  // namespace

TEMPLATE_TEST_CASE("a block far from the origin moves as one near it, to rounding",
                   "[stability][B8]", float, double) {
  check_shift<TestType>();
}

namespace {
BlockCase const lone{.cells = {{1, 1, 1}}, .nodes = {{9, 9, 9}}, .per_axis = 1};

// Of a particle that carries C: that of C, its inertia being m D in every direction. [kg m^2/s]
template <class B> Vec3<double> spin(B const& one) {
  auto const C = one.affine(0);
  double const D = square(one.c.cell) / B::Body::Shape::inverse_inertia;
  return one.template get<particle::Mass>(0) * D *
         vec(C(2, 1) - C(1, 2), C(0, 2) - C(2, 0), C(1, 0) - C(0, 1));
}
}  // namespace

// A gradient w x turns its F by 1 + h [w], which also stretches it by (w h)^2 / 2 a step; the stress of that is
// even in direction and keeps C's skew part.
TEMPLATE_TEST_CASE("a lone particle that spins keeps its angular momentum", "[stability][B9]",
                   (Tissue<QuadraticBSpline, Mls>), (Tissue<CubicBSpline, Mls>)) {
  Block<Alone<TestType>> one(lone, soft);
  auto const w = vec(30.0, -20.0, 50.0);
  one.stir({}, skew(w));
  double const h = 0.2 * one.limit();
  auto const start = spin(one);
  CHECK(norm(start) > 0);
  double drift = 0;
  for (int s = 0; s < 1000; ++s) {
    one.run.step(h);
    drift = max(drift, norm(spin(one) - start));
  }
  CAPTURE(drift / norm(start), h * norm(w) * 1000);
  CHECK(one.sums().finite);
  CHECK(one.run.status(0) == 0);
  CHECK(drift <= 1e-12 * norm(start));
}

TEMPLATE_TEST_CASE("a lone particle at rest stays as it is, bit for bit", "[stability][B9]", float,
                   double) {
  Block<Alone<Tissue<>>, TestType> one(lone, soft);
  auto const x = one.template get<particle::Position>(0);
  for (int s = 0; s < 1000; ++s) one.run.step(0.9 * one.limit());
  CHECK(one.template get<particle::Position>(0) == x);
  CHECK(one.template get<particle::Velocity>(0) == Vec3<double>{});
  CHECK(one.template get<particle::Deformation>(0) == Mat3<double>::identity());
  CHECK(one.affine(0) == Mat3<double>{});
  CHECK(one.run.status(0) == 0);
}

namespace {
// Eight particles per environment, each with a stiffness and motions of its own.
struct Crowd {
  using Run = Simulation<Alone<Tissue<>>, Serial, float>;
  static constexpr std::int64_t particles = 8;
  BlockCase c{
      .low = vec(3.13, 3.27, 3.41), .cells = {{1, 1, 1}}, .nodes = {{8, 8, 8}}, .substeps = 0};
  Run of(std::int64_t environments) const {
    auto options = c.options(particles);
    options.environments = environments;
    return Run(options);
  }
  void fill(Run& run, std::int64_t slot, std::int64_t which) const {
    testing::Samples random(static_cast<std::uint64_t>(which) + 1);
    run.set<NeoHookean>(slot, lame(random.log_uniform(2e3, 5e5), random.uniform(0.1, 0.45)));
    run.add_particles(slot, c.positions(), c.density, c.volume());
    for (std::int64_t p = 0; p < particles; ++p)
      run.state().set<particle::Velocity>(slot, p, cast<float>(random.matrix<3>(-0.2, 0.2)));
  }
  static void advance(Run& run) {
    for (int s = 0; s < 5; ++s) run.step(2e-4);
  }
};
}  // namespace

TEST_CASE("a thousand different environments are each as when alone, though one blows up",
          "[stability][B8][B41]") {
  Crowd const crowd;
  std::int64_t const many = 1000, broken = 500;
  auto batch = crowd.of(many);
  for (std::int64_t e = 0; e < many; ++e) crowd.fill(batch, e, e);
  float const nan = std::numeric_limits<float>::quiet_NaN();
  batch.state().set<particle::Velocity>(broken, 3, vec(nan, 0.0f, 0.0f));
  Crowd::advance(batch);
  for (std::int64_t const e : {std::int64_t{0}, broken - 1, broken + 1, many - 1}) {
    auto alone = crowd.of(1);
    crowd.fill(alone, 0, e);
    Crowd::advance(alone);
    CHECK(testing::same_bits(batch.state(), e, alone.state(), 0));
  }
  // They do differ, in their substeps too.
  CHECK_FALSE(testing::same_bits(batch.state(), 0, batch.state(), many - 1));
  std::set<std::int64_t> substeps;
  for (std::int64_t e = 0; e < many; ++e) {
    CHECK(has(batch.status(e), Fault::not_finite) == (e == broken));
    substeps.insert(batch.state().get<environment::Substeps>(e));
  }
  CHECK(substeps.size() > 2);
}

namespace {

struct Coupled : Scene<Gel, ThreadInGel::Rods, ArcNeedle, Coupling<Embedded, Friction>> {};

// A block of gel that swings; the same steps for every scene with gel.
template <class S> Simulation<S, Serial, double> swung(std::vector<Capacity> const& more) {
  GelBlock const block{.low = {4, 4, 4}, .high = {7, 7, 7}, .substeps = 1};
  Simulation<S, Serial, double> run(block.options(more));
  block.fill(run);
  testing::Samples random(3);
  for (std::int64_t p = 0; p < block.particles(); ++p)
    run.state().template set<particle::Velocity>(0, p, random.matrix<3>(-0.1, 0.1));
  if constexpr (S::has_needle) {
    run.template set<ArcNeedle>({5 * gel_cell, 2.0, 1e-4, 0.0, 0.0, 0.0});
    run.template set<Embedded>({2e-4});
    run.template set<Friction>({0.2, 500.0});
  }
  for (int s = 0; s < 40; ++s) run.step(2e-4);
  return run;
}

}  // namespace

TEST_CASE("a scene whose needle and threads are not there is one of tissue alone",
          "[stability][B11]") {
  using Rods = ThreadInGel::Rods;
  auto capacity = ThreadInGel{}.rod<Rods>().capacity();
  capacity.push_back({Needles::name.view(), 1});
  capacity.push_back({ContactPoints::name.view(), 40});
  auto const coupled = swung<Coupled>(capacity);
  auto const alone = swung<Alone<Gel>>({});
  CHECK(coupled.status(0) == 0);
  CHECK(alone.status(0) == 0);
  for (std::int64_t p = 0; p < 8 * 27; ++p) {
    CHECK(coupled.state().get<particle::Position>(0, p) ==
          alone.state().get<particle::Position>(0, p));
    CHECK(coupled.state().get<particle::Deformation>(0, p) ==
          alone.state().get<particle::Deformation>(0, p));
  }
}

TEST_CASE("an empty environment in a batch runs and leaves the others alone", "[stability][B11]") {
  BlockCase const c;
  auto options = c.options(216);
  options.environments = 3;
  Simulation<Alone<Tissue<>>, Serial, double> run(options);
  run.set<NeoHookean>(soft);
  for (std::int64_t const e : {0, 2}) {
    run.add_particles(e, c.positions(), c.density, c.volume());
    for (std::int64_t p = 0; p < 216; ++p)
      run.state().set<particle::Velocity>(e, p, vec(0.01 * double(p), -0.2, 0.1));
  }
  for (int s = 0; s < 20; ++s) run.step(2e-4);
  for (std::int64_t e = 0; e < 3; ++e) CHECK(run.status(e) == 0);
  for (std::int64_t p = 0; p < 216; ++p)
    CHECK(run.state().get<particle::Position>(0, p) == run.state().get<particle::Position>(2, p));
}

TEST_CASE("a thread of one bead, or without length, is refused and nothing is added",
          "[stability][B11]") {
  RodAssembly<ThreadInGel::Rods> rod;
  auto const x = vec(0.01, 0.02, 0.03);
  for (auto const& points : {std::vector<Vec3<double>>{x}, std::vector<Vec3<double>>{x, x},
                             std::vector<Vec3<double>>{}}) {
    CHECK_THROWS_AS(
        add_thread(rod, std::span<Vec3<double> const>(points), ThreadInGel{}.material()),
        std::invalid_argument);
    CHECK(rod.beads() == 0);
  }
}
