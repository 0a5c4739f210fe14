// B32: a needle that is pressed on tissue sideways, and with its tip just below and just above the force that
// opens the surface (A4.6). Hysteresis, chatter and a tip that slides along the surface: tests/surface/tip.cpp.
// seconds: 4
#include <algorithm>

#include "catch.hpp"
#include "physics/needle_in_gel.hpp"

using namespace test;

namespace {

struct Pressed
    : Scene<Gel, ArcNeedle, Surface, Coupling<Embedded, Friction>, Damping, Walls<Sticky>> {};

GelBlock block() {
  GelBlock b{.high = {12, 11, 10}};
  for (int a = 0; a < 3; ++a) b.held_low[a] = a == 2 ? 3 : -100, b.held_high[a] = 100;
  b.damping = 0.3 / gel_time();
  return b;
}
double const top = 10;             // of the gel [cells]
double const needle_length = 5.3;  // [cells]

// A straight needle at a pose, over a block with a surface.
struct Press {
  Simulation<Pressed, Serial, double> run;
  double depth = 0, sideways = 0;  // of the needle's way [cells]

  Press(Pose<double> const& pose, Arc<double> const& needle, double puncture_force)
      : run(options(needle)) {
    auto const b = block();
    b.fill(run);
    run.set<ArcNeedle>({needle.radius, needle.angle, needle.wire_radius, 0.0, puncture_force,
                        0.3 * puncture_force});
    run.set<Friction>({0.2, 0.0});
    auto& state = run.state();
    load_sheet(sheet(), state.table<SheetVertices>(), state.table<SheetTriangles>(), 0);
    state.table<ContactPoints>().set_live(0, contacts(needle));
    state.table<Needles>().set_live(0, 1);
    place_needle(run, 0, pose);
    Tip<double>::at(to_world(pose, needle.point(0.0))).store(state.view<Needles>(), 0);
  }
  static int contacts(Arc<double> const& needle) {
    return contact_points(ArcPoints<double>::over(needle, gel_cell));
  }
  static SheetMesh<double> sheet() {
    auto const b = block();
    auto const corner = [](int const(&c)[3]) {
      return gel_cell * vec(1.0 * c[0], 1.0 * c[1], 1.0 * c[2]);
    };
    return box_sheet(Box<double>{corner(b.low), corner(b.high)}, Vec3<int>{{9, 8, 7}});
  }
  static SimulationOptions options(Arc<double> const& needle) {
    auto const mesh = sheet();
    return block().options(
        {{Needles::name.view(), 1},
         {ContactPoints::name.view(), contacts(needle)},
         {SheetVertices::name.view(), static_cast<std::int64_t>(mesh.positions.size())},
         {SheetTriangles::name.view(), static_cast<std::int64_t>(mesh.triangles.size())},
         {Markers::name.view(), 2},
         {Events::name.view(), 8},
         {Channels::name.view(), 2},
         {ChannelPoints::name.view(), 64}});
  }
  // A step of its way down [cells]; less than 0: up.
  void move(double cells) {
    double const h = 0.25 * gel_time();
    drive_needle(run, 0, vec(0.0, 0.0, -cells * gel_cell / h), {});
    run.step(h);
    depth += cells;
  }
  double lift() const { return run.state().get<needle::Force>(0, 0)[2]; }  // [N]
  double at_tip() const { return run.state().get<needle::TipForce>(0, 0); }
  std::int64_t events() const { return run.state().get<event::Count>(0); }
};

}  // namespace

TEST_CASE("a needle that lies on the tissue and is pressed dents it and does not go in",
          "[stability][B32]") {
  auto const needle = straight_needle(needle_length * gel_cell, 1e-4);
  auto const x = vec(1.0, 0.0, 0.0), z = vec(0.0, 0.0, 1.0);
  Press press(straight_pose(needle, gel_cell * vec(10.1, 7.13, top + 0.3), x, z), needle, 0.05);
  while (press.depth < 0.25) press.move(0.0125);
  CHECK(press.lift() == 0);
  double most = 0;
  while (press.depth < 0.8) {
    press.move(0.0125);
    most = std::max(most, press.lift());
  }
  for (int s = 0; s < 200; ++s) press.move(0);
  double const held = press.lift();
  CAPTURE(most, held, press.run.status(0));
  CHECK(held > 0.1 * most);
  for (int s = 0; s < 200; ++s) press.move(0);
  CHECK(std::abs(press.lift() / held - 1) < 0.02);  // it does not creep in
  while (press.depth > -0.5) press.move(-0.0125);
  CHECK(press.lift() == 0);
  CHECK(press.events() == 0);
  CHECK(press.run.status(0) == 0);
}

namespace {

struct Pushed {
  double most = 0, last = 0;  // force on the tip [N]
  double after = 0;           // and in the step after the event
  // Energy of the gel before the event, and the most that it had beyond that and the hand's work [J].
  double stored = 0, gained = 0;
  double released = 0;  // stored, and the hand's work since, less the gel's energy at the end [J]
  std::int64_t events = 0;
  std::uint32_t status = 0;
};

// The tip goes down by 0.7 cells into the surface and stays for a while.
Pushed push_tip(double puncture_force) {
  auto const needle = straight_needle(needle_length * gel_cell, 1e-4);
  Press press(straight_pose(needle, gel_cell * vec(7.63, 7.13, top + 0.1), vec(0.0, 0.0, -1.0),
                            vec(1.0, 0.0, 0.0)),
              needle, puncture_force);
  Pushed p;
  int steps = 0;    // since the event
  double work = 0;  // of the hand since then [J]
  for (int s = 0; s < 300; ++s) {
    double const down = press.depth < 0.8 ? 0.0125 : 0, energy = gel_energy(press.run, 0);
    press.move(down);
    p.most = std::max(p.most, press.at_tip());
    if (press.events() == 0) continue;
    steps += 1;
    if (steps == 1) p.stored = energy, p.gained = -energy;
    if (steps == 2) p.after = press.at_tip();
    work += press.lift() * down * gel_cell;
    p.released = p.stored + work - gel_energy(press.run, 0);
    p.gained = std::max(p.gained, -p.released);
  }
  p.last = press.at_tip();
  p.events = press.events();
  p.status = press.run.status(0);
  return p;
}

}  // namespace

TEST_CASE("a tip goes in above the force that opens the surface, and not below it",
          "[stability][B32][A4.6]") {
  auto const free = push_tip(1.0);
  CAPTURE(free.most, free.last);
  REQUIRE(free.events == 0);
  REQUIRE(free.most > 0);

  auto const below = push_tip(free.most / 0.98), above = push_tip(free.most / 1.02);
  CAPTURE(below.most, below.last, above.most, above.last);
  CHECK(below.events == 0);
  CHECK_THAT(below.most, WithinRel(free.most, 1e-6));
  CHECK(below.status == 0);
  CHECK(above.events == 1);
  CHECK(above.most <= free.most / 1.02 * (1 + 1e-9));
  CHECK(above.last <= 0.3 * free.most / 1.02 * (1 + 1e-9));  // only cutting is left
  CHECK(above.status == 0);

  // What the event sets free was stored: the gel never has more than it had, and what the hand added. Damping and
  // cutting take the rest. Force drops in one step, of 1/80 of a cell.
  CAPTURE(above.stored, above.gained, above.released, above.after);
  CHECK(above.stored > 0);
  CHECK(above.gained <= 1e-9 * above.stored);
  CHECK(above.released > 0.1 * above.stored);
  CHECK(above.released <= above.stored);
  CHECK_THAT(above.after, WithinRel(0.3 * free.most / 1.02, 1e-6));  // F_cut
}
