// A needle that nothing holds falls as it should, alone and with a thread swaged to it.
// on a device
#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/coupling/grid_projection.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include "catch.hpp"
#include "physics/back_end.hpp"

using namespace mpmpbd;

namespace {

struct Tissue : Mpm<NeoHookean> {};
struct Thread : Pbd<Constraints<Distance, Bend, Swage>> {};
template <class Laws> struct FallingNeedle : Scene<Tissue, FreeArcNeedle, Laws, Gravity> {};
struct Led : Scene<Tissue, ArcNeedle, Coupling<Embedded>, Gravity> {};
struct Suture : Scene<Tissue, Thread, FreeArcNeedle, Coupling<Embedded>, Gravity> {};

// A needle whose motion is given does not fall, so its scene has nothing for it.
static_assert(std::is_same_v<Led::Effects, TypeList<Gravity>>);

constexpr double dx = 2e-3, h = 4e-4;
constexpr int beads = 9, substeps = 2, steps = 60;
constexpr Vec3<double> g{{0.7, -1.1, -9.81}}, start{{18e-3, 17e-3, 60e-3}};
constexpr FreeArcNeedle::Parameters<double> wire{5e-3, 2.3, 3e-4, 1e-3, 0.0, 0.0, 7800.0};
Pose<double> const pose{start, quaternion::from_axis_angle(vec(0.3, 1.0, -0.4), 0.8)};
Twist<double> const twist{vec(0.1, 0.05, 0.4), vec(9.0, -14.0, 6.0)};

RodAssembly<Thread> thread() {
  auto const end =
      to_world(pose, FreeArcNeedle::arc(wire).point(FreeArcNeedle::arc(wire).length()));
  std::vector<Vec3<double>> line;
  for (int k = 0; k < beads; ++k)
    line.push_back(end + (0.8 * dx * (beads - 1 - k)) * direction(vec(0.2, 0.4, 1.0)));
  RodAssembly<Thread> rod;
  add_thread(rod, std::span<Vec3<double> const>(line), RodMaterial{1e7, 2e-4, 1100.0});
  rod.add<Swage>({beads - 1}, {wire.radius, 0.0, 0.0, 0.0});
  return rod;
}

std::int64_t contact_points_needed() {
  return beads + contact_points(ArcPoints<double>::over(FreeArcNeedle::arc(wire), dx));
}
// Far above a few points of tissue, which it does not touch.
template <class S>
Simulation<S, test::BackEnd, double> falling(std::int64_t places = contact_points_needed()) {
  SimulationOptions o;
  o.cell_size = dx;
  o.nodes[0] = o.nodes[1] = 20;
  o.nodes[2] = 45;
  o.substeps = substeps;
  o.capacity = thread().capacity();
  o.capacity.push_back({"particle", 8});
  o.capacity.push_back({"needle", 1});
  o.capacity.push_back({"contact point", places});
  Simulation<S, test::BackEnd, double> sim(o);
  sim.template set<NeoHookean>(lame(2e4, 0.4));
  sim.template set<Gravity>({{g[0], g[1], g[2]}});
  sim.template set<FreeArcNeedle>(wire);
  std::vector<Vec3<double>> points;
  for (int p = 0; p < 8; ++p) points.push_back(dx * vec(5 + 0.5 * p, 5.0, 6.0));
  sim.add_particles(0, points, 1050.0, dx * dx * dx / 8);
  auto& state = sim.state();
  state.template table<Needles>().set_live(0, 1);
  needle::set_pose(state.template view<Needles>(), 0, pose);
  needle::set_twist(state.template view<Needles>(), 0, twist);
  if constexpr (S::has_rods) thread().write(state, 0);
  if constexpr (S::has_rods) sim.template set<Embedded>({2e-4});
  return sim;
}

// Of a needle on which nothing but its weight acts.
template <class Sim> void check_fall(Sim& sim) {
  auto const body = FreeArcNeedle::body(wire);
  auto const view = sim.state().template view<Needles>();
  auto const now = needle::pose(view, 0);
  auto const turning = needle::twist(view, 0);
  // Symplectic Euler of a constant force, exactly: v = v0 + n g dt, x = x0 + n v0 dt + n (n + 1) / 2 g dt^2.
  double const dt = h / substeps, n = steps * substeps;
  Vec3<double> const v0 = body.velocity_of_centre(pose, twist);
  Vec3<double> const x =
      body.centre_of_mass(pose) + (n * dt) * v0 + (0.5 * n * (n + 1) * dt * dt) * g;
  CHECK(norm(body.centre_of_mass(now) - x) < 1e-12);
  CHECK(norm(body.velocity_of_centre(now, turning) - (v0 + n * dt * g)) < 1e-12);
  // Gravity has no moment about the centre of mass.
  Vec3<double> const before = body.times_inertia(pose, twist.angular);
  CHECK(norm(body.times_inertia(now, turning.angular) - before) < 1e-11 * norm(before));
}

}  // namespace

