// Threads without tissue on an emulated device: what the host does, to the last bit, with every solver.
#include <functional>
#include <limits>
#include <utility>

#include "catch.hpp"
#include "cuda/compare.hpp"
#include "cuda/threads.hpp"

#include <mpmpbd/backend/cuda/simulation.cuh>

using namespace test;

namespace {
// With fewer than environments, each has a warp; else as many threads as beads, or as are allowed.
struct Multiprocessors {
  int const before = emulated::multiprocessors;
  explicit Multiprocessors(int count) { emulated::multiprocessors = count; }
  ~Multiprocessors() { emulated::multiprocessors = before; }
};
}  // namespace

TEMPLATE_TEST_CASE("threads alone move on a device as they do on the host", "[cuda][alone]",
                   catalog::Suture, Swept, Averaged, Framed) {
  auto host = with_arcs<Simulation<TestType, Serial, float>>(3);
  auto by_warps = with_arcs<Simulation<TestType, Cuda, float>>(3);
  Multiprocessors const enough(3);
  auto device = with_arcs<Simulation<TestType, Cuda, float>>(3);
  auto narrow = with_arcs<Simulation<TestType, Cuda, float>>(3, Cuda{.threads = 128});
  CHECK(device.execution() == "alone: threads without tissue need no grid");
  for (int s = 0; s < 6; ++s) {
    host.step(step);
    emulated::seed = 1;
    device.step(step);
    emulated::seed = 9;
    narrow.step(step);
    by_warps.step(step);
  }
  double const fallen = 0.5 * 9.81 * square(6 * step);
  for (std::int64_t env : {0, 1, 2}) {
    CAPTURE(env);
    CHECK(same_bits(read(host), env, read(device), env));
    CHECK(same_bits(read(host), env, read(narrow), env));
    CHECK(same_bits(read(host), env, read(by_warps), env));
    auto const start = with_arcs<Simulation<TestType, Serial, float>>(3);
    double const z = read(device).template get<bead::Position>(env, beads / 2)[2] -
                     read(start).template get<bead::Position>(env, beads / 2)[2];
    CHECK(z < -0.5 * fallen);
    CHECK(z > -1.5 * fallen);
  }
}

TEST_CASE("threads alone move on a device in double as they do on the host", "[cuda][alone]") {
  auto host = with_arcs<Simulation<catalog::Suture, Serial, double>>(1);
  auto device = with_arcs<Simulation<catalog::Suture, Cuda, double>>(1);
  for (int s = 0; s < 6; ++s) host.step(step), device.step(step);
  CHECK(same_bits(read(host), 0, read(device), 0));
}

// 1e-4 s is shorter in float than in double: its limit, were it one, would be exceeded.
TEST_CASE("nothing bounds the substeps of threads alone", "[cuda][alone][time_step]") {
  auto options = thread_options<catalog::Suture>(1);
  options.substeps = 0;
  Simulation<catalog::Suture, Serial, float> host(options);
  Simulation<catalog::Suture, Cuda, float> device(options);
  add_arc(host, 0), add_arc(device, 0);
  for (double const h :
       {1e-4, 1e-5, 2e-3}) {  // a short step does not shorten the substeps of the next one
    host.step(h), device.step(h);
    CHECK(read(host).get<environment::Substeps>(0) == 1);
  }
  CHECK(same_bits(read(host), 0, read(device), 0));
  // A state of before this was so.
  for (auto* state : {&host.state(), &device.state()})
    state->set<environment::HeldLimits>(0, {{1e-5f, 1e-5f}});
  host.step(2e-3), device.step(2e-3);
  CHECK(read(host).get<environment::Substeps>(0) == 1);
  CHECK(same_bits(read(host), 0, read(device), 0));
  options.strict = true;  // there is no limit to be kept
  CHECK_NOTHROW(Simulation<catalog::Suture, Cuda, float>(options));
}

