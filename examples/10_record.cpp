// 10. Episodes to keep: the expert's are recorded, read back, and seen again, bit for bit.
//
// The file has the layout of robomimic, so tools for imitation learning read it;
// python/read_episodes.py does in 20 lines.
// test: --num-envs 2 --episodes 2 --set episode.limit=4
#include "task_options.hpp"

#include <mpmpbd/rl/episode_file.hpp>
#include <mpmpbd/rl/suturing/expert.hpp>

using namespace mpmpbd;
using Envs = rl::VectorEnv<rl::SuturingTask, Threads>;

namespace {

#if defined(MPMPBD_HAS_HDF5)

void record(course::TaskOptions const& run, course::Path const& file) {
  Envs envs(run.config, run.envs(), run.threads);
  rl::SuturingExperts experts(envs);
  rl::EpisodeWriter<Envs> writer(file, envs, "mpmpbd suturing");
  course::EpisodeQueue queue(run.episodes);
  io::Progress progress(run.episodes, "recording", "episodes");
  for (queue.refill(envs); !queue.done(); queue.refill(envs)) {
    auto const actions = experts.act(envs);
    writer.before_step(envs, actions);
    envs.step(actions);
    writer.after_step(envs);
    progress.update(queue.finished());
  }
  writer.close();
}

// Whether an environment alone, given the same actions, pays the same rewards.
bool same_again(Envs& alone, rl::RecordedEpisode const& recorded) {
  alone.start(0, recorded.episode, recorded.environment);
  bool same = true;
  std::span<float const> const actions(recorded.actions);
  for (std::size_t t = 0; t < recorded.rewards.size(); ++t) {
    auto const& out = alone.step(actions.subspan(t * Envs::action_size, Envs::action_size));
    same = same && out.reward[0] == recorded.rewards[t];
  }
  return same && alone.outcome().done(0);
}

bool record_and_replay(course::TaskOptions const& run) {
  auto const file = run.out / "episodes.hdf5";
  record(run, file);
  io::Hdf5Reader const recorded(file);
  Envs alone(run.config, {.num_envs = 1, .seed = run.seed, .autoreset = rl::Autoreset::disabled},
             run.threads);
  int same = 0;
  io::Progress progress(run.episodes, "seeing again", "episodes");
  for (int k = 0; k < run.episodes; ++k) {
    same += same_again(alone, rl::read_episode(recorded, k, Envs::action_size));
    progress.update(k + 1);
  }
  fmt::print("{} episodes in {}\n", run.episodes, file.string());
  return course::check(same == run.episodes, "every episode goes the same way again, bit for bit");
}

#else

bool record_and_replay(course::TaskOptions const&) {
  fmt::print("built without HDF5 (libhdf5-dev): nothing to do\n");
  return true;
}

#endif

}  // namespace

int main(int argc, char** argv) {
  course::TaskOptions defaults;
  defaults.episodes = 8;
  return course::run_task(argc, argv, "Records episodes of the expert and sees them again.",
                          defaults, record_and_replay);
}
