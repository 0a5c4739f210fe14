// What fixed point does to momentum on an emulated device: nothing in the mean, however small it is.
#include <cmath>
#include <vector>

#include <mpmpbd/backend/cuda/simulation.cuh>
#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include "catch.hpp"
#include "cuda/compare.hpp"
#include "cuda/fixed_point_noise.hpp"
#include "physics/spinning_disc.hpp"

using namespace test;

namespace {

struct Fall : Scene<Mpm<NeoHookean>, Gravity> {};
constexpr double dx = 3.7e-3, g = 9.81;
constexpr int across = 8, particles = across * across * across;

template <class T, class Backend> Simulation<Fall, Backend, T> block(Backend where) {
  Simulation<Fall, Backend, T> run({.environments = 1,
                                    .cell_size = dx,
                                    .nodes = {12, 12, 15},
                                    .capacity = {{"particle", particles}},
                                    .substeps = 1},
                                   where);
  run.template set<NeoHookean>(lame(1.3e4, 0.4));
  run.template set<Gravity>({{0.0, 0.0, -g}});
  std::vector<Vec3<double>> at;
  for (int k = 0; k < across; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i)
        at.push_back(dx * vec(3.11 + 0.5 * i, 3.37 + 0.5 * j, 8.05 + 0.5 * k));
  run.add_particles(0, at, 1050.0, dx * dx * dx / 8);
  return run;
}

}  // namespace

// Rounded share by share, this block has 0.998, 0.81 and 0.01 of its speed: small shares were lost.
TEST_CASE("a body falls on a device as fast in short steps as in long ones", "[cuda][momentum]") {
  constexpr int steps = 100;
  for (auto form : {Cuda::Execution::resident, Cuda::Execution::tiled})
    for (double dt : {1.25e-4, 2e-5, 4e-6}) {
      auto run = block<float>(Cuda{.execution = form});
      step_on(run, steps, dt);
      double mean = 0.0;
      for (int p = 0; p < particles; ++p)
        mean += double(read(run).get<particle::Velocity>(0, p)[2]) / particles;
      double const exact = -steps * g * dt;
      CAPTURE(run.execution(), dt, mean / exact);
      CHECK(std::abs(mean - exact) < fixed_point_noise_of_mean(dx, dt, steps, particles) +
                                         steps * 0x1p-24 * std::abs(exact));
      CHECK(run.status(0) == 0);
    }
}

// A particle that stretches by three cells per substep brings as much to the corners of its stencil: more than sums of float
// hold, for which it is slowed down and says so. Those of double take it whole.
TEST_CASE("sums of double hold what a fast particle brings", "[cuda][momentum]") {
  constexpr double dt = 1.25e-4;
  auto const step = [](auto run) {
    auto C = Mat3<double>{};
    C(0, 0) = 3.0 / dt;
    using T = typename decltype(run)::Scalar;
    run.state().template set<particle::Affine>(0, 0, cast<T>(C));
    step_on(run, 1, dt);
    return run;
  };
  auto const host = step(block<double>(Serial{}));
  auto const device = step(block<double>(Cuda{}));
  CHECK(!has(host.status(0), Fault::speed));
  CHECK(device.status(0) == host.status(0));
  double const fastest = 3.0 * dx / dt;
  CHECK(difference<particle::Velocity>(read(device), read(host)) < 1e-12 * fastest);
  CHECK(has(step(block<float>(Cuda{})).status(0), Fault::speed));
}

TEST_CASE("a disc in free flight keeps its spin on a device", "[cuda][momentum]") {
  constexpr int steps = 64;
  Disc<Mpm<FixedCorotated, Apic, Mls>, 8, Cuda, float> disc;
  double const before = disc.spin(disc.totals());
  disc.advance(steps);
  double const noise =
      fixed_point_noise_of_mean(disc.dx, disc.dt(), steps, double(disc.particles())) /
      disc.speed_of_gyration();
  CHECK(disc.spin(disc.totals()) / before == Approx(1.0).margin(noise));
  CHECK(disc.status() == 0);
}
