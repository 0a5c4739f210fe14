// 1. A soft block falls, hits the floor, and bounces.
//
// The smallest scene: one body, two effects. Everything else of the library works the same way - name
// the parts, give them numbers, step.
// test: --steps 300
#include "cli.hpp"

#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/io/csv.hpp>
#include <mpmpbd/io/ply.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>

using namespace mpmpbd;

// A scene is a type: it says what there is and what acts on it. No member, array or instruction is
// made for anything that is not named here; run with --plan to see what is.
struct Block : Mpm<NeoHookean> {};
using Floor = Wall<Separating, 2, Side::low>;
struct FallingBlock : Scene<Block, Gravity, Floor> {};

// The numbers of a run, as they stand in a settings file; try --print-config.
struct Settings {
  double young_modulus = 50e3, poisson_ratio = 0.3, density = 1000.0;
  double edge = 0.2, height = 0.1, cell_size = 0.02, step = 0.002, gravity = 9.81;

  void declare(ConfigKeys& keys) {
    keys(young_modulus, bound::positive("young_modulus_pa", "Pa"), "Young's modulus");
    keys(poisson_ratio, {"poisson_ratio", "1", 0.0, 0.5, true, false}, "Poisson's ratio");
    keys(density, bound::positive("density_kg_m3", "kg/m^3"), "density");
    keys(edge, bound::positive("edge_m", "m"), "edge of the block");
    keys(height, bound::between("height_m", "m", 0.0, 10.0), "how far above the floor it starts");
    keys(cell_size, bound::positive("cell_size_m", "m"), "size of a grid cell");
    keys(step, bound::positive("step_s", "s"), "length of a step");
    keys(gravity, bound::positive("gravity_m_s2", "m/s^2"), "gravity, downwards");
  }
  void check(ConfigRules& rules) const {
    rules.number("cell_size_m", cell_size, {.low = edge / 50, .high = edge / 2},
                 "the block is 2 to 50 cells wide");
  }
  double floor() const { return 2 * cell_size; }  // the grid needs two cells below it
};

// What we watch.
struct Observed {
  double lowest, centre, speed;     // height above the floor [m], mean vertical velocity [m/s]
  double kinetic, elastic, weight;  // energies [J]
  double energy() const { return kinetic + elastic + weight; }
};

template <class Simulation> Observed observe(Simulation const& sim, Settings const& s) {
  auto const& state = sim.state();
  auto const material = state.template parameters<NeoHookean>(0);
  auto const count = state.template table<Particles>().live(0);
  Observed o{1e30, 0, 0, 0, 0, 0};
  for (std::int64_t i = 0; i < count; ++i) {
    Vec3<double> const x = cast<double>(state.template get<particle::Position>(0, i));
    Vec3<double> const v = cast<double>(state.template get<particle::Velocity>(0, i));
    double const mass = double(state.template get<particle::Mass>(0, i));
    double const z = x[2] - s.floor();
    // A policy works on the fields that it declares, wherever they come from.
    Local<float, Fields<particle::Deformation>> p;
    p[particle::Deformation{}] = state.template get<particle::Deformation>(0, i);
    o.elastic += double(NeoHookean::energy(p, material)) *
                 double(state.template get<particle::Volume>(0, i));
    o.kinetic += 0.5 * mass * dot(v, v);
    o.weight += mass * s.gravity * z;
    o.lowest = std::min(o.lowest, z);
    o.centre += z / double(count);
    o.speed += v[2] / double(count);
  }
  return o;
}

// Eight material points per cell, centred over the floor.
std::vector<Vec3<double>> points_of(Settings const& s, int per_edge) {
  std::vector<Vec3<double>> points;
  double const d = s.edge / per_edge;
  Vec3<double> const corner = vec(s.edge, s.edge, s.floor() + s.height);
  for (int k = 0; k < per_edge; ++k)
    for (int j = 0; j < per_edge; ++j)
      for (int i = 0; i < per_edge; ++i)
        points.push_back(corner + d * vec(i + 0.5, j + 0.5, k + 0.5));
  return points;
}

