// The step loop on an emulated device: it gives what the host's gives, episode by episode, and the same bits in any company.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <mpmpbd/rl/arrays.hpp>
#include <mpmpbd/rl/cuda/episodes.cuh>
#include <mpmpbd/rl/cuda/vector_env.hpp>

#include "catch.hpp"
#include "cuda/compare.hpp"
#include "cuda/fixed_point_noise.hpp"
#include "cuda/tilt_task.hpp"

using namespace mpmpbd;
using rl::Autoreset;
using tilt::Heights;
using tilt::Middle;
using tilt::TiltTask;

namespace {

using OnHost = rl::VectorEnv<TiltTask, Serial, float>;
using OnDevice = rl::VectorEnv<TiltTask, Cuda, float>;
constexpr Cuda small{.threads = 128};
constexpr float lost = std::numeric_limits<float>::quiet_NaN();

// Actions of one decision: what an environment does depends on its number in the larger set. 0 goes far, others less so.
std::vector<float> actions(auto const& envs, int decision) {
  std::vector<float> all;
  for (std::int64_t e = 0; e < envs.num_envs(); ++e) {
    auto const number = float(e + envs.options().first_environment);
    all.push_back(1.0f / (1.0f + number));
    all.push_back(0.3f * float(decision % 3) - 0.2f * number);
  }
  return all;
}

// Of velocities after some steps [m/s].
double rounding(tilt::Settings const& c, int steps) {
  return test::fixed_point_noise(c.cell, c.step / c.substeps, c.substeps * steps);
}
template <class Numbers> double difference(Numbers const& a, Numbers const& b) {
  mpmpbd::testing::Worst worst;
  if (a.size() != b.size()) worst.include(NAN);
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst.include(std::fabs(double(a[i]) - double(b[i])));
  return worst.value();
}
// Flags and counts are equal, numbers within rounding.
void check_same(OnDevice const& d, OnHost const& h) {
  auto const& c = h.config();
  int const steps = c.episode.decision_interval * c.episode.limit;  // of an episode
  double const v = rounding(c, steps), x = v * steps * c.step, paid = std::max(0.1 * v, x);
  auto const &a = d.outcome(), &b = h.outcome();
  CHECK(a.terminated == b.terminated);
  CHECK(a.truncated == b.truncated);
  CHECK(a.diverged == b.diverged);
  CHECK(a.invalid_action == b.invalid_action);
  CHECK(a.restarted == b.restarted);
  CHECK(a.episode_length == b.episode_length);
  CHECK(a.status == b.status);
  CHECK(difference(a.reward, b.reward) < 2 * paid);
  CHECK(difference(a.terms, b.terms) < paid);
  CHECK(difference(a.returns, b.returns) < c.episode.limit * paid);
  CHECK(difference(a.metrics, b.metrics) < x);
  CHECK(difference(d.observation<Middle>(), h.observation<Middle>()) < x);
  CHECK(difference(d.observation<Heights>(), h.observation<Heights>()) < x);
  CHECK(difference(d.final_observation<Middle>(), h.final_observation<Middle>()) < x);
  for (std::int64_t e = 0; e < h.num_envs(); ++e) {
    CHECK(d.episode(e) == h.episode(e));
    CHECK(d.decisions(e) == h.decisions(e));
    CHECK(d.waits(e) == h.waits(e));
    CHECK(d.stream(e) == h.stream(e));
  }
}

template <class Span> std::vector<float> row(Span const& all, std::int64_t env, std::int64_t of) {
  auto const n = std::ptrdiff_t(all.size()) / std::ptrdiff_t(of);
  return {all.begin() + env * n, all.begin() + (env + 1) * n};
}
// Everything that one environment shows and is paid, to be compared bit for bit.
std::vector<float> seen(OnDevice const& envs, std::int64_t env) {
  auto const& out = envs.outcome();
  std::int64_t const n = envs.num_envs();
  std::vector<float> all{float(out.terminated[std::size_t(env)]),
                         float(out.truncated[std::size_t(env)])};
  auto const append = [&](auto const& numbers) {
    auto const mine = row(numbers, env, n);
    all.insert(all.end(), mine.begin(), mine.end());
  };
  append(out.terms);
  append(out.returns);
  append(out.metrics);
  append(envs.observation<Middle>());
  append(envs.observation<Heights>());
  return all;
}
bool same_bits(std::vector<float> const& a, std::vector<float> const& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), 4 * a.size()) == 0;
}

}  // namespace

