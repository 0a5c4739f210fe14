// 3. A curved needle goes through soft tissue: it presses, punctures, cuts its way round, and comes out.
//
// Tissue and needle meet in a coupling. What it needs to know is where the tissue begins - its surface -
// and with which force the tip goes through.
// test: --steps 500
#include "cli.hpp"

#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/effects/viscosity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/io/csv.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/needle/suture_path.hpp>
#include <mpmpbd/scene/simulation.hpp>

using namespace mpmpbd;

struct Tissue : Mpm<NeoHookean> {};
using Floor = Wall<Sticky, 2, Side::low>;
struct NeedleInTissue
    : Scene<Tissue, ArcNeedle, Surface, Coupling<Embedded, Friction>, Viscosity, Floor> {};

struct Settings {
  double young_modulus = 500e3, poisson_ratio = 0.4, density = 1000.0, viscosity = 500.0;
  double radius = 0.32, wire_radius = 0.02, marker_distance = 0.6;
  double puncture_force = 6250.0, cutting_force = 2080.0, friction = 0.2;
  double cell_size = 0.1, step = 0.004, drive_time = 2.0;

  void declare(ConfigKeys& keys) {
    keys(young_modulus, bound::positive("young_modulus_pa", "Pa"), "Young's modulus of the tissue");
    keys(poisson_ratio, {"poisson_ratio", "1", 0.0, 0.5, true, false}, "Poisson's ratio");
    keys(density, bound::positive("density_kg_m3", "kg/m^3"), "density");
    keys(viscosity, bound::not_negative("viscosity_pa_s", "Pa s"), "lets waves die out");
    keys(radius, bound::positive("radius_m", "m"), "radius of the needle's arc, half a circle");
    keys(wire_radius, bound::positive("wire_radius_m", "m"), "radius of its wire");
    keys(marker_distance, bound::positive("marker_distance_m", "m"), "from entry to exit");
    keys(puncture_force, bound::positive("puncture_force_n", "N"), "force that opens the surface");
    keys(cutting_force, bound::not_negative("cutting_force_n", "N"), "force that cuts on");
    keys(friction, bound::not_negative("friction_coefficient", "1"), "Coulomb friction");
    keys(cell_size, bound::positive("cell_size_m", "m"), "size of a grid cell");
    keys(step, bound::positive("step_s", "s"), "length of a step");
    keys(drive_time, bound::positive("drive_time_s", "s"), "time for the whole way");
  }
  void check(ConfigRules& rules) const {
    rules.number("marker_distance_m", marker_distance, {.high = 1.9 * radius},
                 "the needle reaches from marker to marker");
    rules.number("cutting_force_n", cutting_force, {.high = puncture_force},
                 "it is at most the puncture force");
    rules.number("puncture_force_n", puncture_force,
                 {.high = 2.1 * young_modulus * cell_size * cell_size},
                 "with more, the tip sinks in by more than a cell");
  }

  // A block with three cells of room around it, wide enough for the stitch.
  Box<double> block() const {
    Vec3<double> const corner = vec(3 * cell_size, 3 * cell_size, 3 * cell_size);
    return {corner, corner + cell_size * vec(10.0, 5.0, 5.0)};
  }
  Vec3<double> marker(double side) const {
    Box<double> const b = block();
    return vec(0.5 * (b.low[0] + b.high[0] + side * marker_distance), 0.5 * (b.low[1] + b.high[1]),
               b.high[2]);
  }
  Arc<double> arc() const { return {radius, pi<double>, wire_radius, 3 * wire_radius}; }
  SuturePath path() const {
    return SuturePath::between(marker(-1), marker(1), vec(0.0, 0.0, 1.0), radius);
  }
  // The circle through both markers, turned from 0.35 rad before the entry to 0.5 rad past the exit.
  Script script() const {
    auto const p = path();
    return Script::at(p.pose(-0.35)).turn(p.centre, p.axis, 0.35 + p.angle + 0.5, drive_time);
  }
};

using Run = Simulation<NeedleInTissue, Threads>;