bool fall(course::Run<Settings> const& run) {
  Settings const& s = run.settings;
  auto const per_edge = static_cast<int>(std::lround(2 * s.edge / s.cell_size));
  auto const points = points_of(s, per_edge);
  auto const cells = [&](double length) { return static_cast<int>(length / s.cell_size) + 4; };

  // The domain reaches from (0, 0, 0) to (nodes - 1) cells; capacity says how many points it can hold.
  Simulation<FallingBlock, Threads> sim(
      {.cell_size = s.cell_size,
       .nodes = {cells(3 * s.edge), cells(3 * s.edge), cells(s.floor() + s.height + 2 * s.edge)},
       .capacity = {{"particle", static_cast<std::int64_t>(points.size())}}},
      run.threads);
  auto const k = lame(s.young_modulus, s.poisson_ratio);
  sim.set<NeoHookean>({k.mu, k.lambda});
  sim.set<Gravity>({{0.0, 0.0, -s.gravity}});
  sim.set<Floor>({s.floor()});
  sim.add_particles(0, points, s.density, s.edge * s.edge * s.edge / double(points.size()));
  fmt::print("{} material points, stable substep {:.3g} s\n", points.size(), sim.suggest_dt(0));

  io::Csv series(run.out / "falling_block.csv", {{"time", "s"},
                                                 {"lowest point", "m"},
                                                 {"centre", "m"},
                                                 {"velocity", "m/s"},
                                                 {"energy", "J"}});
  auto progress = run.progress("falling");
  Observed const start = observe(sim, s);
  double fall_error = 0, most_energy = 0, deepest = start.lowest, rebound = 0;
  for (int step = 1; step <= run.steps; ++step) {
    sim.step(s.step);  // as many substeps as stability asks for
    double const t = step * s.step;
    Observed const now = observe(sim, s);
    series.row({t, now.lowest, now.centre, now.speed, now.energy()});
    bool const falls =
        deepest > 2 * s.cell_size;  // the floor is felt from less than two cells above
    if (falls)
      fall_error =
          std::max(fall_error, std::abs(start.centre - now.centre - 0.5 * s.gravity * t * t) /
                                   (s.gravity * t * s.step));
    deepest = std::min(deepest, now.lowest);
    most_energy = std::max(most_energy, now.energy());
    rebound = std::max(rebound, now.speed);
    progress.update(step);
  }
  series.close();
  std::vector<Vec3<float>> last;
  for (std::size_t i = 0; i < points.size(); ++i)
    last.push_back(sim.state().get<particle::Position>(0, static_cast<std::int64_t>(i)));
  io::write_ply<float>(run.out / "falling_block.ply", last);

  double const impact_time = std::sqrt(2 * s.height / s.gravity);
  bool good = course::check(sim.status(0) == 0, "no fault");
  good &= course::check(fall_error < 1.0,
                        "free fall: the centre follows g t^2/2 to first order in the step");
  good &= course::check(
      most_energy < 1.01 * start.energy(),
      fmt::format("energy: {:.4g} J at the start, at most {:.4g} J", start.energy(), most_energy));
  good &= course::check(deepest > -0.5 * s.cell_size,
                        fmt::format("floor: the lowest point came to {:.2g} mm", 1e3 * deepest));
  if (run.steps * s.step > impact_time + 0.2)
    good &= course::check(rebound > 0.2 * s.gravity * impact_time,
                          fmt::format("bounce: hit at {:.3g} m/s, sprang up at {:.3g} m/s",
                                      s.gravity * impact_time, rebound));
  return good;
}

int main(int argc, char** argv) {
  return course::run<FallingBlock, Settings>(
      argc, argv, "A soft block falls, hits the floor, and bounces.", 300, fall);
}
