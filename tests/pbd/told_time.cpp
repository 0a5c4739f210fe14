// What acts on the beads of threads alone is told the time, also between the substeps of a solver.
#include "catch.hpp"

#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/pbd/solvers/gauss_seidel.hpp>
#include <mpmpbd/scene/simulation.hpp>

using namespace mpmpbd;

namespace {

// A pull on all beads that grows with time.
struct Growing {
  using Role = role::Effect;
  static constexpr FixedString name = "growing pull";
  static constexpr Slot slot = Slot::before_solve;
  using Reads = Fields<bead::Velocity>;
  using Writes = Fields<bead::Velocity>;

  template <class T> struct Parameters {
    T rate;  // [m/s^3]
  };
  static constexpr std::array<ParameterInfo, 1> parameter_info{
      {bound::not_negative("rate", "m/s^3")}};

  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& bead, K const& k, Tick<T> const& tick) {
    bead[bead::Velocity{}][2] += k.rate * tick.time * tick.dt;
  }
};

constexpr int of_solver = 4, of_scene = 3, steps = 5;
struct Pulled : Scene<Pbd<Constraints<Distance>, SmallSteps<of_solver>>, Growing> {};

}  // namespace

TEST_CASE("an effect on threads alone is told the time", "[rod][effect]") {
  SimulationOptions o;
  o.capacity = {{"bead", 2}, {"Distance", 1}};
  o.substeps = of_scene;
  Simulation<Pulled, Serial, double> run(o);
  RodAssembly<Pulled::Rods> rod;
  std::vector<Vec3<double>> const line{vec(0.0, 0.0, 0.0), vec(0.02, 0.0, 0.0)};
  add_thread(rod, std::span<Vec3<double> const>(line), RodMaterial{2e9, 1.15e-4, 1140.0});
  rod.write(run.state(), 0);
  constexpr double rate = 0.7, h = 0.02;
  run.set<Growing>({rate});
  for (int s = 0; s < steps; ++s) run.step(h);

  double const n = steps * of_scene * of_solver, dt = h / (of_scene * of_solver);
  for (std::int64_t b : {0, 1})
    CHECK_THAT(run.state().get<bead::Velocity>(0, b)[2],
               WithinRel(rate * dt * dt * n * (n - 1) / 2, 1e-9));
}
