// The tissue's own pressure at the points of needle and thread: how it is gathered, and that scenes without
// it have nothing of it. What it does to a thread is in tests/physics/coupling_squeeze.cpp.
// seconds: 5
#include <algorithm>
#include <cmath>
#include <random>

#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/coupling/tissue_pressure.hpp>
#include <mpmpbd/effects/prony.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/testing/batch_laws.hpp>
#include <mpmpbd/testing/coupling_laws.hpp>

#include "catch.hpp"

using namespace mpmpbd;

namespace {

struct Tissue : Mpm<NeoHookean> {};
struct Thread : Pbd<Constraints<Distance>> {};
struct Squeezed : Scene<Tissue, Thread, Coupling<Embedded, Friction, TissuePressure>> {};
struct Gripped : Scene<Tissue, Thread, Coupling<Embedded, Friction>> {};
struct Relaxing : Scene<Tissue, Thread, Coupling<Embedded, Friction, TissuePressure>, Prony<>> {};

// Only the scene that names it keeps a stress, and it has no more stages for it.
static_assert(contains<Squeezed::StateFields, particle::KeptStress>);
static_assert(!contains<Gripped::StateFields, particle::KeptStress>);
static_assert(Squeezed::Substep::Stages::size == Gripped::Substep::Stages::size);
static_assert(std::is_same_v<Gripped::Effects, TypeList<>>);
// The stress that is kept is the whole one: after every other effect on it.
static_assert(std::is_same_v<Relaxing::Effects, TypeList<Prony<>, TissuePressure::Keep>>);

constexpr double dx = 2e-3;

// Particles and points as the law sees them.
template <class T> struct Cloud {
  using Scalar = T;
  std::vector<Vec3<T>> x;
  std::vector<T> volume;
  std::vector<Mat3<T>> F;
  std::vector<Vec<T, 6>> stress;
  template <class F_> value_t<F_, T> get(std::int64_t p) const {
    auto const i = static_cast<std::size_t>(p);
    if constexpr (std::is_same_v<F_, particle::Position>) return x[i];
    if constexpr (std::is_same_v<F_, particle::Volume>) return volume[i];
    if constexpr (std::is_same_v<F_, particle::Deformation>) return F[i];
    if constexpr (std::is_same_v<F_, particle::KeptStress>) return stress[i];
  }
  template <class Domain> std::int64_t live() const { return static_cast<std::int64_t>(x.size()); }
  void reverse() {
    std::reverse(x.begin(), x.end());
    std::reverse(volume.begin(), volume.end());
    std::reverse(F.begin(), F.end());
    std::reverse(stress.begin(), stress.end());
  }
};
template <class T> struct Points {
  using Scalar = T;
  Lattice<T> lattice = Lattice<T>::make(T(dx), 14, 13, 12);
  std::vector<ContactPoint<T>> of;
  ContactPoint<T>* points = nullptr;

  int count() const { return static_cast<int>(of.size()); }
  void gather(Cloud<T> const& cloud) {
    points = of.data();
    auto const bytes = TissuePressure::bytes<T, QuadraticBSpline>(
        count(), static_cast<int>(lattice.count()), cloud.template live<Particles>());
    std::vector<double> memory(bytes / sizeof(double) + 1);
    TissuePressure::gather<QuadraticBSpline>(Solo{}, cloud, *this, memory.data());
  }
};

// A cloud at random places, and a line of points across it.
template <class T, class StressAt> Cloud<T> cloud(StressAt const& tau_at) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> U(0, 1);
  Cloud<T> c;
  for (int p = 0; p < 5000; ++p) {
    auto const x = dx * vec(2 + 9 * U(random), 2 + 8 * U(random), 2 + 7 * U(random));
    Mat3<double> F = Mat3<double>::identity();
    F(0, 0) = 0.8 + 0.4 * U(random);
    Vec<double, 6> const s = determinant(F) * tau_at(x);
    c.x.push_back(cast<T>(x));
    c.volume.push_back(T(1e-9 * (0.5 + U(random))));
    c.F.push_back(cast<T>(F));
    c.stress.push_back(cast<T>(s));
  }
  return c;
}
template <class T> Points<T> line(Vec3<double> const& t) {
  Points<T> p;
  for (int q = 0; q < 9; ++q) {
    ContactPoint<T> point{};
    point.position = cast<T>(dx * vec(6.3, 5.7, 5.1) + 0.33 * dx * (q - 4) * t);
    point.axis = cast<T>(t);
    point.contact = q == 2 ? Contact::surface : q == 5 ? Contact::off : Contact::member;
    point.pressure = T(q);
    p.of.push_back(point);
  }
  return p;
}

