// What accuracy costs: error against wall time, for every transfer, shape function and force form on a smooth problem
// (the generalised vortex, A2.3) and an impact (colliding discs, A2.7), and for every solver on a chain (A3.4).
//
// The physics is fixed, the numerics vary. On the vortex each policy runs at its own best legal step, 0.8 of its
// stable limit, and at one step for all, 0.1 dx / c.
// Usage: bench_work_precision OUT.csv [REPEATS]; the fastest of REPEATS runs of each point counts.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>

#include <fmt/core.h>

#include <mpmpbd/io/file.hpp>
#include <mpmpbd/mpm/transfer/pic.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>

#include "pbd/rig.hpp"
#include "physics/colliding_discs.hpp"
#include "physics/vortex.hpp"

namespace {

using namespace test;

struct Point {
  double error;
  bool good;  // no fault on the way
};

class Results {
 public:
  explicit Results(int repeats) : repeats_(repeats) {}

  template <class Make>
  void add(std::string const& problem, std::string const& policy, std::string const& rule,
           int resolution, int steps, Make const& make) {
    double fastest = 1e300;
    Point p{};
    for (int n = 0; n < repeats_; ++n) {
      auto const began = std::chrono::steady_clock::now();
      p = make();
      std::chrono::duration<double> const took = std::chrono::steady_clock::now() - began;
      fastest = std::min(fastest, took.count());
    }
    auto const line = fmt::format("{},\"{}\",{},{},{},{:.6g},{:.6g},{}\n", problem, policy, rule,
                                  resolution, steps, p.error, fastest, p.good ? 1 : 0);
    fmt::print("{}", line);
    text_ += line;
  }
  std::string const& text() const { return text_; }

 private:
  int repeats_;
  std::string text_ = "problem,policy,step,resolution,steps,error [1],time [s],good\n";
};

template <class Body> std::string name_of() {
  return std::string(Body::Shape::name.view()) + " " + std::string(Body::Transfer::name.view()) +
         " " + std::string(Body::Form::name.view());
}

template <class Body> void vortex_points(Results& table) {
  Vortex const motion{0.1};
  auto const& k = motion.material;
  double const c = motion.wave_speed();
  for (int n : {8, 16, 32}) {
    double const dx = 1.0 / n;
    StepBounds<double> const rest{.frequency2 = (3 * k.lambda + 2 * k.mu) / motion.density};
    double const best = 0.8 * elastic_limit<Body>(rest, dx) * c / dx;
    for (auto const& [rule, cfl] :
         {std::pair{"0.8 of the limit", best}, std::pair{"0.1 dx/c", 0.1}}) {
      VortexCase const what{n, cfl, motion.amplitude};
      int steps = 0;
      vortex<Body>(what, steps);
      table.add("vortex", name_of<Body>(), rule, n, steps, [&] {
        int taken = 0;
        auto run = vortex<Body>(what, taken);
        run.advance(taken);
        return Point{run.error(in_ring) / motion.amplitude, run.status() == 0};
      });
    }
  }
}

// Error: the share of the kinetic energy that is lost; elastic discs keep all but what rings on in them.
template <class Body> void disc_points(Results& table) {
  for (int n : {10, 20, 40})
    table.add("discs", name_of<Body>(), "1 ms", n, 3500, [&] {
      auto const o = Discs<Body>(n).collide();
      return Point{1.0 - o.kinetic, o.status == 0 && o.most <= 1.001};
    });
}

template <class... Policies> using Quadratic = Mpm<NeoHookean, QuadraticBSpline, Policies...>;
template <class... Policies> using Cubic = Mpm<NeoHookean, CubicBSpline, Policies...>;

template <class... Bodies> struct List {};
using Compared =
    List<Quadratic<Pic, WeightGradient>, Quadratic<Flip, WeightGradient>,
         Quadratic<Apic, WeightGradient>, Quadratic<Tpic, WeightGradient>, Quadratic<Apic, Mls>,
         Cubic<Flip, WeightGradient>, Cubic<Apic, WeightGradient>, Cubic<Apic, Mls>>;
template <class... Bodies> void mpm_points(Results& table, List<Bodies...>) {
  (vortex_points<Bodies>(table), ...);
  (disc_points<Bodies>(table), ...);
}

// A3.4: 50 inextensible links from horizontal, 2 s of frames of 1/60 s. Error: the largest stretch.
template <class Solver>
void chain_points(Results& table, std::string const& policy, std::initializer_list<int> substeps) {
  struct Body : Pbd<Constraints<Distance>, Solver> {};
  for (int const n : substeps)
    table.add("chain", policy, "1/60 s / substeps", n, 120 * n, [&] {
      double const length = 1.0;
      rods::Rig<Body> rig(rods::chain<Body>(
          rods::straight({{0.3, 0.2, 0.1}}, {{0.3 + length, 0.2, 0.1}}, 51), 0.02, 0.0));
      double worst = 0;
      for (int s = 0; s < 120 * n; ++s) {
        rig.step(1.0 / 60 / n);
        worst = std::max(worst, std::abs(rig.length() / length - 1));
      }
      return Point{worst, rig.finite() && rig.faults == 0};
    });
}
void rod_points(Results& table) {
  chain_points<Xpbd<1>>(table, "Gauss-Seidel, 1 iteration", {5, 10, 20, 40, 80, 160});
  chain_points<Xpbd<20>>(table, "Gauss-Seidel, 20 iterations", {1, 2, 4, 8});
  chain_points<Xpbd<80>>(table, "Gauss-Seidel, 80 iterations", {1, 2, 4});
  chain_points<Jacobi<20>>(table, "Jacobi, 20 iterations", {1, 2, 4, 8});
  chain_points<DirectBanded<1>>(table, "direct, 1 elimination", {5, 10, 20, 40, 80});
  chain_points<DirectBanded<2>>(table, "direct, 2 eliminations", {1, 2, 4, 10, 20});
  chain_points<DirectBanded<4>>(table, "direct, 4 eliminations", {1, 2, 4, 10});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: bench_work_precision OUT.csv [REPEATS]\n");
    return 2;
  }
  Results table(argc > 2 ? std::max(1, std::atoi(argv[2])) : 3);
  rod_points(table);
  mpm_points(table, Compared{});
  mpmpbd::io::write_file(argv[1], table.text());
  return 0;
}
