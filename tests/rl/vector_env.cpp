// The step loop, on a task that costs little: shapes, ends of episodes, and that environments do
// not know each other.
// seconds: 5
#include "catch.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/rl/arrays.hpp>

#include "rl/carry_task.hpp"
#include "support/counted_allocations.hpp"

using namespace mpmpbd;
using carry::CarryTask;
using carry::Ends;
using carry::Heights;
using rl::Autoreset;

namespace {

using Envs = rl::VectorEnv<CarryTask, Serial, float>;

// Actions that depend on what is seen, differ between environments and are legal.
template <class V> std::vector<float> wander(V const& envs) {
  auto const ends = envs.template observation<Ends>();
  std::size_t const row = ends.size() / std::size_t(envs.num_envs());
  std::vector<float> actions;
  for (std::int64_t e = 0; e < envs.num_envs(); ++e) {
    auto const* newest = ends.data() + (std::size_t(e) + 1) * row - Ends::size;
    for (int a = 0; a < 3; ++a)
      actions.push_back(std::clamp(4 * (newest[6 + a] - newest[3 + a]), -1.0f, 1.0f));
  }
  return actions;
}

// What one environment shows and is paid over many decisions.
struct Record {
  std::vector<float> numbers;
  template <class V> void take(V const& envs, std::int64_t env) {
    auto const& out = envs.outcome();
    auto const i = std::size_t(env);
    numbers.push_back(out.reward[i]);
    numbers.push_back(float(out.terminated[i] + 2 * out.truncated[i]));
    append(envs.template observation<Ends>(), envs, i);
    append(envs.template observation<Heights>(), envs, i);
  }
  template <class Span, class V> void append(Span const& all, V const& envs, std::size_t i) {
    std::size_t const n = all.size() / std::size_t(envs.num_envs());
    numbers.insert(numbers.end(), all.begin() + std::ptrdiff_t(i * n),
                   all.begin() + std::ptrdiff_t((i + 1) * n));
  }
  bool operator==(Record const& other) const {
    return numbers.size() == other.numbers.size() &&
           std::memcmp(numbers.data(), other.numbers.data(), numbers.size() * sizeof(float)) == 0;
  }
};
template <class V> Record run(V& envs, std::int64_t env, int decisions) {
  Record record;
  for (int i = 0; i < decisions; ++i) {
    envs.step(wander(envs));
    record.take(envs, env);
  }
  return record;
}

carry::Settings settings() { return {}; }

}  // namespace

TEST_CASE("arrays have the shapes that they say", "[rl][vector_env]") {
  auto c = settings();
  c.episode.frames = 3;
  Envs envs(c, {.num_envs = 4});
  CHECK(envs.observation<Ends>().size() == 4 * 3 * 9);
  CHECK(envs.observation<Heights>().size() == 4 * 3 * 13);
  CHECK(envs.shape<Heights>() == std::vector<std::int64_t>{13, 1});
  CHECK(Envs::action_size == 3);
  CHECK(Envs::term_names()[0] == "distance");
  auto const& out = envs.step(std::vector<float>(12, 0.0f));
  CHECK(out.reward.size() == 4);
  CHECK(out.terms.size() == 4);
  CHECK(out.terminated.size() == 4);
  CHECK(out.episode_length == std::vector<std::int32_t>(4, 1));
}

TEST_CASE("arrays by name show every step where they lie", "[rl][vector_env][arrays]") {
  auto c = settings();
  c.episode.frames = 2;
  Envs envs(c, {.num_envs = 3});
  auto const seen = rl::observation_arrays(envs);
  auto const paid = rl::outcome_arrays(envs);
  REQUIRE(seen.size() == 2);
  CHECK(seen[1].name == "heights");
  CHECK(std::vector<std::int64_t>(seen[1].array.shape, seen[1].array.shape + seen[1].array.axes) ==
        std::vector<std::int64_t>{3, 2, 13, 1});
  CHECK(paid[0].name == "reward");
  CHECK(paid[1].array.element == element_type<bool>);
  CHECK(paid[1].array.as<unsigned char>() == envs.outcome().terminated.data());
  CHECK(paid[6].array.element == element_type<std::int32_t>);
  CHECK(paid[9].array.size() == 3 * Envs::term_count);
  for (int step = 0; step < 3; ++step) {
    auto const& out = envs.step(wander(envs));
    CHECK(seen[0].array.data == envs.observation<Ends>().data());
    for (std::size_t e = 0; e < 3; ++e) {
      CHECK(static_cast<float const*>(paid[0].array.data)[e] == out.reward[e]);
      CHECK(static_cast<float const*>(paid[9].array.data)[e] == out.returns[e]);
    }
  }
  CHECK(rl::final_observation_arrays(envs)[0].array.data == envs.final_observation<Ends>().data());
}

