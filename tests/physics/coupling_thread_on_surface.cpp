// A taut thread that lies on tissue lies on it: it is no part of a channel where there is none, and pressing
// does not let it sink in. Where it comes out of a channel, it is in tissue inside the channel alone.
//
// Whole scenes: tissue with its surface, a needle (parked aside), a thread that was never swaged to it.
// seconds: 15
// on a device
#include <algorithm>
#include <cmath>
#include <limits>

#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/effects/air.hpp>
#include <mpmpbd/effects/viscosity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include "catch.hpp"
#include "physics/back_end.hpp"

using namespace mpmpbd;

namespace {

// A given force on every bead.
struct Load : Field<"load", "N", Vector, Beads> {};
struct Pull {
  using Role = role::Effect;
  static constexpr FixedString name = "pull";
  static constexpr Slot slot = Slot::before_solve;
  using Reads = Fields<bead::Velocity, bead::InverseMass, Load>;
  using Writes = Fields<bead::Velocity>;
  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& bead, K const&, Tick<T> const& tick) {
    bead[bead::Velocity{}] += (tick.dt * bead[bead::InverseMass{}]) * bead[Load{}];
  }
};

struct Tissue : Mpm<NeoHookean> {};
struct Thread : Pbd<Constraints<Distance, Bend>> {};
using Floor = Wall<Sticky, 2, Side::low>;
struct OnSurface : Scene<Tissue, Thread, ArcNeedle, Surface, Coupling<Embedded, Friction>,
                         Viscosity, Air, Pull, Floor> {};
using Run = Simulation<OnSurface, test::BackEnd, double>;

constexpr double dx = 2e-3, shear = 3.6e3, density = 1050;
constexpr double unit_force = shear * dx * dx;  // T = 1 [N]
constexpr Vec3<int> cells{{10, 8, 5}};          // of the block
constexpr Vec3<double> corner{{3 * dx, 4 * dx, 3 * dx}};
constexpr double top = corner[2] + 5 * dx, middle = corner[1] + 4.13 * dx;
constexpr double radius = 1e-4;

RodAssembly<Thread> thread(std::vector<Vec3<double>> const& way) {
  double length = 0;
  for (std::size_t i = 1; i < way.size(); ++i) length += norm(way[i] - way[i - 1]);
  RodAssembly<Thread> rod;
  add_thread(rod, std::span<Vec3<double> const>(way), 1 + int(std::ceil(length / (0.8 * dx))),
             RodMaterial{2e8, radius, 1100.0, 0.02});
  return rod;
}

Run block(std::vector<Vec3<double>> const& way) {
  auto const rod = thread(way);
  auto const mesh = box_sheet(
      Box<double>{corner, corner + dx * vec(cells[0] * 1.0, cells[1] * 1.0, cells[2] * 1.0)},
      cells);
  ArcNeedle::Parameters<double> const needle{3 * dx, 1.0, radius, dx, 0.1, 0.05};
  SimulationOptions o;
  o.cell_size = dx;
  o.nodes[0] = 18, o.nodes[1] = 17, o.nodes[2] = 22;
  o.capacity = rod.capacity();
  int const points =
      int(rod.beads()) + contact_points(ArcPoints<double>::over(ArcNeedle::arc(needle), dx));
  for (Capacity const& more :
       std::initializer_list<Capacity>{{"particle", 8 * cells[0] * cells[1] * cells[2]},
                                       {"needle", 1},
                                       {"contact point", points},
                                       {"sheet vertex", std::int64_t(mesh.positions.size())},
                                       {"sheet triangle", std::int64_t(mesh.triangles.size())},
                                       {"marker", 0},
                                       {"event", 4},
                                       {"channel", 1},
                                       {"channel point", 64}})
    o.capacity.push_back(more);
  Run sim(o);
  sim.set<NeoHookean>({.mu = shear, .lambda = 2 * shear});
  sim.set<Viscosity>({1.0});
  sim.set<Air>({20.0});
  sim.set<Floor>({corner[2]});
  sim.set<ArcNeedle>(needle);
  sim.set<Embedded>({radius});
  sim.set<Friction>({0.2, 0.0});
  std::vector<Vec3<double>> x;
  for (int k = 0; k < 2 * cells[2]; ++k)
    for (int j = 0; j < 2 * cells[1]; ++j)
      for (int i = 0; i < 2 * cells[0]; ++i)
        x.push_back(corner + dx / 2 * vec(i + 0.5, j + 0.5, k + 0.5));
  sim.add_particles(0, x, density, dx * dx * dx / 8);
  rod.write(sim.state(), 0);
  auto& state = sim.state();
  load_sheet(mesh, state.table<SheetVertices>(), state.table<SheetTriangles>(), 0);
  state.table<ContactPoints>().set_live(0, points);
  state.table<Needles>().set_live(0, 1);
  Pose<double> const aside{vec(8 * dx, 8 * dx, 17 * dx), {{1, 0, 0, 0}}};
  needle::set_pose(state.view<Needles>(), 0, aside);
  Tip<double>::at(to_world(aside, ArcNeedle::arc(needle).point(0.0)))
      .store(state.view<Needles>(), 0);
  return sim;
}

