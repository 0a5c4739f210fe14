// The reference scheme in a block of soft tissue: what a thread feels that is pushed sideways, pulled along
// itself, or dragged. Expected values that document its limits, beside Embedded in the same scene.
// seconds: 40
// on a device
#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/coupling/grid_projection.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include <cmath>
#include <vector>

#include "catch.hpp"
#include "physics/back_end.hpp"

using namespace mpmpbd;

namespace {

constexpr double dx = 1e-3, density = 1060.0, dt = 1e-4;

struct Tissue : Mpm<NeoHookean> {};
struct Thread : Pbd<Constraints<Distance>> {};
using Left = Wall<Sticky, 1, Side::low>;
using Right = Wall<Sticky, 1, Side::high>;
using Below = Wall<Sticky, 2, Side::low>;
using Above = Wall<Sticky, 2, Side::high>;
template <class Laws_> struct Block : Scene<Tissue, Thread, Laws_, Left, Right, Below, Above> {};

// 8 mm cubed, E = 10 kPa, held on four sides; a straight thread of 7 mm along x through (y, z) [cells] whose
// motion is prescribed: it is the force that is asked for.
template <class Laws_> class Probe {
 public:
  Probe(parameters_t<typename Laws_::Strategy, double> const& k, Vec3<double> const& velocity,
        double y = 7.3, double z = 7.6)
      : sim_(options()) {
    sim_.template set<NeoHookean>(lame(10e3, 0.4));
    sim_.template set<typename Laws_::Strategy>(k);
    sim_.template set<Left>({3 * dx});
    sim_.template set<Below>({3 * dx});
    sim_.template set<Right>({11 * dx});
    sim_.template set<Above>({11 * dx});
    std::vector<Vec3<double>> points;
    for (int k3 = 0; k3 < 16; ++k3)
      for (int j = 0; j < 16; ++j)
        for (int i = 0; i < 16; ++i)
          points.push_back(dx *
                           (vec(3.25, 3.25, 3.25) + 0.5 * vec(double(i), double(j), double(k3))));
    sim_.add_particles(0, points, density, dx * dx * dx / 8);
    RodAssembly<Thread> rod;
    std::vector<Vec3<double>> line;
    for (int b = 0; b < beads; ++b) line.push_back(dx * vec(3.5 + 7.0 * b / (beads - 1), y, z));
    add_thread(rod, std::span<Vec3<double> const>(line), RodMaterial{1e9, 1e-4, 1100.0});
    for (int b = 0; b < beads; ++b) rod.prescribe(b, velocity);
    rod.write(sim_.state(), 0);
    if constexpr (std::is_same_v<typename Laws_::Strategy, Embedded>)
      sim_.state().template table<ContactPoints>().set_live(0, beads);
  }
  auto& sim() { return sim_; }

  // On the tissue, last substep [N s].
  Vec3<double> impulse() const {
    Vec3<double> sum{};
    if constexpr (std::is_same_v<typename Laws_::Strategy, Embedded>)
      for (int q = 0; q < beads; ++q) sum += sim_.state().template get<contact::Impulse>(0, q);
    else
      for (int b = 0; b < beads; ++b) sum -= sim_.state().template get<bead::Recoil>(0, b);
    return sum;
  }
  // Mean force on the tissue from substep `first` to `end` [N].
  Vec3<double> force(int first, int end, double substep = dt) {
    Vec3<double> sum{};
    for (int s = 0; s < end; ++s) {
      sim_.step(substep);
      if (s >= first) sum += impulse();
    }
    return (1 / (substep * (end - first))) * sum;
  }

 private:
  static constexpr int beads = 9;
  static SimulationOptions options() {
    SimulationOptions o;
    o.cell_size = dx;
    for (int& n : o.nodes) n = 15;
    o.substeps = 1;
    o.capacity = {{"particle", 4096},
                  {"bead", beads},
                  {Distance::name.view(), beads - 1},
                  {ContactPoints::name.view(), beads}};
    return o;
  }
  Simulation<Block<Laws_>, test::BackEnd, double> sim_;
};

struct Spread {
  double mean, variation, least;  // variation and minimum relative to the mean
  int zero;                       // of 16
};

// Lateral force over 16 places of the thread within a cell, after a push of 0.05 cells.
template <class Laws_> Spread spread(parameters_t<typename Laws_::Strategy, double> const& k) {
  double sum = 0, squares = 0, least = 1e300;
  int zero = 0;
  for (int n = 0; n < 16; ++n) {
    Probe<Laws_> p(k, vec(0.0, 0.05 * dx / (60 * dt), 0.0), 7 + (n % 4 + 0.5) / 4,
                   7 + (n / 4 + 0.5) / 4);
    double const f = p.force(40, 60)[1];
    REQUIRE(p.sim().status(0) == 0);
    sum += f;
    squares += f * f;
    least = std::min(least, f);
    zero += std::abs(f) < 1e-12;
  }
  double const mean = sum / 16;
  return {mean, std::sqrt(squares / 16 - mean * mean) / mean, least / mean, zero};
}

}  // namespace

