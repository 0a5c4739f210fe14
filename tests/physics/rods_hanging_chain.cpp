// seconds: 5
// on a device
// A3.3 of verification.md: the period of a hanging chain of N equal beads is a zero of the Laguerre polynomial.
#include "catch.hpp"
#include "physics/ringing.hpp"
#include "physics/rods_on_back_end.hpp"

#include <Eigen/Dense>

using namespace rods;

namespace {
struct Body : Pbd<Constraints<Distance>, DirectBanded<2>> {};

double const length = 0.37;

// Slowest mode of N beads below a fixed one: omega^2 = lambda g/l, shape per bead.
std::pair<double, Eigen::VectorXd> slowest_mode(int N) {
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(N, N);
  for (int k = 0; k < N; ++k) {  // link k is above bead k and carries N - k beads
    double const tension = N - k;
    K(k, k) += tension;
    if (k > 0) {
      K(k - 1, k - 1) += tension;
      K(k, k - 1) -= tension;
      K(k - 1, k) -= tension;
    }
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> const solved(K);
  return {solved.eigenvalues()(0), solved.eigenvectors().col(0)};
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
    double const out = 1e-4 * length * shape(k), dx = out - before;
    at += vec(dx, 0.0, -std::sqrt(l * l - dx * dx));
    before = out;
    rig.store.set<bead::Position>(0, k + 1, at);
  }
  Ringing mode;
  for (int s = 0; s < steps; ++s) {
    rig.step(h);
    double x = 0;
    for (int k = 0; k < N; ++k) x += shape(k) * (rig.x(k + 1)[0] - 0.1);
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