TEST_CASE("frames are the present observation and those before it", "[rl][vector_env]") {
  auto c = settings();
  c.episode.frames = 3;
  Envs envs(c, {.num_envs = 2});
  auto const frame = [&](std::int64_t env, int f) {
    auto const* x = envs.observation<Ends>().data() + (env * 3 + f) * Ends::size;
    return std::vector<float>(x, x + Ends::size);
  };
  CHECK(frame(1, 0) == frame(1, 2));  // at the start all show the same
  auto const first = frame(1, 2);
  envs.step(wander(envs));
  auto const second = frame(1, 2);
  CHECK(second != first);
  CHECK(frame(1, 1) == first);
  envs.step(wander(envs));
  CHECK(frame(1, 0) == first);
  CHECK(frame(1, 1) == second);
}

TEST_CASE("an environment does not know how many others there are", "[rl][vector_env]") {
  Envs five(settings(), {.num_envs = 5, .seed = 3});
  Envs alone(settings(), {.num_envs = 1, .seed = 3, .first_environment = 2});
  CHECK(run(five, 2, 150) == run(alone, 0, 150));
}

TEST_CASE("threads do not change a bit", "[rl][vector_env]") {
  Envs serial(settings(), {.num_envs = 5});
  rl::VectorEnv<CarryTask, Threads, float> threads(settings(), {.num_envs = 5}, Threads{3});
  CHECK(run(serial, 4, 150) == run(threads, 4, 150));
}

TEST_CASE("an episode is the same alone and after others", "[rl][vector_env]") {
  Envs many(settings(), {.num_envs = 2});
  std::vector<Record> episodes(1);
  while (episodes.size() < 52) {
    many.step(wander(many));
    episodes.back().take(many, 1);
    if (many.outcome().done(1)) episodes.emplace_back();
  }
  int same = 0;
  for (int k = 0; k < 51; ++k) {
    Envs alone(settings(), {.num_envs = 1, .first_environment = 1});
    alone.start(0, 1 + k);
    // The last record shows the first observation of the next episode, which comes by itself here too.
    int const decisions = int(episodes[std::size_t(k)].numbers.size() / (2 + 9 + 13));
    same += run(alone, 0, decisions) == episodes[std::size_t(k)];
  }
  CHECK(same == 51);
}

TEST_CASE("episodes differ, seeds differ, the same seed does not", "[rl][vector_env]") {
  Envs envs(settings(), {.num_envs = 2, .seed = 5});
  auto const goal = [&](std::int64_t env) {
    return envs.observation<Ends>()[std::size_t(env) * 9 + 6];
  };
  float const first = goal(0);
  CHECK(goal(1) != first);
  CHECK(envs.episode(0) == 1);
  envs.reset();
  CHECK(envs.episode(0) == 2);
  CHECK(goal(0) != first);
  envs.reset(std::int64_t{5});
  CHECK(goal(0) == first);
  envs.reset(std::int64_t{6});
  CHECK(goal(0) != first);
}

TEST_CASE("an episode that was asked for has its own numbers from the start", "[rl][vector_env]") {
  Envs envs(settings(), {.num_envs = 2, .seed = 5});
  auto const terms = std::size_t{Envs::term_count}, metrics = std::size_t{Envs::metric_count};
  std::vector<float> const at_start(envs.outcome().metrics.begin(),
                                    envs.outcome().metrics.begin() + std::ptrdiff_t(metrics));
  for (int i = 0; i < 5; ++i) envs.step(wander(envs));
  auto const before = envs.outcome();
  CHECK(before.episode_length == std::vector<std::int32_t>(2, 5));
  auto const paid = [&](std::size_t env) {
    auto const first = envs.outcome().returns.begin() + std::ptrdiff_t(env * terms);
    return std::any_of(first, first + std::ptrdiff_t(terms), [](float r) { return r != 0; });
  };
  CHECK(paid(0));
  envs.reset(std::vector<unsigned char>{1, 0});
  CHECK(envs.outcome().episode_length == std::vector<std::int32_t>{0, 5});
  CHECK_FALSE(paid(0));
  CHECK(paid(1));
  CHECK(envs.outcome().reward[1] == before.reward[1]);
  envs.start(0, 1);
  CHECK(std::equal(at_start.begin(), at_start.end(), envs.outcome().metrics.begin()));
}

