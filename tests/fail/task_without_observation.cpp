// expect: mpmpbd Task<...>: no Observation given, so the agent would see nothing; add a group, for example NeedlePose
#include "fail/lift_task.hpp"

#ifdef MPMPBD_FIXED
using Task = rl::Task<Block, Push, Height, Up>;
#else
using Task = rl::Task<Block, Push, Up>;
#endif

int main() { return sizeof(Task) == 0; }
