// expect: mpmpbd VectorEnv<Task, Cuda>: an observation group of the task is drawn (it names a Viewer), and pictures are not drawn on a device yet; take Serial or Threads, or groups of numbers
#include <mpmpbd/rl/cuda/vector_env.hpp>

#include "fail/lift_task.hpp"

struct Eye {
  template <class Config> Eye(Config const&, int) {}
};
struct Picture {
  using Role = role::Observation;
  static constexpr FixedString name = "picture";
  using Reads = Fields<particle::Position>;
  using Writes = Fields<>;
  using Element = std::uint8_t;
  using Viewer = Eye;
};

#ifdef MPMPBD_FIXED
using Seen = Height;
#else
using Seen = Picture;
#endif
struct Lift : rl::Task<Block, Push, Seen, Up> {
  struct Config {
    rl::EpisodeConfig episode;
  };
};

int main() { return sizeof(rl::VectorEnv<Lift, Cuda, float>) == 0; }
