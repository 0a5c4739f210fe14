// Squeezed tissue grips a thread harder: the force that pulls it rises by mu times the added pressure
// times the thread's surface.
//
// A long block between four rough walls is put under a stress that is known in closed form: a uniform
// stretch whose axial part leaves its two ends free of stress. A straight thread is pulled through it.
// seconds: 12
// on a device
#include <cmath>

#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/coupling/tissue_pressure.hpp>
#include <mpmpbd/effects/viscosity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include "catch.hpp"
#include "physics/back_end.hpp"

using namespace mpmpbd;

namespace {

struct Tissue : Mpm<NeoHookean> {};
struct Thread : Pbd<Constraints<Distance>> {};
using West = Wall<Sticky, 0, Side::low>;
using East = Wall<Sticky, 0, Side::high>;
using South = Wall<Sticky, 1, Side::low>;
using North = Wall<Sticky, 1, Side::high>;
template <class... Laws>
struct Pulled : Scene<Tissue, Thread, Coupling<Embedded, Friction, Laws...>, Viscosity, West, East,
                      South, North> {};

constexpr double dx = 2e-3, density = 1050, shear = 5e3;
constexpr double wide = 6 * dx, length = 20 * dx;  // of the block
constexpr double radius = 2e-4, mu = 0.3, speed = 0.02;
constexpr double surface = 2 * pi<double> * radius * length;
constexpr int margin = 3, beads = 30;
constexpr Lame<double> stiffness{.mu = shear, .lambda = 2 * shear};

// Stretches across the thread, and along it so that no stress is left there.
struct Squeeze {
  double x, y, z;
  double J() const { return x * y * z; }
  double stress(double stretch) const {  // Cauchy [Pa]
    return (stiffness.mu * (stretch * stretch - 1) + stiffness.lambda * std::log(J())) / J();
  }
  double pressure() const { return -0.5 * (stress(x) + stress(y)); }
};
// Where f falls through 0 between 0.5 and 2.
template <class F> double root(F const& f) {
  double low = 0.5, high = 2;
  for (int i = 0; i < 60; ++i) (f(0.5 * (low + high)) < 0 ? low : high) = 0.5 * (low + high);
  return 0.5 * (low + high);
}
Squeeze between_four_plates(double x, double y) {
  return {x, y, root([&](double z) { return Squeeze{x, y, z}.stress(z); })};
}
Squeeze between_two_plates(double x) {
  double const y = root([&](double s) { return Squeeze{x, s, s}.stress(s); });
  return {x, y, y};
}

RodAssembly<Thread> thread() {
  std::vector<Vec3<double>> line;
  double const c = margin * dx + wide / 2;
  for (int k = 0; k < beads; ++k)
    line.push_back(vec(c + 0.13 * dx, c - 0.21 * dx, margin * dx + (k - 3.4) * 0.95 * dx));
  RodAssembly<Thread> rod;
  add_thread(rod, std::span<Vec3<double> const>(line), RodMaterial{1e9, radius, 1100.0});
  return rod;
}

template <class S>
Simulation<S, test::BackEnd, double> block(Squeeze const& squeeze, double clamp) {
  SimulationOptions o;
  o.cell_size = dx;
  for (int a = 0; a < 3; ++a) o.nodes[a] = 2 * margin + (a == 2 ? 20 : 6) + 1;
  o.nodes[2] += 6;
  o.capacity = thread().capacity();
  o.capacity.push_back({"particle", 12 * 12 * 40});
  o.capacity.push_back({"contact point", beads});
  Simulation<S, test::BackEnd, double> sim(o);
  sim.template set<NeoHookean>(stiffness);
  sim.template set<Viscosity>({2.0});
  sim.template set<Embedded>({radius});
  sim.template set<Friction>({mu, clamp});
  sim.template set<West>({margin * dx});
  sim.template set<South>({margin * dx});
  sim.template set<East>({margin * dx + wide});
  sim.template set<North>({margin * dx + wide});
  std::vector<Vec3<double>> points;
  for (int k = 0; k < 40; ++k)
    for (int j = 0; j < 12; ++j)
      for (int i = 0; i < 12; ++i)
        points.push_back(margin * dx * vec(1.0, 1.0, 1.0) +
                         dx / 2 * vec(i + 0.5, j + 0.5, k + 0.5));
  sim.add_particles(0, points, density, dx * dx * dx / 8);
  auto& state = sim.state();
  Mat3<double> F{};
  F(0, 0) = squeeze.x, F(1, 1) = squeeze.y, F(2, 2) = squeeze.z;
  for (std::int64_t p = 0; p < state.template table<Particles>().live(0); ++p) {
    state.template set<particle::Deformation>(0, p, F);
    state.template set<particle::Volume>(0, p, dx * dx * dx / 8 / squeeze.J());
  }
  thread().write(state, 0);
  state.template table<ContactPoints>().set_live(0, beads);
  state.template set<bead::InverseMass>(0, beads - 1, 0.0);  // the hand
  state.template set<bead::Velocity>(0, beads - 1, vec(0.0, 0.0, speed));
  return sim;
}

// Mean tension at the hand while the thread slides steadily [N].
template <class... Laws> double pull(Squeeze const& squeeze, double clamp) {
  auto sim = block<Pulled<Laws...>>(squeeze, clamp);
  double const h = 1e-3;
  double sum = 0;
  int const settle = 60, steps = 100;
  for (int s = 0; s < steps; ++s) {
    sim.step(h);
    if (s >= settle) sum += sim.state().template get<bead::Tension>(0, beads - 2);
  }
  CHECK(sim.status(0) == 0);
  return sum / (steps - settle);
}

}  // namespace

TEST_CASE("squeezed tissue grips a thread by mu times pressure times area",
          "[coupling][friction][squeeze]") {
  double const clamp = 400;
  Squeeze const none{1, 1, 1};
  double const base = pull<TissuePressure>(none, clamp);
  CAPTURE(base, mu * clamp * surface);
  CHECK(base == Approx(mu * clamp * surface).epsilon(0.1));

  for (Squeeze const& squeeze : {between_four_plates(0.93, 0.93), between_four_plates(0.97, 0.9),
                                 between_two_plates(0.85)}) {
    double const added = squeeze.pressure();
    double const force = pull<TissuePressure>(squeeze, clamp);
    CAPTURE(squeeze.x, squeeze.y, squeeze.z, added, force, (force - base) / (mu * added * surface));
    REQUIRE(added > 300);
    CHECK(force - base == Approx(mu * added * surface).epsilon(0.1));
  }
}

TEST_CASE("tissue under tension grips less, down to nothing", "[coupling][friction][squeeze]") {
  Squeeze const stretched = between_four_plates(1.04, 1.06);
  double const pressure = stretched.pressure();
  REQUIRE(pressure < -300);
  CHECK(pull<TissuePressure>(stretched, 0.8 * -pressure) < 0.01 * mu * -pressure * surface);
  CHECK(pull<TissuePressure>(stretched, 2 * -pressure) ==
        Approx(mu * -pressure * surface).epsilon(0.1));
}

TEST_CASE("without the law of tissue pressure a squeeze changes nothing",
          "[coupling][friction][squeeze]") {
  CHECK(pull<>(between_four_plates(0.93, 0.93), 400) ==
        Approx(pull<>({1, 1, 1}, 400)).epsilon(0.02));
}
