// 2. Threads that hang: one between two nails takes the shape of a catenary, one from a single nail
// swings with the period that Laguerre's polynomials tell.
//
// A scene without tissue, and two environments of it: environments share code and settings of the
// scene, never state, so one run can hold two different experiments.
// test: --steps 2000
#include "cli.hpp"

#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/io/csv.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/pbd/solvers/direct_banded.hpp>
#include <mpmpbd/scene/simulation.hpp>

using namespace mpmpbd;

// Beads at fixed distances, all constraints solved at once. Write Constraints<Distance, Bend> for a
// thread that resists bending, or Xpbd<8> for the classical sweep over the constraints.
struct Thread : Pbd<Constraints<Distance>, DirectBanded<>> {};
struct HangingThread : Scene<Thread, Gravity, Damping> {};

struct Settings {
  double length = 1.0, span = 0.6;
  int segments = 40;
  double radius = 0.000115, young_modulus = 2e9, density = 1140.0;  // a 3-0 nylon thread
  double gravity = 9.81, step = 0.002, settling = 3.0;

  RodMaterial material() const { return {young_modulus, radius, density}; }

  void declare(ConfigKeys& keys) {
    keys(length, bound::positive("length_m", "m"), "length of a thread");
    keys(span, bound::positive("span_m", "m"), "distance of the two nails");
    keys(segments, bound::between("segments", "1", 2, 1000), "segments of a thread");
    keys(radius, bound::positive("radius_m", "m"), "radius of a thread");
    keys(young_modulus, bound::positive("young_modulus_pa", "Pa"), "Young's modulus");
    keys(density, bound::positive("density_kg_m3", "kg/m^3"), "density");
    keys(gravity, bound::positive("gravity_m_s2", "m/s^2"), "gravity, downwards");
    keys(step, bound::positive("step_s", "s"), "length of a step");
    keys(settling, bound::positive("settling_1_s", "1/s"), "damping of the thread on two nails");
  }
  void check(ConfigRules& rules) const {
    rules.number("span_m", span, {0.1 * length, 0.95 * length},
                 "the thread reaches from nail to nail and hangs through");
  }
};

using Assembly = RodAssembly<Thread>;
constexpr std::int64_t two_nails = 0, one_nail = 1;  // the environments

// How far a thread of given length sags between nails at equal height: y = a cosh(x/a) with
// 2 a sinh(span/2a) = length, found by bisection.
double catenary_sag(double length, double span) {
  double low = span / 100, high = 1e3 * length;
  for (int i = 0; i < 200; ++i) {
    double const a = 0.5 * (low + high);
    (2 * a * std::sinh(span / (2 * a)) > length ? low : high) = a;
  }
  return low * (std::cosh(span / (2 * low)) - 1);
}

// Laguerre polynomials L_0...L_n at x: (j + 1) L_{j+1} = (2 j + 1 - x) L_j - j L_{j-1}.
std::vector<double> laguerre(int n, double x) {
  std::vector<double> l{1.0, 1.0 - x};
  for (int j = 1; j < n; ++j)
    l.push_back(((2 * j + 1 - x) * l[static_cast<std::size_t>(j)] -
                 j * l[static_cast<std::size_t>(j) - 1]) /
                (j + 1));
  return l;
}
// n equal beads l apart swing in their slowest mode with omega^2 = x g/l, x the first zero of L_n; the
// bead j above the lowest moves by L_j(x).
double first_zero(int n) {
  double low = 0, high = 1.6 / n;  // the zero is near 1.446/n
  for (int i = 0; i < 100; ++i) {
    double const x = 0.5 * (low + high);
    (laguerre(n, x).back() > 0 ? low : high) = x;
  }
  return low;
}

