// expect: mpmpbd Task<...>: no RewardTerm given, so nothing could be learnt; add one
#include "fail/lift_task.hpp"

#ifdef MPMPBD_FIXED
using Task = rl::Task<Block, Push, Height, Up>;
#else
using Task = rl::Task<Block, Push, Height>;
#endif

int main() { return sizeof(Task) == 0; }