auto environment_of(Run& sim) {
  return access_environment(sim.state(), 0, typename Run::Store::Domains{});
}
// How deep a point is below the surface as it is now [cells].
double depth(Run& sim, Vec3<double> const& x) {
  auto const env = environment_of(sim);
  auto const sheet = mpmpbd::detail::sheet_of_environment(env);
  auto const mark = mark_at(sheet, x);
  Vec3<double> const normal = direction(sheet.triangle(mark.triangle).area_normal());
  return -dot(x - position(sheet, mark), normal) / dx;
}
// Where point q of the thread is.
Vec3<double> point(Run const& sim, int q) { return sim.state().get<bead::Position>(0, q); }
// Sides of bead q that are in a channel.
int member(Run const& sim, int q) {
  auto const sides = sim.state().get<channel::Member<ContactPoints>>(0, q);
  return ((sides & side_before) != 0) + ((sides & side_after) != 0);
}
int thread_points(Run const& sim) { return int(sim.state().table<Beads>().live(0)); }

// Pulls both ends with T = 1 and presses on the beads from `first` to `last` with `press` in all. The loads
// grow over 30 ms: contact finds a thread where it is at the start of a substep, and one of a thousandth of
// the tissue's mass, that is let go at once, is half a cell further by then.
struct Hands {
  Vec3<double> at_first, at_last;  // unit forces on the ends
  int first, last;
  double press;
  void load(Run& sim, double time) const {
    double const now = std::min(1.0, time / 0.03) * unit_force;
    int const beads = int(sim.state().table<Beads>().live(0));
    sim.state().set<Load>(0, 0, now * at_first);
    sim.state().set<Load>(0, beads - 1, now * at_last);
    for (int k = first; k < last; ++k)
      sim.state().set<Load>(0, k, (now * press / (last - first)) * vec(0.0, 0.0, -1.0));
  }
};

}  // namespace

TEST_CASE("a taut thread laid over uncut tissue and pressed stays on it",
          "[coupling][embedded][surface]") {
  double const press = GENERATE(0.0, 1.0);  // on the middle of the thread, shares of the tension
  CAPTURE(press);
  double const above = top + 0.02 * dx, down = 0.15;
  auto sim = block({vec(1.3 * dx, middle, above), vec(14.7 * dx, middle, above)});
  auto& state = sim.state();
  int const beads = int(state.table<Beads>().live(0));
  Hands const hands{vec(-1.0, 0.0, -down), vec(1.0, 0.0, -down), beads / 2 - 2, beads / 2 + 2,
                    press};
  double deepest = 0, pushed = 0;
  int members = 0;
  for (int s = 0; s < 150; ++s) {
    hands.load(sim, 1e-3 * (s + 1));
    sim.step(1e-3);
    pushed = 0;
    for (int q = 0; q < thread_points(sim); ++q) {
      auto const x = point(sim, q);
      members += member(sim, q);
      pushed -= sim.state().get<contact::Impulse>(0, q)[2];
      if (x[0] > corner[0] && x[0] < corner[0] + 10 * dx)
        deepest = std::max(deepest, depth(sim, x));
    }
  }
  pushed /= sim.state().get<environment::Dt>(0) * unit_force;
  CAPTURE(deepest, pushed, sim.status(0));
  CHECK(members == 0);
  CHECK(deepest < 0.25);
  CHECK(pushed == Approx(2 * down + press).epsilon(0.01));  // the tissue carries all of it
  CHECK(sim.state().get<bead::Tension>(0, beads / 2) == Approx(unit_force).epsilon(0.1));
  CHECK(sim.status(0) == 0);
}