Run make(course::Run<Settings> const& run) {
  Settings const& s = run.settings;
  double const dx = s.cell_size, d = dx / 2;  // eight points per cell
  Box<double> const block = s.block();
  std::vector<Vec3<double>> points;
  for (int k = 0; k < 10; ++k)
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < 20; ++i) points.push_back(block.low + d * vec(i + 0.5, j + 0.5, k + 0.5));
  // The surface: a closed sheet of triangles that moves with the tissue.
  auto const sheet = box_sheet(block, Vec3<int>{{10, 5, 5}});
  int const contacts = contact_points(ArcPoints<double>::over(s.arc(), dx));

  Run sim(
      {.cell_size = dx,
       .nodes = {17, 12, 13},
       .capacity = {{"particle", static_cast<std::int64_t>(points.size())},
                    {Needles::name.view(), 1},
                    {ContactPoints::name.view(), contacts},
                    {SheetVertices::name.view(), static_cast<std::int64_t>(sheet.positions.size())},
                    {SheetTriangles::name.view(),
                     static_cast<std::int64_t>(sheet.triangles.size())},
                    {Markers::name.view(), 2},
                    {Events::name.view(), 8},
                    {Channels::name.view(), 2},
                    {ChannelPoints::name.view(), 256}}},
      run.threads);
  auto const k = lame(s.young_modulus, s.poisson_ratio);
  sim.set<NeoHookean>({k.mu, k.lambda});
  sim.set<Viscosity>({s.viscosity});
  sim.set<Floor>({block.low[2]});
  sim.set<Friction>({s.friction, 0.0});
  sim.set<ArcNeedle>(
      {s.radius, pi<double>, s.wire_radius, 3 * s.wire_radius, s.puncture_force, s.cutting_force});
  sim.add_particles(0, points, s.density, d * d * d);

  auto& state = sim.state();
  load_sheet(sheet, state.table<SheetVertices>(), state.table<SheetTriangles>(), 0);
  state.table<Markers>().set_live(0, 2);
  for (std::int64_t m : {0, 1}) {
    auto const at = mark_at(sheet_of(sheet), s.marker(m == 0 ? -1 : 1));
    marker::store(state.view<Markers>(), m,
                  SurfaceMark<float>{at.triangle, cast<float>(at.weights)});
  }
  state.table<ContactPoints>().set_live(0, contacts);
  state.table<Needles>().set_live(0, 1);
  auto const needle = state.view<Needles>();
  kinematic::reset(needle, 0, s.script());
  Tip<float>::at(cast<float>(to_world(s.script().start, s.arc().point(0.0)))).store(needle, 0);
  return sim;
}

bool drive(course::Run<Settings> const& run) {
  Settings const& s = run.settings;
  auto sim = make(run);
  auto const& state = sim.state();
  auto const needle = sim.state().view<Needles>();
  auto const script = s.script();
  io::Csv series(
      run.out / "needle_in_tissue.csv",
      {{"time", "s"}, {"tip height", "m"}, {"tip force", "N"}, {"force", "N"}, {"moment", "N m"}});
  auto progress = run.progress("driving");
  double touch = -1, before_touch = 0, deepest = 0, peak = 0, after = 1e30;
  for (int step = 1; step <= run.steps; ++step) {
    double const t0 = (step - 1) * s.step, t1 = step * s.step;
    kinematic::begin_scripted(needle, 0, script, t0, t1);  // the velocity that the tissue feels
    sim.step(s.step);
    kinematic::finish_scripted(needle, 0, script, t1);  // exactly where the script says

    double const height = double(state.get<tip::Position>(0, 0)[2]) - s.block().high[2];
    double const force = double(norm(state.get<needle::Force>(0, 0)));
    double const at_tip = double(state.get<needle::TipForce>(0, 0));
    series.row({t1, height, at_tip, force, double(norm(state.get<needle::Moment>(0, 0)))});
    if (touch < 0 && height > 0) before_touch = std::max(before_touch, force);
    if (touch < 0 && height <= 0) touch = t1;
    auto const punctures = state.get<event::Count>(0);
    if (punctures == 0) deepest = std::max(deepest, -height);
    if (punctures == 1) after = std::min(after, at_tip);
    peak = std::max(peak, force);
    progress.update(step);
  }
  series.close();

  bool good =
      course::check(sim.status(0) == 0, fmt::format("no fault (status {:#x})", sim.status(0)));
  good &= course::check(before_touch == 0, "no force before the tip touches");
  for (std::int64_t i = 0; i < state.get<event::Count>(0); ++i) {
    bool const in = state.get<event::Kind>(0, i) == std::int64_t(EventKind::entry);
    double const force = double(state.get<event::Force>(0, i)),
                 miss = double(state.get<event::Miss>(0, i));
    fmt::print("        {} at {:.3f} s, {:.0f} N on the tip, {:.0f} mm beside its marker\n",
               in ? "in " : "out", double(state.get<event::Time>(0, i)), force, 1e3 * miss);
    if (in) {
      good &=
          course::check(force > 0.99 * s.puncture_force, "the surface opens at the puncture force");
      good &= course::check(
          deepest < s.cell_size,
          fmt::format("dimple before that: {:.0f} mm, less than a cell", 1e3 * deepest));
      good &= course::check(after < 0.5 * s.puncture_force,
                            fmt::format("then the force on the tip falls to {:.0f} N", after));
    }
  }
  fmt::print("        largest force {:.0f} N\n", peak);
  if (run.steps * s.step >= s.drive_time)
    good &= course::check(state.get<event::Count>(0) == 2, "once in, once out");
  return good;
}

int main(int argc, char** argv) {
  return course::run<NeedleInTissue, Settings>(
      argc, argv, "A curved needle goes through soft tissue.", 500, drive);
}
