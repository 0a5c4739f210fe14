// expect: mpmpbd Task<...>: a part is none of Action, Progress, Observation, RewardTerm, Termination, Randomisation and Metric; effects, materials and the like belong into the scene
#include <mpmpbd/effects/gravity.hpp>

#include "fail/lift_task.hpp"

#ifdef MPMPBD_FIXED
using Task = rl::Task<Block, Push, Height, Up>;
#else
using Task = rl::Task<Block, Push, Height, Up, Gravity>;
#endif

int main() { return sizeof(Task) == 0; }