// The channel leads from the top obliquely down to a side; outside of it the thread lies over the top. Numbered from
// either end.
TEST_CASE("a taut thread that comes out of a channel is in tissue inside it alone",
          "[coupling][embedded][surface][channel]") {
  bool const from_top = GENERATE(false, true);
  CAPTURE(from_top);
  double const slope = 0.5, out = 5 * dx;  // where it comes out, from the corner
  Vec3<double> const mouth = vec(corner[0] + out, middle, top);
  Vec3<double> const side = vec(corner[0], middle, top - slope * out);
  Vec3<double> const inwards = direction(side - mouth);
  std::vector<Vec3<double>> way{side + 1.7 * dx * inwards, mouth + 0.05 * dx * vec(0.0, 0.0, 1.0),
                                vec(14.7 * dx, middle, top + 0.05 * dx)};
  Vec3<double> const to_left = inwards, to_right = vec(1.0, 0.0, -0.05);
  if (from_top) std::reverse(way.begin(), way.end());
  auto sim = block(way);
  auto& state = sim.state();
  auto const env = environment_of(sim);
  auto const sheet = mpmpbd::detail::sheet_of_environment(env);
  auto const channels = mpmpbd::detail::channels_of_environment(env);
  channels.open(0, mark_at(sheet, mouth), mouth);
  for (int i = 1; i < 12; ++i) channels.append(0, mouth + (i / 12.0) * (side - mouth));
  channels.set_mouth(0, 1, mark_at(sheet, side));
  channels.append(0, side);

  Hands const hands = from_top ? Hands{to_right, to_left, 3, 7, 0.5}
                               : Hands{to_left, to_right, int(state.table<Beads>().live(0)) - 7,
                                       int(state.table<Beads>().live(0)) - 3, 0.5};
  double deepest = 0, farthest = 0, longest = 0, shortest = 1e9;
  for (int s = 0; s < 150; ++s) {
    hands.load(sim, 1e-3 * (s + 1));
    sim.step(1e-3);
    double length = 0;
    for (int q = 0; q < thread_points(sim); ++q) {
      auto const x = point(sim, q);
      double const apart = channels.distance_to_track(0, x) / dx;
      if (int const sides = member(sim, q); sides > 0) {
        farthest = std::max(farthest, apart);
        length += 0.4 * sides;
      } else if (x[0] > mouth[0] && x[0] < corner[0] + 10 * dx) {
        deepest = std::max(deepest, depth(sim, x));
      }
    }
    longest = std::max(longest, length);
    shortest = std::min(shortest, length);
  }
  double const channel = norm(side - mouth) / dx;
  CAPTURE(deepest, farthest, shortest, longest, channel, sim.status(0));
  CHECK(farthest < 0.5);           // nothing beside the channel
  CHECK(longest < channel + 1.5);  // and nothing beyond its mouths, but for half a cell at each
  CHECK(shortest > channel - 1);   // but all of what is inside
  CHECK(deepest < 0.25);
  CHECK(!has(sim.status(0), Fault::penetration));
}

TEST_CASE("a puncture is noticed in a scene without markers", "[coupling][embedded][surface]") {
  auto sim = block({vec(1.3 * dx, corner[1], top + dx), vec(14.7 * dx, corner[1], top + dx)});
  auto& state = sim.state();
  double const arc_radius = 3 * dx, half = std::sqrt(0.5);
  sim.set<ArcNeedle>({arc_radius, 1.0, radius, dx, 0.01, 0.005});
  Vec3<double> const tip = vec(corner[0] + 5.1 * dx, middle, top + 0.2 * dx);
  Pose<double> const above{tip - vec(arc_radius, 0.0, 0.0), {{half, -half, 0, 0}}};  // points down
  needle::set_pose(state.view<Needles>(), 0, above);
  Tip<double>::at(tip).store(state.view<Needles>(), 0);
  needle::set_twist(state.view<Needles>(), 0, Twist<double>{vec(0.0, 0.0, -0.05), {}});
  for (int s = 0; s < 60 && sim.state().get<event::Count>(0) == 0; ++s) sim.step(1e-3);
  REQUIRE(sim.state().get<event::Count>(0) == 1);
  CHECK(sim.state().get<event::Kind>(0, 0) == std::int64_t(EventKind::entry));
  CHECK(sim.state().get<event::Miss>(0, 0) == infinity<double>);
}
