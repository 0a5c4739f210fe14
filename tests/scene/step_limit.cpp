// What a run does about its stable limit: names what sets it, counts faults, and refuses when it is strict (B1, B3).
#include "catch.hpp"

#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>

using namespace mpmpbd;

namespace {

constexpr double dx = 4.3e-3;
struct Block : Scene<Mpm<NeoHookean>> {};
using Run = Simulation<Block, Serial, double>;

// Two environments with a cube of 64 points each; the second is four times as stiff.
Run two_cubes(int substeps, bool strict = false) {
  Run run({.environments = 2,
           .cell_size = dx,
           .nodes = {14, 14, 14},
           .capacity = {{"particle", 64}},
           .substeps = substeps,
           .strict = strict});
  std::vector<Vec3<double>> at;
  for (int n = 0; n < 64; ++n)
    at.push_back(dx * (vec(6.0, 6.0, 6.0) + 0.5 * vec(n % 4 + 0.5, n / 4 % 4 + 0.5, n / 16 + 0.5)));
  for (std::int64_t env = 0; env < 2; ++env) {
    run.set<NeoHookean>(env, lame(env == 0 ? 1e4 : 4e4, 0.3));
    run.add_particles(env, at, 1050.0, dx * dx * dx / 8);
  }
  return run;
}
void move(Run& run, std::int64_t env, Vec3<double> const& v, Mat3<double> const& C) {
  for (std::int64_t p = 0; p < 64; ++p) {
    run.state().set<particle::Velocity>(env, p, v);
    run.state().set<particle::Affine>(env, p, C);
  }
}
StepBound limited_by(Run const& run, std::int64_t env) {
  return StepBound(run.state().get<environment::DtBound>(env));
}

}  // namespace

TEST_CASE("what sets the stable limit is named", "[scene][time_step]") {
  auto run = two_cubes(0);
  double const elastic = run.suggest_dt(0);
  CHECK(run.suggest_dt(1) == Approx(elastic / 2));
  run.step(0.1 * elastic);
  CHECK(limited_by(run, 0) == StepBound::elastic);

  double const fast = 0.5 * dx / elastic;  // half a cell in a substep
  move(run, 0, vec(2 * fast, 0.0, 0.0), {});
  CHECK(run.suggest_dt(0) == Approx(time_step_safety * 0.5 * dx / (2 * fast)));
  run.step(1e-3 * elastic);
  CHECK(limited_by(run, 0) == StepBound::speed);
  CHECK(limited_by(run, 1) == StepBound::elastic);

  move(run, 0, {}, skew(vec(0.0, 0.0, 2.0 / elastic)));
  run.step(1e-3 * elastic);
  CHECK(limited_by(run, 0) == StepBound::strain);
}

TEST_CASE("a substep beyond the limit sets the bit of its environment, and is counted",
          "[scene][time_step]") {
  auto run = two_cubes(1);
  double const limit = run.suggest_dt(1) / time_step_safety;
  run.step(0.99 * limit);
  CHECK(run.status(0) == 0);
  CHECK(run.status(1) == 0);
  for (int n = 0; n < 3; ++n) run.step(1.01 * limit);
  CHECK(run.status(0) == 0);
  CHECK(run.status(1) == static_cast<std::uint32_t>(Fault::time_step));
  CHECK(run.state().get<environment::FaultCount>(0)[0] == 0);
  CHECK(run.state().get<environment::FaultCount>(1)[0] == 3);
  run.reset(1);
  CHECK(run.state().get<environment::FaultCount>(1)[0] == 0);
}

TEST_CASE("a strict run refuses a substep beyond the limit before anything moves",
          "[scene][time_step][refusal]") {
  auto run = two_cubes(2, true);
  double const limit = run.suggest_dt(1) / time_step_safety;
  move(run, 0, vec(0.1, 0.0, 0.0), {});
  auto const x = run.state().get<particle::Position>(0, 5);
  CHECK_THROWS_WITH(run.step(2.02 * limit), Catch::Contains("stable limit of environment 1") &&
                                                Catch::Contains("nothing has moved") &&
                                                Catch::Contains("more substeps"));
  CHECK(norm(run.state().get<particle::Position>(0, 5) - x) == 0.0);
  CHECK(run.state().get<environment::Step>(0) == 0);
  CHECK(run.status(1) == 0);

  unsigned char const first[] = {1, 0};  // the one that may
  CHECK_NOTHROW(run.step(2.02 * limit, first));
  CHECK(run.state().get<environment::Step>(0) == 2);
  CHECK_NOTHROW(run.step(1.98 * limit));
  CHECK(run.status(1) == 0);
}