TEST_CASE("a step loop on a device is that of the host, however episodes end", "[cuda][rl]") {
  for (auto how : {Autoreset::same_step, Autoreset::next_step, Autoreset::disabled}) {
    CAPTURE(int(how));
    rl::VectorEnvOptions const options{.num_envs = 3, .seed = 7, .autoreset = how};
    OnHost host({}, options);
    OnDevice device({}, options, small);
    check_same(device, host);
    int terminated = 0, truncated = 0, invalid = 0;
    for (int i = 0; i < 7; ++i) {
      CAPTURE(i);
      auto act = actions(host, i);
      if (i == 1) act[3] = lost;
      device.step(act);
      auto const& out = host.step(act);
      check_same(device, host);
      terminated += out.terminated[0];
      truncated += out.truncated[2];
      invalid += out.invalid_action[1];
    }
    CHECK(terminated > 0);
    CHECK(truncated > 0);
    CHECK(invalid == 1);
  }
}

TEST_CASE("episodes begin on a device as they do on the host", "[cuda][rl]") {
  rl::VectorEnvOptions const options{.num_envs = 3, .seed = 7, .first_environment = 4};
  OnHost host({}, options);
  OnDevice device({}, options, small);
  auto const both = [&](auto const& act) {
    act(host);
    act(device);
    check_same(device, host);
  };
  auto const goal = [&](std::int64_t env) { return device.newest<Middle>(env)[3]; };
  both([](auto& envs) { envs.step(actions(envs, 0)); });
  float const first = goal(0), second = goal(1);
  CHECK(first != second);
  both([](auto& envs) { envs.reset(std::vector<unsigned char>{0, 1, 0}); });
  CHECK(goal(0) == first);
  CHECK(goal(1) != second);
  CHECK(device.episode(1) == 2);
  CHECK(device.decisions(0) == 1);
  CHECK(device.decisions(1) == 0);
  both([](auto& envs) { envs.start(2, 5); });
  CHECK(device.episode(2) == 5);
  float const fifth = goal(2);
  both([](auto& envs) { envs.start(0, 5, 6); });
  CHECK(goal(0) == fifth);
  CHECK(device.stream(0) == 6);
  both([](auto& envs) { envs.reset(); });
  CHECK(device.episode(2) == 6);
  both([](auto& envs) { envs.reset(std::int64_t{8}); });
  CHECK(goal(0) != first);
  both([](auto& envs) { envs.reset(std::int64_t{7}); });
  CHECK(goal(0) == first);
  CHECK(device.options().seed == 7);
  both([](auto& envs) { envs.step(actions(envs, 1)); });
}

TEST_CASE("an environment of a step loop on a device does not know the others",
          "[cuda][rl][batch]") {
  emulated::seed = 1;
  OnDevice four({}, {.num_envs = 4, .seed = 3}, small);
  emulated::seed = 5;
  OnDevice alone({}, {.num_envs = 1, .seed = 3, .first_environment = 3}, Cuda{.threads = 160});
  // Whose steps are launches of their own.
  OnDevice apart({}, {.num_envs = 1, .seed = 3, .first_environment = 3},
                 Cuda{.execution = Cuda::Execution::tiled});
  bool same = same_bits(seen(four, 3), seen(alone, 0));
  for (int i = 0; i < 6; ++i) {
    auto act = actions(four, i);
    if (i == 2) act[2] = 2.0f;  // another one's mistake
    emulated::seed = 1;
    four.step(act);
    emulated::seed = 9;
    alone.step(actions(alone, i));
    apart.step(actions(apart, i));
    same = same && same_bits(seen(four, 3), seen(alone, 0)) &&
           same_bits(seen(four, 3), seen(apart, 0));
  }
  CHECK(same);
  CHECK(four.episode(3) == 2);  // beyond the end of an episode
  CHECK_FALSE(same_bits(seen(four, 2), seen(alone, 0)));
  auto const &a = std::as_const(four).simulation().state(),
             &b = std::as_const(alone).simulation().state();
  CHECK(test::same_bits(a, 3, b, 0));

  // An episode of it again, in another's place.
  four.start(0, 5, 3);
  alone.start(0, 5);
  bool again = true;
  for (int i = 0; i < 3; ++i) {
    auto const own = actions(alone, i);
    auto act = actions(four, i);
    std::copy(own.begin(), own.end(), act.begin());
    four.step(act);
    alone.step(own);
    again = again && same_bits(seen(four, 0), seen(alone, 0));
  }
  CHECK(again);
}

