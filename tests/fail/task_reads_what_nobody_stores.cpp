// expect: mpmpbd Task<...>: a part reads a field that neither its scene stores nor another part writes; name a scene that has it, or add the part that writes it
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
struct Goal : Field<"goal", "m", Vector, Environments> {};
struct Height {
  using Role = role::Observation;
  static constexpr FixedString name = "height";
  static constexpr int size = 1;
  using Reads = Fields<particle::Position, Goal>;
  using Writes = Fields<>;
};
struct RandomGoal {
  using Role = role::Randomisation;
  static constexpr FixedString name = "random goal";
  using Reads = Fields<>;
  using Writes = Fields<Goal>;
};
struct Up {
  using Role = role::RewardTerm;
  static constexpr FixedString name = "up";
  using Reads = Fields<particle::Position>;
  using Writes = Fields<>;
};
struct Block : Scene<Mpm<NeoHookean>> {};

#ifdef MPMPBD_FIXED
using Task = rl::Task<Block, Push, Height, Up, RandomGoal>;
#else
using Task = rl::Task<Block, Push, Height, Up>;
#endif

int main() { return sizeof(Task) == 0; }
