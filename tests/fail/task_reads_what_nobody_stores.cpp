// expect: mpmpbd Task<...>: a part reads a field that neither its scene stores nor another part writes; name a scene that has it, or add the part that writes it
#include "fail/lift_task.hpp"

struct Goal : Field<"goal", "m", Vector, Environments> {};
struct WayToGoal : Height {
  static constexpr FixedString name = "way to goal";
  using Reads = Fields<particle::Position, Goal>;
};
struct RandomGoal {
  using Role = role::Randomisation;
  static constexpr FixedString name = "random goal";
  using Reads = Fields<>;
  using Writes = Fields<Goal>;
};

#ifdef MPMPBD_FIXED
using Task = rl::Task<Block, Push, WayToGoal, Up, RandomGoal>;
#else
using Task = rl::Task<Block, Push, WayToGoal, Up>;
#endif

int main() { return sizeof(Task) == 0; }