TEST_CASE("a decision on a device copies nothing, takes no memory and waits for nothing",
          "[cuda][rl][resources]") {
  OnDevice envs({}, {.num_envs = 2}, small), other({}, {.num_envs = 2}, small);
  auto const act = actions(envs, 1);
  std::copy(act.begin(), act.end(), envs.actions());  // an emulated device shares the host's memory
  other.step(act);
  int const launches = emulated::launches, allocations = emulated::allocations,
            copies = emulated::copies, waits = emulated::waits;
  envs.step_from(envs.actions());
  CHECK(emulated::launches == launches + 3);  // what begins it, its steps, what ends it
  envs.reset_where(nullptr);
  CHECK(emulated::launches == launches + 4);
  CHECK(emulated::allocations == allocations);
  CHECK(emulated::copies == copies);
  CHECK(emulated::waits == waits);

  envs.start(0, 1);
  envs.start(1, 1);
  envs.step_from(envs.actions());
  CHECK(same_bits(seen(envs, 1), seen(other, 1)));
  CHECK(emulated::copies > copies);
}

TEST_CASE("a decision or a reset whose launch is refused is not taken for one",
          "[cuda][rl][errors]") {
  OnDevice envs({}, {.num_envs = 2, .seed = 5}, small),
      other({}, {.num_envs = 2, .seed = 5}, small);
  auto const act = actions(envs, 1);
  envs.step(act);
  for (int launch : {2, 3}) {  // the steps, what ends them
    emulated::refused_launch = emulated::launches + launch;
    CHECK_THROWS_WITH(envs.step(act), Catch::Contains("launching"));
    CHECK(envs.outcome().reward[0] ==
          envs.arrays().reward[0]);  // an emulated device shares the host's memory
  }
  emulated::refused_launch = emulated::launches + 1;
  CHECK_THROWS_WITH(envs.reset(7), Catch::Contains("launching"));
  for (auto* loop : {&envs, &other}) {
    loop->start(0, 2);
    loop->start(1, 2);
    loop->step(act);
  }
  for (int env : {0, 1}) CHECK(same_bits(seen(envs, env), seen(other, env)));
}

TEST_CASE("what a step loop shows and pays lies on the device", "[cuda][rl][arrays]") {
  OnDevice envs({}, {.num_envs = 2}, small);
  auto const middle = envs.array<Middle>();
  auto const heights = envs.array<Heights>();
  auto const shape = [](Array const& a) { return std::vector(a.shape, a.shape + a.axes); };
  CHECK(shape(middle) == std::vector<std::int64_t>{2, 2, 4});
  CHECK(shape(heights) == std::vector<std::int64_t>{2, 2, 144, 1});
  CHECK(middle.place.memory == MemorySpace::cuda);
  CHECK_THROWS_AS(middle.as<double>(), std::invalid_argument);
  CHECK(envs.arrays().term_count == 2);
  auto const* reward = envs.arrays().reward;
  envs.step(actions(envs, 0));
  auto const shown = envs.observation<Middle>();
  CHECK(std::equal(shown.begin(), shown.end(), middle.as<float const>()));
  CHECK(reward[1] == envs.outcome().reward[1]);
  CHECK(reward[1] != 0.0f);
  CHECK(envs.metric<tilt::Reached>(0) == envs.arrays().metrics[0]);
  auto const before = row(shown, 1, 4);  // newest frame of environment 0
  envs.step(actions(envs, 1));
  CHECK(row(envs.observation<Middle>(), 0, 4) == before);  // which has moved up
}

