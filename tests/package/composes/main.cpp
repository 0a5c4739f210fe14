// A thread is dropped beside a block of tissue, and a constraint of our own catches it.
#include "leash.hpp"

#include <fmt/core.h>

#include <Eigen/Core>
#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/plan.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/testing/constraint_laws.hpp>
#include <mpmpbd/version.hpp>

namespace hospital {
using namespace mpmpbd;

struct Jelly : Mpm<NeoHookean> {};
struct Strand : Pbd<Constraints<Distance, Leash>> {};
struct Ward : Scene<Jelly, Strand, Coupling<Embedded, Friction>, Gravity> {};

bool check(bool holds, std::string const& what) {
  fmt::print("{} {}\n", holds ? "ok  " : "FAIL", what);
  return holds;
}

bool laws_hold() {
  bool good = true;
  for (auto const& law : constraint_laws<Leash, double>({0.1, 0.2, 0.3, 0.05, 1e-4}, 0.05))
    good &= check(law.holds(), law.text());
  return good;
}

std::vector<Vec3<double>> cube(Vec3<double> const& corner, double spacing, int n) {
  std::vector<Vec3<double>> points;
  for (int i = 0; i < n * n * n; ++i)
    points.push_back(corner + spacing * vec<double>(i % n, i / n % n, i / n / n));
  return points;
}

bool leash_catches_the_thread() {
  std::vector<Vec3<double>> const line{vec(0.030, 0.030, 0.040), vec(0.034, 0.030, 0.040)};
  RodAssembly<Strand> rod;
  auto const thread = add_thread(rod, std::span<Vec3<double> const>(line), 3, {2e9, 2e-4, 1140.0});
  rod.add<Leash>({thread.first}, {0.030, 0.030, 0.040, 0.005, 0.0});

  SimulationOptions options{.cell_size = 2e-3, .nodes = {32, 24, 40}, .capacity = rod.capacity()};
  options.capacity.push_back({"particle", 216});
  options.capacity.push_back({"contact point", 3});
  Simulation<Ward, Serial, double> sim(options);
  auto const k = lame(20e3, 0.4);
  sim.set<NeoHookean>({k.mu, k.lambda});
  sim.set<Gravity>({{0.0, 0.0, -9.81}});
  sim.set<Embedded>({2e-4});
  sim.set<Friction>({0.2, 0.0});
  sim.add_particles(0, cube(vec(0.046, 0.026, 0.060), 1e-3, 6), 1000.0, 1e-9);
  rod.write(sim.state(), 0);
  sim.state().table<ContactPoints>().set_live(0, 3);

  double longest = 0.0;
  for (int step = 0; step < 50; ++step) {
    sim.step(1e-3);
    auto const held = sim.state().get<bead::Position>(0, thread.first) - line[0];
    longest = std::max(longest, norm(held));
  }
  auto const v = sim.state().get<particle::Velocity>(0, 0);
  bool good = check(sim.status(0) == 0, "no fault");
  good &= check(longest > 0.00499 && longest < 0.00501,
                fmt::format("the leash of 5 mm lets the thread fall {:.3f} mm", 1e3 * longest));
  good &= check(std::abs(v[2] + 9.81 * 0.05) < 1e-9, "the block beside it falls freely");
  good &= check(plan<Ward>().find("Leash") != std::string::npos, "the plan names the constraint");
  return good;
}
}  // namespace hospital

int main() {
  auto const ours = mpmpbd::Mat3<double>::identity();
  Eigen::Map<Eigen::Matrix3d const> const theirs(ours.m);
  fmt::print("mpmpbd {}\n", MPMPBD_VERSION_STRING);
  bool good = hospital::check(theirs.trace() == 3.0, "Eigen reads our matrices");
  good &= hospital::laws_hold();
  good &= hospital::leash_catches_the_thread();
  return good ? 0 : 1;
}
