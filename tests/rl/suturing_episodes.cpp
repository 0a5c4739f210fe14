// Fifty stitches, begun side by side and one by one: the same bits, without an allocation, within
// their own episode.
// seconds: 60
// processors: 2
#include "catch.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include <mpmpbd/catalog/suturing_task.hpp>

#include "rl/suturing.hpp"
#include "support/counted_allocations.hpp"
#include "support/sanitized.hpp"

using namespace mpmpbd;

namespace {

template <class Backend> using Envs = rl::VectorEnv<rl::SuturingTask, Backend>;

// Episodes that begin above the surface and end in the tissue: each sees contact, a puncture and a
// channel.
rl::SuturingTaskConfig config() {
  return test::suturing_config(
      "coarse.toml", {"motion.approach_deg=10.0", "random.height_m=0.0", "random.shift_m=0.02",
                      "random.turn_deg=2.0", "episode.limit=12"});
}
// Turns every needle on, in one environment a little slower than in another.
template <class V> std::vector<float> turn(V const& envs) {
  std::vector<float> actions;
  for (std::int64_t e = 0; e < envs.num_envs(); ++e) {
    auto const number = envs.options().first_environment + e;
    for (float a : {0.0f, -0.05f, 1.0f - 0.01f * float(number)}) actions.push_back(a);
  }
  return actions;
}

// All that one environment shows and is paid in an episode.
using Record = std::vector<float>;
template <class V> void append(Record& record, V const& envs, std::int64_t env) {
  auto const& out = envs.outcome();
  auto const i = std::size_t(env);
  record.push_back(out.reward[i]);
  record.insert(record.end(), out.terms.begin() + std::ptrdiff_t(i * V::term_count),
                out.terms.begin() + std::ptrdiff_t((i + 1) * V::term_count));
  record.insert(record.end(), out.metrics.begin() + std::ptrdiff_t(i * V::metric_count),
                out.metrics.begin() + std::ptrdiff_t((i + 1) * V::metric_count));
  record.push_back(float(out.status[i]));
  for_each_type(typename V::Task::Observations{}, [&]<class Group>(std::type_identity<Group>) {
    // At the end of an episode the arrays show the next one.
    auto const all = out.done(env) ? envs.template final_observation<Group>()
                                   : envs.template observation<Group>();
    auto const n = std::int64_t(all.size()) / envs.num_envs();
    record.insert(record.end(), all.begin() + env * n, all.begin() + (env + 1) * n);
  });
}
bool same_bits(Record const& a, Record const& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

}  // namespace

TEST_CASE("fifty episodes are the same in a batch and alone", "[rl][suturing][determinism]") {
  constexpr std::int64_t batch = test::sanitized ? 3 : 5,
                         episodes = test::sanitized ? 2 : 10;  // of each environment
  auto const c = config();
  std::map<std::pair<std::int64_t, std::int64_t>, Record> together;
  {
    Envs<Threads> envs(c, {.num_envs = batch, .seed = 21}, Threads{2});
    auto const actions = turn(envs);
    std::vector<std::int64_t> now(std::size_t(batch), 0);
    auto all_done = [&] {  // some episodes end before their limit
      bool done = true;
      for (std::int64_t e = 0; e < batch; ++e) done = done && envs.episode(e) > episodes;
      return done;
    };
    while (!all_done()) {
      for (std::int64_t e = 0; e < batch; ++e) now[std::size_t(e)] = envs.episode(e);
      envs.step(actions);
      for (std::int64_t e = 0; e < batch; ++e) append(together[{e, now[std::size_t(e)]}], envs, e);
    }
  }
  int same = 0, went_in = 0;
  for (std::int64_t e = 0; e < batch; ++e) {
    Envs<Serial> alone(c, {.num_envs = 1, .seed = 21, .first_environment = e});
    auto const actions = turn(alone);
    for (std::int64_t k = episodes; k > 0; --k) {  // in another order, too
      alone.start(0, k);
      Record record;
      do {
        alone.step(actions);
        append(record, alone, 0);
      } while (!alone.outcome().done(0));
      same += same_bits(record, together[{e, k}]);
      went_in += alone.outcome().metrics[0] > 0.5f;
    }
  }
  CHECK(same == batch * episodes);
  CHECK(went_in > batch * episodes / 2);  // it is the whole scene that is compared
}

TEST_CASE("a needle on its way through tissue allocates nothing", "[rl][suturing][memory]") {
  auto c = config();
  c.episode.limit = 40;
  Envs<Serial> envs(c, {.num_envs = 1, .seed = 5, .autoreset = rl::Autoreset::disabled});
  auto const actions = turn(envs);
  envs.step(actions);
  std::int64_t const before = test::allocations;
  REQUIRE((before > 0) == test::counts_allocations);
  while (!envs.outcome().done(0)) envs.step(actions);
  CHECK(test::allocations == before);
  CHECK(envs.outcome().metrics[0] > 0.5f);  // it has gone in
}

TEST_CASE("what goes wrong in one environment is not noticed in another",
          "[rl][suturing][errors]") {
  auto const c = config();
  Envs<Threads> spoilt(c, {.num_envs = 2, .seed = 3}, Threads{2}),
      whole(c, {.num_envs = 2, .seed = 3});
  std::vector<float> actions = {0.1f, -0.5f, 0.2f, 0.1f, -0.5f, 0.2f};
  for (int i = 0; i < 3; ++i) {
    spoilt.step(actions);
    whole.step(actions);
  }
  auto wrong = actions;
  wrong[2] = std::numeric_limits<float>::quiet_NaN();
  spoilt.simulation().state().set<particle::Velocity>(
      0, 7, vec(std::numeric_limits<float>::infinity(), 0.0f, 0.0f));
  spoilt.step(actions);
  whole.step(actions);
  CHECK(spoilt.outcome().diverged[0]);
  CHECK(spoilt.outcome().terminated[0]);
  CHECK(spoilt.episode(0) == 2);
  Record a, b;
  append(a, spoilt, 1);
  append(b, whole, 1);
  CHECK(same_bits(a, b));
  spoilt.step(wrong);
  whole.step(actions);
  CHECK(spoilt.outcome().invalid_action[0]);
  CHECK(spoilt.outcome().truncated[0]);
  CHECK_FALSE(spoilt.outcome().invalid_action[1]);
  append(a, spoilt, 1);
  append(b, whole, 1);
  CHECK(same_bits(a, b));
  for (float x : spoilt.observation<rl::NeedlePose>()) CHECK(std::isfinite(x));
}
