// Other compositions in the resident form, on an emulated device: tissue alone, a coupling that reads particles, one that
// works on the grid, and a material whose stress is state.
// seconds: 2
#include "catch.hpp"
#include "cuda/scenes.hpp"

using namespace test;

TEMPLATE_TEST_CASE("a scene moves on a device as it does on the host", "[cuda][resident]", Alone,
                   Relaxing, Squeezed, Projected) {
  auto host = made<Simulation<TestType, Serial, float>>(2);
  emulated::seed = 1;
  auto device = made<Simulation<TestType, Cuda, float>>(2);
  auto other = made<Simulation<TestType, Cuda, float>>(2, Cuda{.threads = 160});
  int const steps = 5;
  for (int s = 0; s < steps; ++s) {
    host.step(step);
    emulated::seed = 1;
    device.step(step);
    emulated::seed = 9;
    other.step(step);
  }
  auto const &d = std::as_const(device).state(), &h = std::as_const(host).state();
  double const v = rounding<TestType>(steps);
  CHECK(difference<particle::Velocity>(d, h) < v);
  CHECK(difference<particle::Position>(d, h) < v * steps * step);
  if constexpr (TestType::has_rods) {
    CHECK(difference<bead::Velocity>(d, h) < v);
    CHECK(difference<bead::Position>(d, h) < v * steps * step);
    CHECK(std::abs(h.template get<bead::Velocity>(0, 4)[0] - 0.8f) > 0.05f);  // tissue holds it
  }
  for (std::int64_t env : {0, 1}) CHECK(device.status(env) == host.status(env));
  for (std::int64_t env : {0, 1}) CHECK(same_bits(d, env, std::as_const(other).state(), env));
}

// Three environments on two multiprocessors: where there is a coupling, one block carries two of them.
struct CountCalls {
  int* calls;  // per environment
  void operator()(std::int64_t env) const { atomicAdd(calls + env, 1); }
};
TEMPLATE_TEST_CASE("several steps in one launch are those steps one by one", "[cuda][resident]",
                   Alone, Squeezed) {
  auto apart = made<Simulation<TestType, Cuda, float>>(3);
  auto at_once = made<Simulation<TestType, Cuda, float>>(3);
  int calls[3] = {};
  for (int s = 0; s < 4; ++s) apart.step(step);
  REQUIRE(at_once.steps_at_once(step, nullptr, 4, CountCalls{calls}));
  for (std::int64_t env : {0, 1, 2}) {
    CHECK(same_bits(std::as_const(apart).state(), env, std::as_const(at_once).state(), env));
    CHECK(calls[env] == 3);
  }
  CHECK_THROWS_AS(at_once.steps_at_once(step, nullptr, 0, CountCalls{calls}),
                  std::invalid_argument);

  auto tiled =
      made<Simulation<TestType, Cuda, float>>(1, Cuda{.execution = Cuda::Execution::tiled});
  CHECK_FALSE(tiled.steps_at_once(step, nullptr, 4, CountCalls{calls}));
  CHECK(std::as_const(tiled).state().template get<environment::Step>(0) == 0);
}

// Without this limit the 32-bit sums of 200 particles at 20 cells per substep would wrap, and tissue would fly off anywhere.
TEMPLATE_TEST_CASE("what is faster than a cell per substep is slowed down to it on a device",
                   "[cuda][fixed_point]", Alone, Relaxing) {
  auto run = made<Simulation<TestType, Cuda, float>>(2);
  auto const cell = float(dx * substeps / step);  // [m/s]
  for (std::int64_t p = 0; p < 20 * 12 * 10; ++p)
    run.state().template set<particle::Velocity>(0, p, {{20.0f * cell, 0.0f, 0.0f}});
  run.step(step);
  auto const& after = std::as_const(run).state();
  CHECK(has(run.status(0), Fault::speed));
  CHECK_FALSE(has(run.status(0), Fault::not_finite));
  CHECK(run.status(1) == 0);
  float most = 0.0f, least = cell;
  for (std::int64_t p = 0; p < 20 * 12 * 10; ++p) {
    auto const v = after.template get<particle::Velocity>(0, p);
    most = std::max(most, norm(v));
    least = std::min(least, v[0]);
  }
  CHECK(most < 1.001f * cell);
  CHECK(least > -0.001f * cell);  // nothing turns round
}

// What the 32-bit sums of a device cannot hold or tell apart is told, in the environment where it is.
TEST_CASE("masses too far apart and crowded nodes are faults on a device", "[cuda][fixed_point]") {
  using Run = Simulation<Relaxing, Cuda, float>;
  auto heavy = made<Run>(2);
  auto const mass = std::as_const(heavy).state().get<particle::Mass>(0, 3);
  heavy.state().set<particle::Mass>(0, 3, 99.0f * mass);
  heavy.step(step);
  CHECK_FALSE(has(heavy.status(0), Fault::overflow));
  heavy.state().set<particle::Mass>(0, 3, 101.0f * mass);
  heavy.step(step);
  CHECK(has(heavy.status(0), Fault::overflow));
  CHECK(heavy.status(1) == 0);

  // On a node of quadratic splines, which takes 0.75^3 of a particle there.
  auto const crowded = [](std::int64_t count) {
    auto run = made<Run>(2);
    for (std::int64_t p = 0; p < count; ++p)
      run.state().set<particle::Position>(0, p, {{float(8 * dx), float(6 * dx), float(5 * dx)}});
    run.step(step);
    return run;
  };
  CHECK_FALSE(has(crowded(1100).status(0), Fault::overflow));
  auto const run = crowded(1300);
  CHECK(has(run.status(0), Fault::overflow));
  CHECK(run.status(1) == 0);
}