TEST_CASE("an episode can be that of another environment", "[rl][vector_env]") {
  Envs envs(settings(), {.num_envs = 3, .seed = 5}), alone(settings(), {.num_envs = 1, .seed = 5});
  envs.start(2, 7);
  alone.start(0, 7, 2);
  CHECK(alone.stream(0) == 2);
  CHECK(alone.episode(0) == 7);
  int const decisions = 20;
  CHECK(run(envs, 2, decisions) == run(alone, 0, decisions));
  CHECK_THROWS_WITH(envs.start(0, 0), Catch::Contains("counted from 1"));
  CHECK_THROWS_WITH(envs.start(3, 1), Catch::Contains("environments 0 to 2"));
  CHECK_THROWS_WITH(envs.start(0, 1, -1), Catch::Contains("`as` from 0"));
}

TEST_CASE("frames of an ended episode are all kept", "[rl][vector_env][autoreset]") {
  auto c = settings();
  c.episode.limit = 3;
  c.episode.frames = 2;
  Envs envs(c, {.num_envs = 2});
  std::vector<float> const still(6, 0.1f);
  envs.step(still);
  envs.step(still);
  auto const before = envs.newest<Ends>(1);
  std::vector<float> const second(before.begin(), before.end());
  envs.step(still);
  REQUIRE(envs.outcome().done(1));
  auto const last = envs.final_observation<Ends>().subspan(2 * 9, 2 * 9);
  CHECK(std::equal(second.begin(), second.end(), last.begin()));
  CHECK_FALSE(std::equal(second.begin(), second.end(), last.begin() + 9));
}

TEST_CASE("a mask starts some environments anew and leaves the others", "[rl][vector_env]") {
  Envs envs(settings(), {.num_envs = 3}), other(settings(), {.num_envs = 3});
  run(envs, 0, 5);
  run(other, 0, 5);
  envs.reset(std::vector<unsigned char>{0, 1, 0});
  CHECK(envs.episode(1) == 2);
  CHECK(envs.episode(0) == 1);
  CHECK(run(envs, 2, 50) == run(other, 2, 50));
  CHECK_THROWS_WITH(envs.reset(std::vector<unsigned char>{1}),
                    Catch::Contains("a mask of 1 entries given") && Catch::Contains("3"));
}

TEST_CASE("an episode that ends begins anew in the same step", "[rl][vector_env][autoreset]") {
  auto c = settings();
  c.episode.limit = 4;
  Envs envs(c, {.num_envs = 1});
  std::vector<float> const still(3, 0.0f);
  for (int i = 0; i < 3; ++i) CHECK_FALSE(envs.step(still).done(0));
  auto const& out = envs.step(still);
  CHECK(out.truncated[0] == 1);
  CHECK(out.terminated[0] == 0);
  CHECK(out.episode_length[0] == 4);
  CHECK(out.reward[0] < 0);
  CHECK(envs.episode(0) == 2);
  auto const last = envs.final_observation<Ends>();
  auto const now = envs.observation<Ends>();
  CHECK(last[6] != now[6]);  // another goal
  CHECK(out.terms[0] == out.reward[0]);
  CHECK(out.returns[0] < 3 * out.reward[0]);  // a sum over four decisions
  double square = 0;
  for (int a = 0; a < 3; ++a) square += std::pow(double(last[3 + a]) - double(last[6 + a]), 2);
  CHECK(std::abs(double(out.reward[0]) + std::sqrt(square)) < 1e-6);
}

TEST_CASE("or in the next step, which pays nothing", "[rl][vector_env][autoreset]") {
  auto c = settings();
  c.episode.limit = 2;
  Envs envs(c, {.num_envs = 1, .autoreset = Autoreset::next_step});
  std::vector<float> const still(3, 0.0f);
  envs.step(still);
  CHECK(envs.step(still).done(0));
  CHECK(envs.episode(0) == 1);
  auto const& out = envs.step(still);
  CHECK(out.restarted[0] == 1);
  CHECK(out.reward[0] == 0);
  CHECK_FALSE(out.done(0));
  CHECK(envs.episode(0) == 2);
  CHECK(out.episode_length[0] == 0);
}

