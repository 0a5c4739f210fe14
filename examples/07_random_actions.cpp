// 7. Random actions: the suturing task for learning, and how many decisions a second this machine
// makes.
//
// An agent moves a needle in many environments at once. Here it knows nothing; it will not make a
// stitch.
// test: --num-envs 2 --episodes 2 --set episode.limit=3
#include "task_options.hpp"

using namespace mpmpbd;

namespace {

template <class Envs> bool wander(course::TaskOptions const& run, Envs& envs) {
  course::EpisodeQueue queue(run.episodes);
  course::EpisodeTable<Envs> table(run.out / "episodes.csv");
  std::vector<rl::Random> random(static_cast<std::size_t>(envs.num_envs()), {run.seed, -1, 0});
  std::vector<float> actions(random.size() * Envs::action_size);
  io::Progress progress(run.episodes, "wandering", "episodes");
  std::int64_t decisions = 0;
  double const began = io::monotonic_seconds();
  for (queue.refill(envs); !queue.done(); queue.refill(envs)) {
    for (std::size_t e = 0; e < random.size(); ++e) {
      auto const env = static_cast<std::int64_t>(e);
      if (envs.decisions(env) == 0)
        random[e] = {run.seed, -1, envs.episode(env)};  // of no environment
      for (std::size_t a = 0; a < Envs::action_size; ++a)
        actions[e * Envs::action_size + a] = static_cast<float>(random[e].between(-1.0, 1.0));
      decisions += queue.busy(env);
    }
    envs.step(actions);
    table.take(envs, queue);
    progress.update(queue.finished());
  }
  double const seconds = io::monotonic_seconds() - began;
  table.close();
  fmt::print("{} episodes: {} entered, {} stitches, {} diverged\n", table.episodes(),
             table.entries(), table.successes(), table.diverged());
  fmt::print("{:.1f} decisions/s ({} environments, {} material points each, {})\n",
             static_cast<double>(decisions) / seconds, envs.num_envs(),
             run.config.scene.tissue.point_count(), run.place());
  bool const whole = course::check(table.diverged() == 0, "no environment lost its numbers");
  bool const aimless = course::check(table.successes() == 0, "random actions make no stitch");
  return whole && aimless;
}

}  // namespace

int main(int argc, char** argv) {
  course::TaskOptions defaults;
  defaults.episodes = 20;
  defaults.takes_devices = true;
  return course::run_task(argc, argv, "Random actions in the suturing task.", defaults,
                          [](course::TaskOptions const& run) {
                            return course::with_envs<rl::SuturingTask>(
                                run, [&](auto& envs) { return wander(run, envs); });
                          });
}
