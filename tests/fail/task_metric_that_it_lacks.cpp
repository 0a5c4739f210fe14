// expect: mpmpbd VectorEnv: metric<M> of a metric that the task does not have; name one of Task::Metrics, or add it to the task
#include <mpmpbd/rl/env_settings.hpp>

#include "fail/lift_task.hpp"

struct Lifted : Up {
  using Role = role::Metric;
  static constexpr FixedString name = "lifted";
};
struct Dropped : Lifted {
  static constexpr FixedString name = "dropped";
};
struct Lift : rl::Task<Block, Push, Height, Up, Lifted> {
  struct Config {
    rl::EpisodeConfig episode;
  };
};

#ifdef MPMPBD_FIXED
using Asked = Lifted;
#else
using Asked = Dropped;
#endif

struct Envs : rl::EnvSettings<Lift> {
  static constexpr std::size_t asked() { return metric_index<Asked>(0); }
};

static_assert(Envs::asked() == 0);
int main() {}