TEST_CASE("a thread is the same alone and in company", "[cuda][alone]") {
  using Run = Simulation<catalog::Suture, Cuda, float>;
  auto many = with_arcs<Run>(5);
  Run one(thread_options<catalog::Suture>(1));
  add_arc(one, 0);
  one.restore([&] {
    auto store = read(one);
    store.copy_environment(0, read(many), 3);
    return store;
  }());
  for (int s = 0; s < 4; ++s) many.step(step), one.step(step);
  CHECK(same_bits(read(many), 3, read(one), 0));
}

TEST_CASE("a lost thread is frozen, and its neighbours do not notice", "[cuda][alone][status]") {
  using Run = Simulation<catalog::Suture, Cuda, float>;
  auto well = with_arcs<Run>(3), ill = with_arcs<Run>(3);
  float const nothing = std::numeric_limits<float>::quiet_NaN();
  ill.state().set<bead::Velocity>(1, 7, {{0.0f, nothing, 0.0f}});
  for (int s = 0; s < 3; ++s) well.step(step), ill.step(step);
  CHECK(has(ill.status(1), Fault::not_finite));
  CHECK(read(ill).get<environment::Step>(1) == 0);
  for (std::int64_t env : {0, 2}) CHECK(same_bits(read(well), env, read(ill), env));

  // What is lost during the step ends it there.
  ill.reset();
  auto host = with_arcs<Simulation<catalog::Suture, Serial, float>>(3);
  parameters_t<Gravity, float> const endless{{0.0f, 0.0f, std::numeric_limits<float>::infinity()}};
  ill.state().set_parameters<Gravity>(1, endless);
  host.state().set_parameters<Gravity>(1, endless);
  ill.step(step), host.step(step);
  CHECK(has(ill.status(1), Fault::not_finite));
  CHECK(ill.status(1) == host.status(1));
  CHECK(read(ill).get<environment::Step>(1) == 1);
  CHECK(read(host).get<environment::Step>(1) == 1);
}

TEMPLATE_TEST_CASE("masks choose which threads move and which return", "[cuda][alone][reset]",
                   float, double) {
  using Run = Simulation<catalog::Suture, Cuda, TestType>;
  auto run = with_arcs<Run>(3);
  auto const start = with_arcs<Run>(3);
  std::vector<unsigned char> const middle{0, 1, 0};
  run.step(step, middle);
  CHECK(same_bits(read(start), 0, read(run), 0));
  CHECK_FALSE(same_bits(read(start), 1, read(run), 1));

  run.step(step);
  for (std::int64_t env : {1, 2}) run.state().template table<Beads>().set_live(env, beads - 7);
  auto const moved = read(run);
  run.reset(middle);
  for (std::int64_t env : {0, 2}) CHECK(same_bits(moved, env, read(run), env));
  CHECK(read(run).template get<environment::Episode>(1) == 1);
  run.state().template set<environment::Episode>(1, 0);
  CHECK(same_bits(read(start), 1, read(run), 1));
  auto const& rods = read(run).template table<Beads>();
  CHECK(rods.live(0) == beads);
  CHECK(rods.live(1) == beads);
  CHECK(rods.live(2) == beads - 7);
}

TEST_CASE("a scene without a grid is not asked where its grid lies", "[cuda][alone]") {
  using Run = Simulation<catalog::Suture, Cuda, float>;
  CHECK_THROWS_WITH(
      Run(thread_options<catalog::Suture>(1), Cuda{.execution = Cuda::Execution::tiled}),
      Catch::Contains("threads alone. Take Cuda::Execution::automatic"));
}

// A null stream is another one on each device.
TEST_CASE("a run is waited for on its own device", "[cuda]") {
  using Run = Simulation<catalog::Suture, Cuda, float>;
  emulated::devices = 2;
  auto run = with_arcs<Run>(1, Cuda{.device = 1});
  run.step(step);
  for (auto const& wait : {std::function<void()>([&] { run.wait(); }),
                           std::function<void()>([&] { std::as_const(run).state(); })}) {
    emulated::waited_for = 0;
    wait();
    CHECK(emulated::waited_for == 1);
    CHECK(emulated::present_device == 0);
  }
  emulated::devices = 1;
}
