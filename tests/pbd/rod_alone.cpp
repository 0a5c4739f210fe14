// The program of docs/concepts/solver.md: a rod without tissue, by hand.
#include "catch.hpp"
#include "shown.hpp"

#include <cmath>

#include <mpmpbd/coupling/team.hpp>
#include <mpmpbd/pbd/access.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/pbd/solvers/direct_banded.hpp>

using namespace mpmpbd;

struct Suture : Pbd<Constraints<Distance, Bend>, DirectBanded<2>> {};

// The height of the free end [m] of a 3-0 nylon thread, clamped at one end, after 0.2 s.
double droop() {
  RodAssembly<Suture> rod;
  RodMaterial const nylon{2e9, 0.115e-3, 1140};  // E [Pa], radius [m], density [kg/m^3]
  std::vector<Vec3<double>> const line{{{0.0, 0.0, 0.0}}, {{0.1, 0.0, 0.0}}};
  auto const thread = add_thread(rod, std::span<Vec3<double> const>(line), 51, nylon);
  rod.prescribe(thread.first);  // two beads that do not move: a clamp
  rod.prescribe(thread.first + 1);

  using Store = State<double, Suture::AllFields>;  // a Simulation does this for a scene
  Store store(1);
  store.table<Beads>().resize(1, rod.beads());
  store.table<Instances<Distance>>().resize(1, rod.instances<Distance>());
  store.table<Instances<Bend>>().resize(1, rod.instances<Bend>());
  rod.write(store, 0);
  auto const env = access_environment(store, 0, Store::Domains{});

  std::uint32_t faults = 0;
  double const dt = 1e-3;
  for (std::int64_t step = 0; step < 200; ++step) {
    faults |= Suture::step(Solo{}, env, Tick<double>{dt, dt, step},
                           [](auto const& team, auto const& e, auto const& tick) {
                             team.each(static_cast<int>(e.template live<Beads>()), [&](int b) {
                               if (!(e.template get<bead::InverseMass>(b) > 0)) return;
                               auto v = e.template get<bead::Velocity>(b);
                               v[2] -= 9.81 * tick.dt;
                               e.template set<bead::Velocity>(b, v);
                             });
                           });
  }
  return faults == 0 ? env.get<bead::Position>(thread.last - 1)[2] : 1.0;
}

// The first mode of a cantilever that is let go: w L^4 / (8 EI) (1 - exp(-w^2 h t / 2) cos(w t)); L = 98 mm,
// because the second bead is the clamp.
TEST_CASE("the program of the page bends as a cantilever does", "[constraint][bend][doc]") {
  RodMaterial const nylon{2e9, 0.115e-3, 1140};
  double const L = 0.098, t = 0.2, h = 1e-3, weight = nylon.line_density(),
               EI = nylon.bending_stiffness();
  double const omega = 3.51601527 * std::sqrt(EI / (weight * std::pow(L, 4)));
  double const rest = weight * 9.81 * std::pow(L, 4) / (8 * EI);
  double const z = droop(),
               expected = -rest * (1 - std::exp(-omega * omega * h * t / 2) * std::cos(omega * t));
  INFO("tip " << z << " m, first mode " << expected << " m");
  CHECK(z == Approx(expected).epsilon(0.15));
}

TEST_CASE("the page shows this code", "[solver][example]") {
  CHECK(blocks_not_in(__FILE__, "concepts/solver.md") == std::vector<std::string>{});
}