// A taut V between the nails at height 0; it will fall into its shape.
Assembly between_two_nails(Settings const& s) {
  Assembly rod;
  double const drop = std::sqrt(square(s.length / 2) - square(s.span / 2));
  std::vector<Vec3<double>> const line{vec(0.0, 0.0, 0.0), vec(s.span / 2, 0.0, -drop),
                                       vec(s.span, 0.0, 0.0)};
  auto const thread = add_thread<Thread>(rod, line, s.segments + 1, s.material());
  rod.prescribe(thread.first);
  rod.prescribe(thread.last - 1);
  return rod;
}

// Hanging from bead 0, displaced sideways by a hundredth of its length in its slowest mode.
Assembly from_one_nail(Settings const& s, double zero) {
  int const n = s.segments;
  auto const mode = laguerre(n, zero);
  double const l = s.length / n;
  std::vector<Vec3<double>> points;
  for (int i = 0; i <= n; ++i) {
    double const x = i == 0 ? 0.0 : 0.01 * s.length * mode[static_cast<std::size_t>(n - i)];
    double const dx = i == 0 ? 0.0 : x - points.back()[0];
    points.push_back(i == 0 ? Vec3<double>{}
                            : vec(x, 0.0, points.back()[2] - std::sqrt(l * l - dx * dx)));
  }
  Assembly rod;
  auto const thread = add_thread<Thread>(rod, points, s.material());
  rod.prescribe(thread.first);
  rod.set_mass(thread.last - 1, s.material().line_density() * l);  // all beads equal, also the last
  return rod;
}

bool hang(course::Run<Settings> const& run) {
  Settings const& s = run.settings;
  double const zero = first_zero(s.segments);
  Assembly const catenary = between_two_nails(s), pendulum = from_one_nail(s, zero);

  Simulation<HangingThread, Threads, double> sim(
      {.environments = 2, .capacity = catenary.capacity()}, run.threads);
  sim.set<Gravity>({{0.0, 0.0, -s.gravity}});
  sim.set<Damping>(two_nails, {s.settling});
  sim.set<Damping>(one_nail, {0.0});
  catenary.write(sim.state(), two_nails);
  pendulum.write(sim.state(), one_nail);

  // The swing is timed at the free end: half a period lies between two passes through the middle.
  std::int64_t const end = s.segments, middle = s.segments / 2;
  auto const place = [&](std::int64_t env, std::int64_t bead) {
    return sim.state().get<bead::Position>(env, bead);
  };
  io::Csv series(run.out / "hanging_thread.csv",
                 {{"time", "s"}, {"sag", "m"}, {"end of the pendulum", "m"}});
  auto progress = run.progress("hanging");
  std::vector<double> passes;
  double before = place(one_nail, end)[0];
  for (int step = 1; step <= run.steps; ++step) {
    sim.step(s.step);
    double const t = step * s.step, now = place(one_nail, end)[0];
    if (before * now < 0) passes.push_back(t - s.step * now / (now - before));
    before = now;
    series.row({t, -place(two_nails, middle)[2], now});
    progress.update(step);
  }
  series.close();

  bool good = course::check(sim.status(two_nails) == 0 && sim.status(one_nail) == 0, "no fault");
  if (passes.size() >= 2) {
    double const period = 2 * (passes[1] - passes[0]);
    double const exact = 2 * pi<double> / std::sqrt(zero * s.gravity * s.segments / s.length);
    good &= course::check(
        std::abs(period / exact - 1) < 0.002,
        fmt::format("one nail: period {:.4f} s, by Laguerre {:.4f} s", period, exact));
  }
  if (run.steps * s.step * s.settling >= 12) {  // by then it has come to rest
    double const sag = -place(two_nails, middle)[2], exact = catenary_sag(s.length, s.span);
    good &= course::check(
        std::abs(sag / exact - 1) < 0.005,
        fmt::format("two nails: sag {:.2f} mm, of the catenary {:.2f} mm", 1e3 * sag, 1e3 * exact));
  }
  return good;
}

int main(int argc, char** argv) {
  return course::run<HangingThread, Settings, double>(
      argc, argv, "A thread on two nails and a thread on one.", 2000, hang);
}