TEST_CASE("or when it is told to", "[rl][vector_env][autoreset]") {
  auto c = settings();
  c.episode.limit = 2;
  Envs envs(c, {.num_envs = 2, .autoreset = Autoreset::disabled});
  std::vector<float> const still(6, 0.0f);
  envs.step(still);
  CHECK(envs.step(still).done(1));
  auto const seen = envs.observation<Ends>()[3];
  auto const& out = envs.step(still);
  CHECK_FALSE(out.done(1));
  CHECK(out.reward[1] == 0);
  CHECK(envs.observation<Ends>()[3] == seen);  // it stands still
  CHECK(out.episode_length[1] == 2);
  envs.reset(std::vector<unsigned char>{0, 1});
  envs.step(still);
  CHECK(envs.outcome().episode_length[1] == 1);
  CHECK(envs.outcome().episode_length[0] == 2);
}

TEST_CASE("a wrong number of actions is refused and nothing happens", "[rl][vector_env][errors]") {
  Envs envs(settings(), {.num_envs = 2}), other(settings(), {.num_envs = 2});
  CHECK_THROWS_WITH(envs.step(std::vector<float>(5, 0.0f)), Catch::Contains("5 actions given") &&
                                                                Catch::Contains("2 environments") &&
                                                                Catch::Contains("3 each"));
  CHECK(run(envs, 1, 20) == run(other, 1, 20));
  CHECK_THROWS_WITH(Envs(settings(), {.num_envs = 0}), Catch::Contains("num_envs = 0"));
  auto c = settings();
  c.episode.frames = 0;
  CHECK_THROWS_WITH(Envs(c, {}), Catch::Contains("frames = 0 is not allowed"));
}

TEST_CASE("an action that is no number ends its own episode only", "[rl][vector_env][errors]") {
  for (float bad : {std::numeric_limits<float>::quiet_NaN(), 1.5f, -1.001f,
                    std::numeric_limits<float>::infinity()}) {
    Envs envs(settings(), {.num_envs = 3}), other(settings(), {.num_envs = 3});
    run(envs, 0, 3);
    run(other, 0, 3);
    auto actions = wander(envs);
    actions[4] = bad;
    auto const& out = envs.step(actions);
    CHECK(out.invalid_action == std::vector<unsigned char>{0, 1, 0});
    CHECK(out.truncated[1] == 1);
    CHECK(out.reward[1] == 0);
    CHECK(envs.episode(1) == 2);
    CHECK(std::isfinite(envs.observation<Ends>()[12]));
    other.step(wander(other));
    CHECK(run(envs, 2, 20) == run(other, 2, 20));
    CHECK(run(envs, 0, 20) == run(other, 0, 20));
  }
}

TEST_CASE("an environment whose numbers are lost is started anew", "[rl][vector_env][errors]") {
  Envs envs(settings(), {.num_envs = 2}), other(settings(), {.num_envs = 2});
  auto& state = envs.simulation().state();
  state.set<bead::Position>(0, 3, vec(NAN, NAN, NAN));
  auto const& out = envs.step(wander(envs));
  CHECK(out.diverged == std::vector<unsigned char>{1, 0});
  CHECK(out.terminated[0] == 1);
  CHECK((out.status[0] & rl::fatal_faults) != 0);
  CHECK(out.reward[0] == 0);
  for (float x : envs.final_observation<Heights>()) CHECK(std::isfinite(x));
  CHECK(envs.simulation().status(0) == 0);
  other.step(wander(other));
  CHECK(run(envs, 1, 20) == run(other, 1, 20));
}

TEST_CASE("a step allocates nothing", "[rl][vector_env][memory]") {
  auto c = settings();
  c.episode.frames = 3;
  std::vector<float> const actions(9, 0.5f);
  auto check = [&](auto& envs) {
    envs.step(actions);
    std::int64_t const before = test::allocations;
    REQUIRE((before > 0) == test::counts_allocations);
    int ended = 0;
    for (int i = 0; i < 200; ++i) {
      envs.step(actions);
      ended += envs.outcome().done(0);
    }
    CHECK(test::allocations == before);
    CHECK(ended > 1);  // starting anew is part of it
  };
  Envs serial(c, {.num_envs = 3});
  check(serial);
  rl::VectorEnv<CarryTask, Threads, double> threads(c, {.num_envs = 3}, Threads{2});
  check(threads);
}
