// seconds: 5
// on a device
// A3.3 of verification.md: the period of a hanging chain of N equal beads is a zero of the Laguerre polynomial.
#include <algorithm>
#include <cmath>
#include <vector>

#include "catch.hpp"
#include "physics/ringing.hpp"
#include "physics/rods_on_back_end.hpp"

using namespace rods;

namespace {
struct Body : Pbd<Constraints<Distance>, DirectBanded<2>> {};

double const length = 0.37;

// L_0 ... L_N at z: how far beads swing, from the lowest upwards, where omega^2 = z g/l. Above the bead of L_m is a link that
// carries m + 1 beads: (m + 1) (L_m - L_(m+1)) - m (L_(m-1) - L_m) = z L_m.
std::vector<double> laguerre(int N, double z) {
  std::vector<double> L{1, 1 - z};
  for (int m = 1; m < N; ++m)
    L.push_back(((2 * m + 1 - z) * L[std::size_t(m)] - m * L[std::size_t(m) - 1]) / (m + 1));
  return L;
}

// Slowest mode of N beads below a fixed one, L_N = 0: lambda, and shape per bead from above, of length 1.
std::pair<double, std::vector<double>> slowest_mode(int N) {
  double low = 0, high = 4.0 / N;  // the second zero is beyond
  for (int halved = 0; halved < 60; ++halved) {
    double const middle = 0.5 * (low + high);
    (laguerre(N, middle).back() > 0 ? low : high) = middle;
  }
  std::vector<double> shape = laguerre(N, low);
  shape.pop_back();
  std::ranges::reverse(shape);
  double square = 0;
  for (double const out : shape) square += out * out;
  for (double& out : shape) out /= std::sqrt(square);
  return {low, shape};
}

// The period in units of sqrt(L/g), with `steps` per period.
double period(int N, int steps) {
  auto const [lambda, shape] = slowest_mode(N);
  double const T = 2 * pi<double> / std::sqrt(lambda * gravity / (length / N)), h = T / steps;
  auto rod =
      chain<Body>(straight({{0.1, 0.2, 0.5}}, {{0.1, 0.2, 0.5 - length}}, N + 1), 0.003, 0.0);
  Simulated<Body> rig(rod);
  double const l = length / N;
  V3 at{{0.1, 0.2, 0.5}};
  double before = 0;
  for (int k = 0; k < N; ++k) {  // links keep their length
    double const out = 1e-4 * length * shape[std::size_t(k)], dx = out - before;
    at += vec(dx, 0.0, -std::sqrt(l * l - dx * dx));
    before = out;
    rig.store.set<bead::Position>(0, k + 1, at);
  }
  Ringing mode;
  for (int s = 0; s < steps; ++s) {
    rig.step(h);
    double x = 0;
    for (int k = 0; k < N; ++k) x += shape[std::size_t(k)] * (rig.x(k + 1)[0] - 0.1);
    mode.add(x);
  }
  REQUIRE(rig.faults == 0);
  return 2 * pi<double> * h / mode.turn() / std::sqrt(length / gravity);
}
}  // namespace

TEST_CASE("A3.3: hanging chains swing with the Laguerre periods", "[constraint][physics]") {
  struct Row {
    int beads;
    double exact;
  };
  double const continuous = 5.225481147;
  double previous_error = 0;
  for (auto const [N, exact] : {Row{5, 5.473370578},
                                {10, 5.352609358},
                                {20, 5.289900246},
                                {50, 5.251462406},
                                {100, 5.238508122}}) {
    CHECK(2 * pi<double> / std::sqrt(slowest_mode(N).first * N) == Approx(exact).epsilon(1e-9));
    // Implicit Euler's period errs with h^2.
    double const coarse = period(N, 300), fine = period(N, 600), limit = (4 * fine - coarse) / 3;
    INFO("N = " << N << ": " << coarse << ", " << fine << " -> " << limit << ", exact " << exact
                << ", error " << limit / exact - 1);
    CHECK(std::abs(limit / exact - 1) < 1e-3);
    double const error = limit - continuous;
    if (N == 10 || N == 20 || N == 100) {  // twice as many as before
      double const order = std::log2(previous_error / error);
      INFO("order in 1/N: " << order);
      CHECK(order > 0.9);
      CHECK(order < 1.1);
    }
    previous_error = error;
  }
}