TEMPLATE_TEST_CASE("a free needle falls and turns on as before", "[needle][gravity]",
                   Coupling<Embedded>, Coupling<GridProjection>) {
  auto sim = falling<FallingNeedle<TestType>>();
  for (int s = 0; s < steps; ++s) sim.step(h);
  check_fall(sim);
  CHECK(sim.status(0) == 0);
}

// Its thread has no contact points, rests, and is not tied to it then.
TEST_CASE("a free needle whose thread is left out falls as one without", "[needle][capacity]") {
  auto sim = falling<Suture>(beads - 1);
  auto const before = std::as_const(sim).state().get<bead::Position>(0, 0);
  for (int s = 0; s < steps; ++s) sim.step(h);
  check_fall(sim);
  CHECK(sim.status(0) == static_cast<std::uint32_t>(Fault::overflow));
  CHECK(std::as_const(sim).state().get<bead::Position>(0, 0) == before);
  CHECK(std::as_const(sim).state().get<bead::Velocity>(0, 0) == Vec3<double>{});
}

// The scene names Swage, and this environment has none.
TEST_CASE("a free needle falls alone while no thread is tied to it", "[needle][gravity]") {
  auto sim = falling<Suture>();
  sim.state().table<Instances<Swage>>().set_live(0, 0);
  for (int s = 0; s < steps; ++s) sim.step(h);
  check_fall(sim);
  CHECK(sim.status(0) == 0);
  double const seconds = steps * h;
  for (int k = 0; k < beads; ++k)
    CHECK(norm(sim.state().get<bead::Velocity>(0, k) - seconds * g) < 1e-9);
}

TEST_CASE("a needle that is turned nowhere is lost", "[needle][status]") {
  auto sim = falling<Suture>();
  sim.state().set<needle::Orientation>(0, 0, {});
  sim.step(h);
  CHECK(has(sim.status(0), Fault::not_finite));
}

TEST_CASE("needle and swaged thread gain the momentum of their weight", "[needle][gravity]") {
  auto sim = falling<Suture>();
  auto const body = FreeArcNeedle::body(wire);
  double mass = body.mass;
  for (int k = 0; k < beads; ++k) mass += 1 / sim.state().get<bead::InverseMass>(0, k);
  auto const momentum = [&] {
    auto& state = sim.state();
    auto const view = state.view<Needles>();
    Vec3<double> p = body.momentum(needle::pose(view, 0), needle::twist(view, 0));
    for (int k = 0; k < beads; ++k)
      p += 1 / state.get<bead::InverseMass>(0, k) * state.get<bead::Velocity>(0, k);
    return p;
  };
  double pull = 0;
  // The first substep ties the last bead, which was at rest, to the needle: an impulse between the two.
  Vec3<double> const before = momentum();
  for (int s = 0; s < steps; ++s) {
    sim.step(h);
    pull = std::max(pull, sim.state().get<bead::PeakTension>(0, beads - 2));
    Vec3<double> const gained = momentum() - before;
    CHECK(norm(gained - mass * (s + 1) * h * g) < 1e-12 * norm(mass * h * g) * (s + 1));
  }
  CHECK(pull > 0.1 * mass * 9.81);  // the two do pull at each other
  CHECK(sim.status(0) == 0);
}
