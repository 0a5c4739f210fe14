// The code of docs/concepts/device.md, on an emulated device.
#include <mpmpbd/backend/cuda.hpp>
#include <mpmpbd/catalog/suturing.hpp>
#include <mpmpbd/rl/cuda/episodes.cuh>
#include <mpmpbd/rl/cuda/vector_env.hpp>
#include <mpmpbd/rl/suturing/task.hpp>

#include "catch.hpp"
#include "cuda/suturing.hpp"
#include "shown.hpp"

using namespace mpmpbd;

TEST_CASE("the page of devices shows code that runs", "[cuda][docs]") {
  auto const config = test::config();
  using Run = Simulation<Suturing, Cuda, float>;
  Run run(suturing::options(config, 2));
  for (std::int64_t env = 0; env < 2; ++env) suturing::set_up(run, env, config);
  run.remember();
  run.step(config.time.step);
  run.reset(std::vector<unsigned char>{0, 1});

  CHECK(run.status(0) == 0);
  auto const& state = std::as_const(run).state();
  CHECK(state.get<environment::Step>(0) == config.time.substeps);
  CHECK(state.get<environment::Step>(1) == 0);
}

TEST_CASE("the page of devices shows a step loop that runs", "[cuda][docs][rl]") {
  rl::SuturingTaskConfig task;
  task.scene = test::config();
  task.episode.decision_interval = 1;
  int asked = 0;
  auto const policy = [&](float const* pose, float* actions) {
    asked += pose != nullptr;
    for (int a = 0; a < 6; ++a)
      actions[a] = a < 3 ? 0.25f : -0.25f;  // the emulated device's memory
  };
  rl::VectorEnv<rl::SuturingTask, Cuda> envs(task, {.num_envs = 2, .seed = 42});
  auto const pose = envs.array<rl::NeedlePose>();  // (num_envs, frames, 7), on the device
  policy(pose.as<float const>(), envs.actions());  // a kernel of yours, in the same stream
  envs.step_from(envs.actions());                  // copies nothing, waits for nothing
  float const* reward = envs.arrays().reward;      // (num_envs)
  auto const& out = envs.outcome();                // fetched: the words of the host

  CHECK(asked == 1);
  CHECK(out.reward[1] == reward[1]);
  CHECK(out.episode_length == std::vector<std::int32_t>{1, 1});
  CHECK(envs.newest<rl::NeedleTwist>(0)[0] > 0.0f);  // 0.25 of the hand's speed, and the other back
  CHECK(envs.newest<rl::NeedleTwist>(1)[0] < 0.0f);
}

TEST_CASE("the page of devices shows no other code", "[docs]") {
  CHECK(blocks_not_in(__FILE__, "concepts/device.md") == std::vector<std::string>{});
}