// Only nodes within the contact radius and ahead of the thread are pushed, so their number decides
// (tests/coupling/grid_projection.cpp counts them). With a quarter of a cell 2 of these 16 places have one:
// sqrt(14/2) = 265 %, whatever the tissue does. The reference code gave 214 %, which is 3 places of 16. With
// one cell it is one node or two, 30 % over these places and 37 % over all (the reference: 36 %); the
// tissue's own stiffness between the nodes brings it to 27 %.
TEST_CASE("thin threads leak through the grid", "[physics][reference]") {
  using Reference = Coupling<GridProjection>;
  auto const thin = spread<Reference>({0.25 * dx, 0.0});
  CAPTURE(thin.mean, thin.variation, thin.least, thin.zero);
  CHECK(thin.variation == Approx(std::sqrt(7.0)).epsilon(0.01));
  CHECK(thin.zero == 14);
  CHECK(thin.least == 0.0);
  auto const half = spread<Reference>({0.5 * dx, 0.0});
  CAPTURE(half.mean, half.variation, half.least, half.zero);
  CHECK(half.variation > 1.0);  // 125 %
  CHECK(half.zero == 8);
  auto const thick = spread<Reference>({dx, 0.0});
  CAPTURE(thick.mean, thick.variation, thick.least, thick.zero);
  CHECK(thick.variation == Approx(0.27).margin(0.03));
  CHECK(thick.least < 0.7);
  auto const embedded = spread<Coupling<Embedded>>({1e-4});
  CAPTURE(embedded.mean, embedded.variation, embedded.least);
  CHECK(embedded.variation < 0.06);  // 4.4 %
  CHECK(embedded.least > 0.9);       // 0.93
}

// Nothing comes nearer to a line that moves along itself: whatever the friction, tissue hardly holds it.
TEST_CASE("an axial pull meets no friction", "[physics][reference]") {
  using Rough = Coupling<GridProjection, Friction>;
  for (double const mu : {0.2, 5.0}) {
    Probe<Rough> p({dx, 0.0}, vec(0.05, 0.0, 0.0));
    p.sim().set<Friction>({mu, 1e3});
    double const f = p.force(0, 60)[0];
    CAPTURE(mu, f);
    CHECK(std::abs(f) < 1e-9);  // the reference code: up to 1.3e-3 N
  }
}

// A share of the slip per substep: over the same 0.4 ms the force doubles with every halving of dt.
TEST_CASE("drag grows as 1/dt", "[physics][reference]") {
  double previous = 0;
  for (int const n : {4, 8, 16, 32}) {
    Probe<Coupling<GridProjection>> p({dx, 1e-3}, vec(0.05, 0.0, 0.0));
    double const f = p.force(0, n, 4 * dt / n)[0];
    CAPTURE(n, f);
    if (previous > 0) CHECK(f / previous == Approx(2.0).epsilon(0.01));
    previous = f;
  }
}
