// A3.5 and A3.14 of verification.md, with the elastica of A2.9 (exact to 1e-8): a cantilever bent far by a tip
// load and by its own weight, its order in the number of joints, and its swing.
// seconds: 6
// on a device
#include "catch.hpp"
#include "physics/ringing.hpp"
#include "physics/rods_at_rest.hpp"

using namespace rods;

namespace {
struct Body : Pbd<Constraints<Distance, Bend>, DirectBanded<2>> {};

double const length = 0.37, stiffness = 2.3e-5, line_density = 4.1e-3;  // [m], [N m^2], [kg/m]

Cantilever beam(int segments, double wall_share = 0.5, double tip_weight = 0.25) {
  return {thin_wire(stiffness, line_density, 1e-4),
          length,
          segments,
          {{1, 0, 0}},
          wall_share,
          tip_weight};
}
// Tip of a beam at rest, in units of its length: out along x, down along -z, and the slope there [rad].
struct Tip {
  double out, down, slope;
};
Tip bent(Cantilever const& of, double tip_force, double g) {
  auto rig = of.build<Body>();
  double const unit = of.unit(), h = 2e-3 * unit;
  bool const rests = settle(
      rig, h, 7 / unit, 1e-9 * length / unit, 40000,
      [&](auto& r, double dt) {
        push(r, of.tip(), {{0, 0, -tip_force}}, dt);
      },
      g);
  CHECK(rests);
  CHECK(rig.faults == 0);
  auto const x = rig.x(of.tip()), last = x - rig.x(of.tip() - 1);
  return {x[0] / length, -x[2] / length, std::atan2(-last[2], last[0])};
}
Tip under_tip_load(Cantilever const& of, double alpha) {
  return bent(of, alpha * stiffness / square(length), 0.0);
}
Tip under_weight(Cantilever const& of, double gamma) {
  return bent(of, 0.0, gamma * stiffness / (line_density * std::pow(length, 3)));
}
}  // namespace

TEST_CASE("A3.5: a tip load bends a cantilever into the elastica", "[bend][physics]") {
  struct Row {
    double alpha, drop, shortening, slope;  // alpha = P L^2 / EI
  };
  for (auto const& row :
       {Row{0.5, 0.16214358, 0.01591896, 0.24453365}, Row{1, 0.30172077, 0.05643324, 0.46135195},
        Row{2, 0.49345748, 0.16064172, 0.78174983}, Row{5, 0.71379152, 0.38762836, 1.21536812},
        Row{10, 0.81060902, 0.55499560, 1.43028554}}) {
    auto const tip = under_tip_load(beam(64), row.alpha);
    CAPTURE(row.alpha, tip.down, tip.out, tip.slope);
    CHECK(tip.down == Approx(row.drop).epsilon(5e-3));
    CHECK(1 - tip.out == Approx(row.shortening).epsilon(5e-3));
    CHECK(tip.slope == Approx(row.slope).epsilon(5e-3));
  }
}

TEST_CASE("A2.9: a heavy cantilever hangs as its elastica", "[bend][physics]") {
  struct Row {
    double gamma, drop, aspect;  // gamma = w L^3 / EI, aspect = drop / reach
  };
  for (auto const& row :
       {Row{1, 0.12347140, 0.124562}, Row{2, 0.23850658, 0.246673}, Row{5, 0.49590504, 0.585721},
        Row{10, 0.70019972, 1.066802}, Row{20, 0.82988144, 1.863930}, Row{50, 0.90791712, 3.705561},
        Row{100, 0.93752394, 5.888105}}) {
    auto const tip = under_weight(beam(64, 0.5, 0.0), row.gamma);
    CAPTURE(row.gamma, tip.down, tip.out);
    CHECK(tip.down == Approx(row.drop).epsilon(5e-3));
    CHECK(tip.down / tip.out == Approx(row.aspect).epsilon(5e-3));
  }
}

TEST_CASE("A3.5: joints have order 2, and order 1 with a whole hinge at the wall",
          "[bend][physics][order]") {
  double const exact = 0.49345748;  // alpha = 2
  auto error = [&](int segments, double wall) {
    return std::abs(under_tip_load(beam(segments, wall), 2).down - exact);
  };
  double const half = std::log2(error(16, 0.5) / error(32, 0.5)),
               whole = std::log2(error(16, 1.0) / error(32, 1.0));
  CAPTURE(half, whole);
  CHECK(half > 1.8);
  CHECK(half < 2.2);
  CHECK(whole > 0.9);
  CHECK(whole < 1.2);
}

TEST_CASE("A3.5: a small tip load moves N joints as N joints by hand", "[bend][physics]") {
  // A hinge at the wall: (1 + 1/N)(1 + 1/(2N)) P L^3 / (3 EI); half a hinge: 1 + 1/(2 N^2).
  double const alpha = 1e-3;
  for (int N : {8, 20}) {
    CAPTURE(N);
    CHECK(under_tip_load(beam(N, 1.0), alpha).down ==
          Approx(alpha / 3 * (1 + 1.0 / N) * (1 + 0.5 / N)).epsilon(1e-5));
    CHECK(under_tip_load(beam(N, 0.5), alpha).down ==
          Approx(alpha / 3 * (1 + 0.5 / (N * N))).epsilon(1e-5));
  }
}

TEST_CASE("A3.14: a cantilever swings for 100 s with its period and implicit Euler's decay",
          "[bend][physics]") {
  // L = 1 m, r = 20 mm, E = 0.1 MPa, 500 kg/m^3: a period of 12.6 s.
  Cantilever const rod{{1e5, 0.02, 500}, 1.0, 64, {{1, 0, 0}}, 0.5};
  double const mode = 1.875104068711961, omega = square(mode) / rod.unit();
  auto shape = [&](double s) {  // of the first mode, tip 2
    double const a = mode * s,
                 ratio = (std::sinh(mode) - std::sin(mode)) / (std::cosh(mode) + std::cos(mode));
    return std::cosh(a) - std::cos(a) - ratio * (std::sinh(a) - std::sin(a));
  };
  auto rig = rod.build<Body>();
  for (int b = 2; b <= rod.tip(); ++b) {
    double const s = rod.segment() * (b - 1);
    rig.store.set<bead::Position>(0, b, {{s, 0, 1e-5 * shape(s)}});
  }
  double const h = 2 * pi<double> / omega / 400;
  Ringing swing;
  for (int s = 0; s * h < 100; ++s) {
    rig.step(h, 0.0);
    double sum = 0;
    for (int b = 2; b <= rod.tip(); ++b)
      sum += (b == rod.tip() ? 0.5 : 1.0) * shape(rod.segment() * (b - 1)) * rig.x(b)[2];
    swing.add(sum);
  }
  // Implicit Euler turns by atan(omega h) and leaves 1/sqrt(1 + (omega h)^2) each step (A3.1).
  double const measured = std::tan(swing.turn()) / h;
  CAPTURE(measured, omega, swing.decay());
  CHECK(measured == Approx(omega).epsilon(5e-3));
  CHECK(1 - swing.decay() == Approx(1 - 1 / std::sqrt(1 + square(omega * h))).epsilon(1e-2));
}
