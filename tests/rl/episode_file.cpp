// Recorded episodes: what is written is what was seen, whole episodes only, and files that are none
// are refused.
#include "catch.hpp"

#include <fstream>

#include <mpmpbd/rl/episode_file.hpp>

#include "io/scratch.hpp"
#include "rl/carry_task.hpp"

#if defined(MPMPBD_HAS_HDF5)

using namespace mpmpbd;
using carry::CarryTask;
using carry::Ends;
using carry::Heights;
using Envs = rl::VectorEnv<CarryTask, Serial, float>;

namespace {

carry::Settings settings() {
  carry::Settings s;
  s.episode.limit = 5;
  s.episode.frames = 2;
  return s;
}
std::vector<float> actions(int decision) {
  std::vector<float> a;
  for (int k = 0; k < 6; ++k) a.push_back(0.1f * float((3 * decision + k) % 7) - 0.3f);
  return a;
}
void step(Envs& envs, rl::EpisodeWriter<Envs>& writer, int decision) {
  auto const a = actions(decision);
  writer.before_step(envs, a);
  envs.step(a);
  writer.after_step(envs);
}

}  // namespace

TEST_CASE("a recorded episode is what was seen, done and paid", "[rl][episode_file]") {
  ::Scratch const scratch;
  auto const path = scratch / "episodes.hdf5";
  std::vector<float> seen, paid;
  {
    Envs envs(settings(), {.num_envs = 2, .seed = 4});
    rl::EpisodeWriter<Envs> writer(path, envs, "carry");
    for (int i = 0; i < 7; ++i) {
      if (i < 5) {
        auto const now = envs.newest<Ends>(1);
        seen.insert(seen.end(), now.begin(), now.end());
      }
      step(envs, writer, i);
      if (i < 5) paid.push_back(envs.outcome().reward[1]);
    }
    CHECK(writer.episodes() == 2);  // the second ones have not ended
    CHECK_FALSE(std::filesystem::exists(path));
    writer.close();
  }
  io::Hdf5Reader const file(path);
  auto const one = rl::read_episode(file, 1, 3);
  CHECK(one.seed == 4);
  CHECK(one.environment == 1);
  CHECK(one.episode == 1);
  CHECK(one.rewards == paid);
  REQUIRE(one.actions.size() == 15);
  for (int i = 0; i < 5; ++i)
    for (int a = 0; a < 3; ++a)
      CHECK(one.actions[std::size_t(3 * i + a)] == actions(i)[std::size_t(3 + a)]);
  std::vector<hsize_t> shape;
  auto const demo = file.open("data").open("demo_1");
  CHECK(demo.open("obs").read<float>("ends", &shape) == seen);
  CHECK(shape == std::vector<hsize_t>{5, 9});  // the newest frame of each
  demo.open("obs").read<float>("heights", &shape);
  CHECK(shape == std::vector<hsize_t>{5, 13, 1});
  CHECK(demo.read<std::int64_t>("dones") == std::vector<std::int64_t>{0, 0, 0, 0, 1});
  CHECK(demo.integer("num_samples") == 5);
  CHECK(file.open("data").integer("total") == 10);
}

TEST_CASE("it can be seen again", "[rl][episode_file]") {
  ::Scratch const scratch;
  for (auto mode : {rl::Autoreset::same_step, rl::Autoreset::next_step, rl::Autoreset::disabled}) {
    auto const path = scratch / "episodes.hdf5";
    {
      Envs envs(settings(), {.num_envs = 2, .seed = 4, .autoreset = mode});
      rl::EpisodeWriter<Envs> writer(path, envs, "carry");
      for (int i = 0; i < 22; ++i) {
        step(envs, writer, i);
        if (mode == rl::Autoreset::disabled && i % 7 == 6) envs.reset();
        if (i == 12) envs.reset(std::vector<unsigned char>{1, 0});  // in the midst of an episode
      }
      writer.close();
    }
    io::Hdf5Reader const file(path);
    auto const total = file.open("data").integer("total");
    REQUIRE(total >= 30);
    CHECK(total % 5 == 0);  // whole episodes only
    for (std::int64_t k = 0; 5 * k < total; ++k) {
      auto const recorded = rl::read_episode(file, k, 3);
      Envs alone(settings(), {.num_envs = 1, .seed = recorded.seed});
      alone.start(0, recorded.episode, recorded.environment);
      for (std::size_t t = 0; t < recorded.rewards.size(); ++t)
        CHECK(alone.step(std::span(recorded.actions).subspan(3 * t, 3)).reward[0] ==
              recorded.rewards[t]);
    }
  }
}

TEST_CASE("an episode of a part of a larger set is seen again in any part", "[rl][episode_file]") {
  ::Scratch const scratch;
  auto const path = scratch / "episodes.hdf5";
  rl::VectorEnvOptions options{.num_envs = 2, .seed = 4, .first_environment = 3};
  {
    Envs envs(settings(), options);
    rl::EpisodeWriter<Envs> writer(path, envs, "carry");
    for (int i = 0; i < 10; ++i) step(envs, writer, i);
    writer.close();
  }
  io::Hdf5Reader const file(path);
  for (std::int64_t const first : {0, 3, 7}) {
    options.first_environment = first;
    Envs again(settings(), options);
    for (std::int64_t demo = 0; demo < 4; ++demo) {
      auto const recorded = rl::read_episode(file, demo, 3);
      CAPTURE(first, recorded.environment, recorded.episode);
      again.start(0, recorded.episode, recorded.environment);
      again.start(1, recorded.episode, recorded.environment);
      CHECK(again.stream(1) == recorded.environment);
      for (std::size_t t = 0; t < recorded.rewards.size(); ++t) {
        std::vector<float> both;
        for (std::size_t k = 0; k < 6; ++k) both.push_back(recorded.actions[3 * t + k % 3]);
        CHECK(again.step(both).reward == std::vector<float>(2, recorded.rewards[t]));
      }
    }
  }
}

TEST_CASE("files that are none are refused", "[rl][episode_file][errors]") {
  ::Scratch const scratch;
  auto const foreign = scratch / "foreign.hdf5";
  std::ofstream(foreign) << "no HDF5";
  CHECK_THROWS_WITH(io::Hdf5Reader(foreign),
                    Catch::Contains("foreign.hdf5") && Catch::Contains("is it an HDF5 file?"));
  CHECK_THROWS_WITH(io::Hdf5Reader(scratch / "none.hdf5"), Catch::Contains("none.hdf5"));
  Envs envs(settings(), {});
  CHECK_THROWS_WITH(rl::EpisodeWriter<Envs>(scratch / "nowhere/a.hdf5", envs, "carry"),
                    Catch::Contains("a folder that exists"));
  auto const empty = scratch / "empty.hdf5";
  rl::EpisodeWriter<Envs>(empty, envs, "carry").close();
  io::Hdf5Reader const file(empty);
  CHECK_THROWS_WITH(rl::read_episode(file, 0, 3), Catch::Contains("demo_0"));
}

#endif