// Cauchy stress xx yy zz xy yz zx, and a direction.
constexpr Vec<double, 6> uniform{{-900, 300, -450, 120, -70, 210}};
Vec3<double> const tangent = direction(vec(0.5, -0.3, 0.9));
// The mean of n . sigma n over the directions n across t, written out.
double across(Vec<double, 6> const& s, Vec3<double> const& t) {
  Vec3<double> const a = any_across(t), b = cross(t, a);
  auto const normal = [&](Vec3<double> const& n) {
    return s[0] * n[0] * n[0] + s[1] * n[1] * n[1] + s[2] * n[2] * n[2] +
           2 * (s[3] * n[0] * n[1] + s[4] * n[1] * n[2] + s[5] * n[2] * n[0]);
  };
  return 0.5 * (normal(a) + normal(b));
}

}  // namespace

TEMPLATE_TEST_CASE("a uniform stress gives its mean across the thread", "[coupling][squeeze]",
                   float, double) {
  auto points = line<TestType>(tangent);
  points.gather(cloud<TestType>([](auto const&) { return uniform; }));
  for (int q = 0; q < points.count(); ++q) {
    auto const& p = points.of[static_cast<std::size_t>(q)];
    CAPTURE(q);
    if (p.contact == Contact::member)
      CHECK(double(p.pressure) ==
            Approx(-across(uniform, tangent)).epsilon(100 * double(epsilon<TestType>)));
    else
      CHECK(p.pressure == 0);  // nobody asks
  }
}

TEST_CASE("a stress that grows linearly is found to a cell's unevenness", "[coupling][squeeze]") {
  auto const at = [](Vec3<double> const& x) { return (1 + 30 * x[2] / dx) * uniform; };
  auto points = line<double>(tangent);
  points.gather(cloud<double>(at));
  for (auto const& p : points.of)
    if (p.contact == Contact::member)
      CHECK(p.pressure == Approx(-across(at(p.position), tangent)).epsilon(0.05));
}

TEST_CASE("the numbering of particles changes rounding alone", "[coupling][squeeze]") {
  auto const at = [](Vec3<double> const& x) { return std::sin(2 * x[0] / dx) * uniform; };
  auto forwards = line<double>(tangent), backwards = line<double>(tangent);
  auto c = cloud<double>(at);
  forwards.gather(c);
  c.reverse();
  backwards.gather(c);
  for (std::size_t q = 0; q < forwards.of.size(); ++q)
    CHECK(forwards.of[q].pressure == Approx(backwards.of[q].pressure).epsilon(1e-12));
}

TEST_CASE("where no tissue is, no pressure is", "[coupling][squeeze]") {
  auto points = line<double>(tangent);
  auto c = cloud<double>([](auto const&) { return uniform; });
  for (auto& x : c.x) x = dx * vec(11.5, 11.5, 10.5);
  points.gather(c);
  for (auto const& p : points.of)
    if (p.contact == Contact::member) CHECK(p.pressure == 0);
}