TEST_CASE("a strict run takes as many substeps as it needs, up to its bound",
          "[scene][time_step][refusal]") {
  auto options = two_cubes(0).options();
  options.strict = true;
  options.most_substeps = 10;
  Run run(options);
  run.restore(two_cubes(0).state());
  double const dt = run.suggest_dt(1);
  CHECK_NOTHROW(run.step(9.9 * dt));
  CHECK(run.state().get<environment::Substeps>(1) == 10);
  CHECK_THROWS_WITH(run.step(13.0 * dt), Catch::Contains("longer than the stable limit"));
}

TEST_CASE("a shorter limit holds at once, a longer one after a while", "[scene][time_step]") {
  HeldLimit<double> held{};
  held.meet(2.5e-4);
  CHECK(held.limit == 2.5e-4);
  held.meet(1e-4);
  CHECK(held.limit == 1e-4);
  for (int s = 1; s < held.patience; ++s) held.meet(3e-4);
  CHECK(held.limit == 1e-4);
  SECTION("it grows by no more than a quarter") {
    held.meet(3e-4);
    CHECK(held.limit == Approx(1.25e-4));
  }
  SECTION("it grows to the shortest that was met") {
    held.meet(1.1e-4);
    CHECK(held.limit == 1.1e-4);
  }
  SECTION("it starts to wait again when it is met") {
    held.meet(1e-4);
    for (int s = 1; s < held.patience; ++s) held.meet(3e-4);
    CHECK(held.limit == 1e-4);
  }
}

TEST_CASE("substeps rise at once and fall after a while", "[scene][time_step]") {
  auto run = two_cubes(0);
  double const h = 3.5 * run.suggest_dt(1);
  auto const substeps = [&](std::int64_t env) {
    return run.state().get<environment::Substeps>(env);
  };
  run.step(h);
  CHECK(substeps(0) == 2);
  CHECK(substeps(1) == 4);
  run.set<NeoHookean>(1, lame(9e4, 0.3));
  run.step(h);
  CHECK(substeps(1) == 6);  // 3.5 sqrt(9/4)
  run.set<NeoHookean>(1, lame(4e4, 0.3));
  for (int s = 1; s < HeldLimit<double>::patience; ++s) run.step(h);
  CHECK(substeps(1) == 6);
  run.step(h);
  CHECK(substeps(1) == 5);  // a quarter longer
  for (int s = 0; s < HeldLimit<double>::patience; ++s) run.step(h);
  CHECK(substeps(1) == 4);
  CHECK(substeps(0) == 2);
  run.step(1e-3 * h);  // a short step does not shorten the substeps of the next one
  CHECK(substeps(1) == 1);
  run.step(h);
  CHECK(substeps(1) == 4);
}

// The cube was a hundred times as stiff for one step. It flies so fast since that speed binds, at half of what its waves allow.
TEST_CASE("what is held is let go of while speed is the bound", "[scene][time_step]") {
  auto run = two_cubes(0);
  double const h = run.suggest_dt(0);
  run.set<NeoHookean>(0, lame(1e6, 0.3));
  run.step(h);
  CHECK(run.state().get<environment::Substeps>(0) == 10);
  run.set<NeoHookean>(0, lame(1e4, 0.3));
  double const speed = 0.5 * dx * time_step_safety / (0.5 * h);
  for (int s = 0; s < 12 * HeldLimit<double>::patience; ++s) {
    move(run, 0, vec(speed, 0.0, 0.0), {});
    run.step(1e-3 * h);
  }
  move(run, 0, vec(speed, 0.0, 0.0), {});
  run.step(h);
  CHECK(limited_by(run, 0) == StepBound::speed);
  CHECK(run.state().get<environment::Substeps>(0) == 2);
}
