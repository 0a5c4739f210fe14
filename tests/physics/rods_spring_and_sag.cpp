// seconds: 5
// on a device
// A3.1 and A3.2 of verification.md: one spring is implicit Euler; a hanging chain sags as its compliance says.
#include "catch.hpp"
#include "physics/rods_on_back_end.hpp"

using namespace rods;

namespace {
template <int iterations> struct Iterated : Pbd<Constraints<Distance>, Xpbd<iterations>> {};
struct Direct : Pbd<Constraints<Distance>, DirectBanded<1>> {};
}  // namespace

TEST_CASE("A3.1: one spring, one iteration is implicit Euler", "[constraint][physics]") {
  double const m = 0.013, k = 47.0, rest = 0.21, h = 1.0 / 137;
  RodAssembly<Iterated<1>> rod;
  rod.add_bead({{0.4, -0.1, 0.2}}, 1.7);
  rod.prescribe(0);
  rod.add_bead({{0.4 + rest + 0.05, -0.1, 0.2}}, m);
  rod.add<Distance>({0, 1}, {rest, 1 / k});
  Simulated<Iterated<1>> rig(rod);

  double x = 0.05, v = 0, worst = 0, worst_decay = 0, worst_phase = 0;
  double const omega = std::sqrt(k / m);
  for (int n = 0; n < 60; ++n) {
    double const x1 = (x + h * v) / (1 + h * h * k / m);
    v = (x1 - x) / h;
    double const before_x = rig.x(1)[0] - 0.4 - rest, before_v = rig.v(1)[0];
    rig.step(h, 0.0);
    double const after_x = rig.x(1)[0] - 0.4 - rest, after_v = rig.v(1)[0];
    x = x1;
    worst = std::max({worst, std::abs(after_x - x) / 0.05, std::abs(after_v - v) / (0.05 * omega)});
    if (n < 20) {  // while the amplitude is far above rounding
      double const a = std::hypot(omega * before_x, before_v),
                   b = std::hypot(omega * after_x, after_v);
      double const turn = std::remainder(
          std::atan2(-after_v, omega * after_x) - std::atan2(-before_v, omega * before_x),
          2 * pi<double>);
      worst_decay = std::max(worst_decay, std::abs(b / a * std::sqrt(1 + square(omega * h)) - 1));
      worst_phase = std::max(worst_phase, std::abs(turn - std::atan(omega * h)));
    }
  }
  INFO("recurrence " << worst << ", decay " << worst_decay << ", phase " << worst_phase);
  CHECK(worst < 1e-12);
  CHECK(worst_decay < 1e-12);
  CHECK(worst_phase < 1e-12);
}

namespace {
// Static sag of N links of compliance a under their beads' weight, over the exact value.
template <class Body> double sag(double dt, VisitOrder order, double seconds) {
  int const N = 10;
  double const m = 0.02, a = 1e-3, l = 0.13;
  auto const rod = chain<Body>(straight({{0.2, 0.1, 0.3}}, {{0.2, 0.1, 0.3 - N * l}}, N + 1), m, a);
  Simulated<Body> rig(rod, order);
  for (int s = 0; s < seconds / dt; ++s) rig.step(dt);
  return (0.3 - N * l - rig.x(N)[2]) / (a * m * gravity * N * (N + 1) / 2);
}
}  // namespace

TEST_CASE("A3.2: static sag does not depend on the step", "[constraint][physics]") {
  // The slowest axial mode (33 rad/s) decays with omega^2 h/2: 0.56/s at the smallest step.
  double const rates[3] = {60, 240, 1000}, seconds[3] = {3, 8, 30};
  for (int i = 0; i < 3; ++i) {
    double const h = 1 / rates[i];
    CAPTURE(rates[i]);
    CHECK(std::abs(sag<Iterated<200>>(h, VisitOrder::coloured, seconds[i]) - 1) < 1e-6);
    CHECK(std::abs(sag<Direct>(h, VisitOrder::coloured, 2 * seconds[i]) - 1) < 1e-9);
  }
}

// One sweep leaves every link with the stretch that the links after it put back: in a sweep along the
// chain link i keeps alpha T_i + h^2 w T_{i+1}, so the sag is too long by (h^2 / (a m)) (N-1)/(N+1); with two
// colours the odd links keep both neighbours' parts, 49/55 of h^2/(a m) for N = 10.
TEST_CASE("A3.2: the bias of one iteration is the known one", "[constraint][physics]") {
  double const table[3] = {12.4, 1.71, 1.041}, rates[3] = {60, 240, 1000};
  for (int i = 0; i < 3; ++i) {
    double const h = 1 / rates[i], unit = h * h / (1e-3 * 0.02);
    double const along_chain = sag<Iterated<1>>(h, VisitOrder::along, 40),
                 coloured = sag<Iterated<1>>(h, VisitOrder::coloured, 40);
    INFO("rate " << rates[i] << ": along " << along_chain << ", coloured " << coloured);
    CHECK(along_chain == Approx(1 + unit * 9 / 11).epsilon(1e-6));
    CHECK(along_chain == Approx(table[i]).epsilon(5e-3));
    CHECK(coloured == Approx(1 + unit * 49 / 55).epsilon(1e-6));
  }
}