// What friction makes of it: mu times pressure times the area of the point, on top of the lateral load.
TEST_CASE("pressure adds to what clamps, tension takes from it down to nothing",
          "[coupling][squeeze]") {
  ContactLaw<double, Friction, NoDrag> const law{2e-4, {0.3, 150.0}, {}};
  ContactPoint<double> p{};
  p.contact = Contact::member;
  p.axis = vec(0.0, 0.0, 1.0);
  p.length = 1.7e-3;
  p.radius = 2e-4;
  auto const impulse = vec(3e-6, -4e-6, 9e-6);  // 5e-6 sideways
  for (double const pressure : {0.0, 900.0, -100.0, -149.0, -151.0, -4000.0}) {
    p.pressure = pressure;
    double const clamped = std::max(150.0 + pressure, 0.0) * 2 * pi<double> * 2e-4 * 1.7e-3 * 2e-4;
    CAPTURE(pressure);
    CHECK_THAT(law.friction_cap(p, impulse), WithinRel(0.3 * (5e-6 + clamped), 1e-12));
  }
}

TEMPLATE_TEST_CASE("Embedded keeps its laws with tissue pressure", "[coupling][squeeze]", float,
                   double) {
  using Laws_ = Coupling<Embedded, Friction, TissuePressure>;
  for (auto const& law : coupling_laws<Laws_, TestType>({{1e-4}, {0.2, 100.0}, {}})) {
    INFO(law.text());
    CHECK(law.holds());
  }
}

namespace {

// A squeezed block with a thread that is drawn through it.
struct Fill {
  static RodAssembly<Thread> thread() {
    RodAssembly<Thread> rod;
    std::vector<Vec3<double>> line;
    for (int k = 0; k < 8; ++k) line.push_back(dx * vec(2.6 + 0.9 * k, 5.2, 5.4));
    add_thread(rod, std::span<Vec3<double> const>(line), RodMaterial{1e8, 2e-4, 1100.0});
    return rod;
  }
  static SimulationOptions options() {
    SimulationOptions o;
    o.cell_size = dx;
    for (int a = 0; a < 3; ++a) o.nodes[a] = 13;
    o.capacity = thread().capacity();
    o.capacity.push_back({"particle", 2400});
    o.capacity.push_back({"contact point", 8});
    return o;
  }
  template <class R> void operator()(R& run, std::int64_t env, int which) const {
    using T = typename R::Scalar;
    run.template set<NeoHookean>(env, lame(2e4, 0.4));
    run.template set<Embedded>(env, {2e-4});
    run.template set<Friction>(env, {0.2 + 0.1 * which, 100.0});
    std::vector<Vec3<double>> points;
    for (int k = 0; k < 11; ++k)
      for (int j = 0; j < 11; ++j)
        for (int i = 0; i < 13; ++i)  // more than a chunk, not a multiple of four
          points.push_back(dx * (vec(3.2, 2.7, 2.7) + 0.5 * vec(double(i), double(j), double(k))));
    run.add_particles(env, points, 1050.0, dx * dx * dx / 8);
    auto& state = run.state();
    Mat3<T> F = Mat3<T>::identity();
    F(0, 0) = F(1, 1) = T(0.95 - 0.01 * which);
    for (std::int64_t p = 0; p < state.template table<Particles>().live(env); ++p)
      state.template set<particle::Deformation>(env, p, F);
    thread().write(state, env);
    state.template table<ContactPoints>().set_live(env, 8);
    for (int k = 0; k < 8; ++k) state.template set<bead::Velocity>(env, k, vec(T(0.4), T(0), T(0)));
  }
};

}  // namespace

TEMPLATE_TEST_CASE("squeezed environments give the same bits in any batch and on any threads",
                   "[coupling][squeeze][batch]", float, double) {
  testing::BatchCase<Fill> const c{Fill::options(), Fill{}, 1e-3, 3};
  for (auto const& law : batch_laws<Squeezed, TestType>(c)) {
    INFO(law.text());
    CHECK(law.holds());
  }
  // The comparison means something: the squeeze does grip.
  testing::BatchProbe<Squeezed, TestType, Fill> const squeezed(c);
  testing::BatchProbe<Gripped, TestType, Fill> const gripped(c);
  auto const speed = [](auto const& probe) {
    return double(probe.reference().state().template get<bead::Velocity>(0, 4)[0]);
  };
  CHECK(speed(squeezed) < 0.9 * speed(gripped));
}
