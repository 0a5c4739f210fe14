// 6. Many environments: the same scene with different tissue, side by side in one simulation.
//
// N environments equal N separate runs, bit for bit - whatever N is, and however many threads share
// the work. Learning from thousands of parallel scenes rests on this, and so does looking for the one
// that went wrong: it can be run again alone.
// test: --steps 20
#include <cstring>

#include "cli.hpp"

#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/io/csv.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>

using namespace mpmpbd;

struct Jelly : Mpm<NeoHookean> {};
using Floor = Wall<Sticky, 2, Side::low>;
struct JellyOnFloor : Scene<Jelly, Gravity, Floor> {};

struct Settings {
  int environments = 8, points_per_edge = 12;
  double softest = 5e3, stiffest = 100e3, poisson_ratio = 0.4, density = 1000.0;
  double edge = 0.1, step = 0.002, gravity = 9.81;

  void declare(ConfigKeys& keys) {
    keys(environments, bound::between("environments", "1", 1, 100000), "environments side by side");
    keys(points_per_edge, bound::between("points_per_edge", "1", 4, 200),
         "material points along an edge");
    keys(softest, bound::positive("softest_pa", "Pa"), "lowest Young's modulus");
    keys(stiffest, bound::positive("stiffest_pa", "Pa"), "highest Young's modulus");
    keys(poisson_ratio, {"poisson_ratio", "1", 0.0, 0.5, true, false}, "Poisson's ratio");
    keys(density, bound::positive("density_kg_m3", "kg/m^3"), "density");
    keys(edge, bound::positive("edge_m", "m"), "edge of a block");
    keys(step, bound::positive("step_s", "s"), "length of a step");
    keys(gravity, bound::any("gravity_m_s2", "m/s^2"), "gravity, downwards");
  }
  void check(ConfigRules& rules) const {
    rules.number("stiffest_pa", stiffest, {.low = softest}, "it is at least softest_pa");
  }
  double cell_size() const { return 2 * edge / points_per_edge; }  // eight points per cell
};

// A number in [0, 1) that depends on nothing but the seed and the environment's number (SplitMix64).
double random_number(std::int64_t seed, std::int64_t env) {
  std::uint64_t z =
      static_cast<std::uint64_t>(seed) + 0x9e3779b97f4a7c15u * static_cast<std::uint64_t>(env + 1);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return double((z ^ (z >> 31)) >> 11) * 0x1p-53;
}
double young_modulus(course::Run<Settings> const& run, std::int64_t env) {
  Settings const& s = run.settings;
  return s.softest * std::pow(s.stiffest / s.softest, random_number(run.seed, env));
}

using Blocks = Simulation<JellyOnFloor, Threads>;

// A simulation of environments first...first + count - 1 of the whole set.
Blocks make(course::Run<Settings> const& run, std::int64_t first, std::int64_t count) {
  Settings const& s = run.settings;
  int const n = s.points_per_edge;
  double const d = s.edge / n, dx = s.cell_size(), floor = 2 * dx;
  std::vector<Vec3<double>> points;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        points.push_back(vec(4 * dx, 4 * dx, floor) + d * vec(i + 0.5, j + 0.5, k + 0.5));

  int const wide = n / 2 + 9, high = n / 2 + 6;
  Blocks sim({.environments = count,
              .cell_size = dx,
              .nodes = {wide, wide, high},
              .capacity = {{"particle", static_cast<std::int64_t>(points.size())}}},
             run.threads);
  sim.set<Gravity>({{0.0, 0.0, -s.gravity}});
  sim.set<Floor>({floor});
  for (std::int64_t e = 0; e < count; ++e) {
    auto const k = lame(young_modulus(run, first + e), s.poisson_ratio);
    sim.set<NeoHookean>(e, {k.mu, k.lambda});  // this environment only
    sim.add_particles(e, points, s.density, d * d * d);
  }
  return sim;
}

// Whether environment `a` of one simulation and `b` of another hold the same bits.
bool same_bits(Blocks const& x, std::int64_t a, Blocks const& y, std::int64_t b) {
  bool same = true;
  for_each_field(Blocks::Store::List{}, [&]<class F>(F) {
    using Domain = typename F::Domain;
    auto const& p = x.state().table<Domain>();
    auto const& q = y.state().table<Domain>();
    std::int64_t const items = p.live(a);
    same = same && q.live(b) == items;
    for (int c = 0; c < F::components && same; ++c) {
      auto const* u = p.template planes<F>().data() + (c * p.environments() + a) * p.capacity();
      auto const* v = q.template planes<F>().data() + (c * q.environments() + b) * q.capacity();
      same = std::memcmp(u, v, static_cast<std::size_t>(items) * sizeof *u) == 0;
    }
  });
  return same;
}

double top_of(Blocks const& sim, std::int64_t env) {
  double top = 0;
  for (std::int64_t i = 0; i < sim.state().table<Particles>().live(env); ++i)
    top = std::max(top, double(sim.state().get<particle::Position>(env, i)[2]));
  return top;
}

bool compare(course::Run<Settings> const& run) {
  Settings const& s = run.settings;
  auto together = make(run, 0, s.environments);
  std::vector<double> start;
  for (std::int64_t e = 0; e < s.environments; ++e) start.push_back(top_of(together, e));

  auto progress = run.progress("together");
  double const began = io::monotonic_seconds();
  for (int step = 1; step <= run.steps; ++step) {
    together.step(s.step);
    progress.update(step);
  }
  double const seconds = io::monotonic_seconds() - began;

  io::Csv table(run.out / "many_environments.csv", {{"environment", "1"},
                                                    {"Young's modulus", "Pa"},
                                                    {"substeps", "1"},
                                                    {"sag", "m"},
                                                    {"same as alone", "1"}});
  double updates = 0;
  bool all_same = true, no_fault = true;
  fmt::print("environment   E [kPa]  substeps  sag [mm]  same bits as alone\n");
  for (std::int64_t e = 0; e < s.environments; ++e) {
    auto alone = make(run, e, 1);
    for (int step = 0; step < run.steps; ++step) alone.step(s.step);
    bool const same = same_bits(together, e, alone, 0);
    auto const substeps = together.state().get<environment::Step>(e);
    double const sag = start[static_cast<std::size_t>(e)] - top_of(together, e);
    fmt::print("{:11} {:9.2f} {:9} {:9.3f}  {}\n", e, 1e-3 * young_modulus(run, e), substeps,
               1e3 * sag, same ? "yes" : "NO");
    table.row({double(e), young_modulus(run, e), double(substeps), sag, same ? 1.0 : 0.0});
    updates += double(substeps) * double(together.state().table<Particles>().live(e));
    all_same = all_same && same;
    no_fault = no_fault && together.status(e) == 0;
  }
  table.close();
  fmt::print("{:.3g} particle-substeps/s in {} environments on {} threads\n", updates / seconds,
             s.environments, run.threads.lanes());

  bool good = course::check(no_fault, "no fault");
  good &= course::check(all_same, "every environment is the run alone, bit for bit");
  return good;
}

int main(int argc, char** argv) {
  return course::run<JellyOnFloor, Settings>(
      argc, argv, "The same scene with different tissue, side by side.", 60, compare);
}