TEST_CASE("arrays by name are those on the device", "[cuda][rl][arrays]") {
  OnDevice envs({}, {.num_envs = 2}, small);
  auto const named = [](std::vector<NamedArray> const& all, std::string_view name) {
    for (NamedArray const& one : all)
      if (one.name == name) return one.array;
    return Array{};
  };
  auto const seen = named(rl::observation_arrays(envs), Middle::name.view());
  auto const last = named(rl::final_observation_arrays(envs), Middle::name.view());
  auto const paid = named(rl::outcome_arrays(envs), "reward");
  CHECK(seen.data == envs.array<Middle>().data);
  CHECK(last.data == envs.final_array<Middle>().data);
  CHECK(paid.data == envs.arrays().reward);
  CHECK(paid.shape[0] == 2);
  for (Array const& one : {seen, last, paid}) {
    CHECK(one.place.memory == MemorySpace::cuda);
    CHECK_FALSE(one.read_only);
  }
}

TEST_CASE("what ended on a device is begun anew from a mask that lies there", "[cuda][rl]") {
  tilt::Settings c;
  c.episode.limit = 2;
  OnDevice envs(c, {.num_envs = 2, .autoreset = Autoreset::disabled}, small);
  envs.step(actions(envs, 0));
  envs.start(0, 4);
  envs.step(actions(envs, 1));
  REQUIRE(envs.outcome().truncated == std::vector<unsigned char>{0, 1});
  CHECK(envs.waits(1));
  auto const kept = envs.newest<Middle>(0)[0];
  envs.reset_where(envs.arrays().truncated);
  CHECK(envs.episode(0) == 4);
  CHECK(envs.newest<Middle>(0)[0] == kept);
  CHECK(envs.episode(1) == 2);
  CHECK_FALSE(envs.waits(1));
  CHECK(envs.outcome().truncated[1] == 0);
}

TEST_CASE("an environment whose numbers are lost on a device is started anew",
          "[cuda][rl][errors]") {
  OnDevice envs({}, {.num_envs = 2}, small), other({}, {.num_envs = 2}, small);
  envs.simulation().state().set<particle::Velocity>(0, 3, vec(lost, lost, lost));
  auto const& out = envs.step(actions(envs, 0));
  CHECK(out.diverged == std::vector<unsigned char>{1, 0});
  CHECK(out.terminated[0] == 1);
  CHECK(out.reward[0] == 0);
  CHECK((out.status[0] & rl::fatal_faults) != 0);
  CHECK(envs.episode(0) == 2);
  CHECK(std::as_const(envs).simulation().status(0) == 0);
  for (float x : envs.final_observation<Middle>()) CHECK(std::isfinite(x));
  other.step(actions(envs, 0));
  for (int i = 1; i < 3; ++i) {
    envs.step(actions(envs, i));
    other.step(actions(other, i));
  }
  CHECK(same_bits(seen(envs, 1), seen(other, 1)));
}

TEST_CASE("a step loop on a device refuses what the host's refuses", "[cuda][rl][errors]") {
  OnDevice envs({}, {.num_envs = 2}, small);
  CHECK_THROWS_WITH(envs.step(std::vector<float>(5)), Catch::Contains("5 actions given"));
  CHECK_THROWS_WITH(envs.reset(std::vector<unsigned char>(3)),
                    Catch::Contains("a mask of 3 entries given"));
  CHECK_THROWS_WITH(envs.start(2, 1), Catch::Contains("environments 0 to 1"));
  CHECK(envs.decisions(0) == 0);
  CHECK_THROWS_WITH(OnDevice({}, {.num_envs = 0}, small), Catch::Contains("num_envs = 0"));
  CHECK_THROWS_WITH(OnDevice({}, {}, Cuda{.device = 3}), Catch::Contains("device 3"));
}
