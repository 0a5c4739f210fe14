// 8. An expert: a script that makes the stitch through the task's own interface, from what it is shown.
//
// What a policy can be compared with, learn from (10_record) and be checked by.
// test: --num-envs 1 --episodes 1
#include "task_options.hpp"

#include <mpmpbd/rl/suturing/expert.hpp>

using namespace mpmpbd;

namespace {

template <class Envs> bool sew(course::TaskOptions const& run, Envs& envs) {
  rl::SuturingExperts experts(envs);
  course::EpisodeQueue queue(run.episodes);
  course::EpisodeTable<Envs> table(run.out / "episodes.csv");
  io::Progress progress(run.episodes, "sewing", "episodes");
  for (queue.refill(envs); !queue.done(); queue.refill(envs)) {
    envs.step(experts.act(envs));
    table.take(envs, queue);
    progress.update(queue.finished());
  }
  table.close();
  fmt::print("{} episodes: {} entered, {} stitches\n", table.episodes(), table.entries(),
             table.successes());
  return course::check(table.successes() >= 0.95 * table.episodes(),
                       "at least 95 of 100 are stitches");
}

}  // namespace

int main(int argc, char** argv) {
  course::TaskOptions defaults;
  defaults.episodes = 20;
  defaults.takes_devices = true;
  return course::run_task(argc, argv, "A scripted expert in the suturing task.", defaults,
                          [](course::TaskOptions const& run) {
                            return course::with_envs<rl::SuturingTask>(
                                run, [&](auto& envs) { return sew(run, envs); });
                          });
}
