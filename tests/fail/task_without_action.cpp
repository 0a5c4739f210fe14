// expect: mpmpbd Task<...>: a task has exactly one Action, which says what the agent's numbers do; add one, or join them into one policy
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/rl/task.hpp>

using namespace mpmpbd;

struct Push {
  using Role = role::Action;
  static constexpr FixedString name = "push";
  static constexpr int size = 1;
  using Reads = Fields<>;
  using Writes = Fields<particle::Velocity>;
};
struct Height {
  using Role = role::Observation;
  static constexpr FixedString name = "height";
  static constexpr int size = 1;
  using Reads = Fields<particle::Position>;
  using Writes = Fields<>;
};
struct Up {
  using Role = role::RewardTerm;
  static constexpr FixedString name = "up";
  using Reads = Fields<particle::Position>;
  using Writes = Fields<>;
};
struct Block : Scene<Mpm<NeoHookean>> {};

#ifdef MPMPBD_FIXED
using Task = rl::Task<Block, Push, Height, Up>;
#else
using Task = rl::Task<Block, Height, Up>;
#endif

int main() { return sizeof(Task) == 0; }
