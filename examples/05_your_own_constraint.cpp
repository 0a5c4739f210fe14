// 5. A constraint of your own: a ring that slides on a straight rail, with a thread hanging from it.
//
// A constraint says what it acts on, what has to vanish, and how that changes; everything else - masses,
// multipliers, time steps, colours, the fused kernel on a GPU - is the solver's business. This file is
// all that it takes.
// test: --steps 300
#include "cli.hpp"

#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/io/csv.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/testing/constraint_laws.hpp>

using namespace mpmpbd;

// C = the two components of x - p across the rail [m]; free along it.
struct Rail {
  using Role = role::Constraint;
  static constexpr FixedString name = "Rail";
  using Unknowns = TypeList<unknown::Point>;
  static constexpr int dimension = 2;
  static constexpr ConstraintKind kind = ConstraintKind::equality;

  template <class T> struct Parameters {
    T px, py, pz;  // a point of the rail [m]
    T slope;       // of the rail, downwards along x [rad]
    T compliance;  // [m/N], 0: rigid
  };
  static constexpr std::array<ParameterInfo, 5> parameter_info{
      {bound::any("px", "m"), bound::any("py", "m"), bound::any("pz", "m"),
       bound::between("slope", "rad", -1.5, 1.5), bound::not_negative("compliance", "m/N")}};

  // Runs on the CPU and in kernels, in float and double: no library inside, only our own functions.
  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k) {
    using T = typename X::Scalar;
    Vec3<T> const side = vec(T(0), T(1), T(0));
    Vec3<T> const above = vec(sin(k.slope), T(0), cos(k.slope));
    Vec3<T> const d = get<0>(x) - vec(k.px, k.py, k.pz);
    Evaluation<Rail, T> e;
    e.value[0] = dot(side, d);
    e.value[1] = dot(above, d);
    for (int a = 0; a < 3; ++a) {  // a row per number, a column per coordinate
      gradient<0>(e)(0, a) = side[a];
      gradient<0>(e)(1, a) = above[a];
    }
    return e;
  }
  template <class T> MPMPBD_HD static T compliance(Parameters<T> const& k) { return k.compliance; }
};

// It stands beside the library's own.
struct Thread : Pbd<Constraints<Distance, Rail>, Xpbd<40>> {};
struct SlidingThread : Scene<Thread, Gravity> {};

struct Settings {
  double slope_deg = 30.0, length = 0.5, gravity = 9.81, step = 0.002;
  int segments = 10;
  double radius = 0.000115, young_modulus = 2e9, density = 1140.0;

  double slope() const { return slope_deg * pi<double> / 180.0; }
  RodMaterial material() const { return {young_modulus, radius, density}; }

  void declare(ConfigKeys& keys) {
    keys(slope_deg, bound::between("slope_deg", "deg", 0.0, 85.0), "slope of the rail");
    keys(length, bound::positive("length_m", "m"), "length of the thread");
    keys(gravity, bound::positive("gravity_m_s2", "m/s^2"), "gravity, downwards");
    keys(step, bound::positive("step_s", "s"), "length of a step");
    keys(segments, bound::between("segments", "1", 2, 1000), "segments of the thread");
    keys(radius, bound::positive("radius_m", "m"), "radius of the thread");
    keys(young_modulus, bound::positive("young_modulus_pa", "Pa"), "Young's modulus");
    keys(density, bound::positive("density_kg_m3", "kg/m^3"), "density");
  }
};

// Where a thread that hangs across the rail slides, it stays across: all of it accelerates with
// g sin(slope), so the distance is g sin(slope) t^2/2, and the thread pulls with its weight times cos(slope).
bool slide(course::Run<Settings> const& run) {
  Settings const& s = run.settings;
  Vec3<double> const along = vec(std::cos(s.slope()), 0.0, -std::sin(s.slope()));
  Vec3<double> const down =
      vec(-std::sin(s.slope()), 0.0, -std::cos(s.slope()));  // across the rail
  std::vector<Vec3<double>> const line{vec(0.0, 0.0, 0.0), s.length * down};

  RodAssembly<Thread> rod;
  auto const thread =
      add_thread(rod, std::span<Vec3<double> const>(line), s.segments + 1, s.material());
  rod.add<Rail>({thread.first}, {0.0, 0.0, 0.0, s.slope(), 0.0});

  Simulation<SlidingThread, Threads, double> sim({.capacity = rod.capacity()}, run.threads);
  rod.write(sim.state(), 0);
  sim.set<Gravity>({{0.0, 0.0, -s.gravity}});

  io::Csv series(run.out / "your_own_constraint.csv",
                 {{"time", "s"}, {"ring along the rail", "m"}, {"ring off the rail", "m"}});
  auto progress = run.progress("sliding");
  double off_rail = 0, behind = 0;
  auto const acceleration = s.gravity * std::sin(s.slope());
  for (int step = 1; step <= run.steps; ++step) {
    sim.step(s.step);
    auto const ring = sim.state().get<bead::Position>(0, thread.first);
    auto const end = sim.state().get<bead::Position>(0, thread.last - 1);
    double const travelled = dot(ring, along);
    off_rail = std::max(off_rail, norm(ring - travelled * along));
    // Symplectic Euler, n steps of h: a h^2 n (n + 1)/2.
    double const exact = acceleration * s.step * s.step * step * (step + 1.0) / 2;
    behind = std::max({behind, std::abs(travelled - exact), std::abs(dot(end, along) - exact)});
    series.row({step * s.step, travelled, norm(ring - travelled * along)});
    progress.update(step);
  }
  series.close();

  // The same suite that the library's own constraints pass: gradients, units, finite at any point.
  bool good = true;
  for (auto const& law : constraint_laws<Rail, double>({0.0, 0.0, 0.0, s.slope(), 1e-3}, s.length))
    good &= course::check(law.holds(), "Rail, " + law.text());

  good &= course::check(sim.status(0) == 0, "no fault");
  good &= course::check(off_rail < 1e-6 * s.length,
                        fmt::format("the ring is off the rail by {:.1e} m at most", off_rail));
  good &=
      course::check(behind < 1e-6 * s.length,
                    fmt::format("ring and end slide as g sin(slope) says, to {:.1e} m", behind));
  return good;
}

int main(int argc, char** argv) {
  return course::run<SlidingThread, Settings, double>(
      argc, argv, "A constraint of your own: a thread on a rail.", 300, slide);
}
