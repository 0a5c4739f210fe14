// expect: mpmpbd Task<...>: a task has exactly one Action, which says what the agent's numbers do; add one, or join them into one policy
#include "fail/lift_task.hpp"

#ifdef MPMPBD_FIXED
using Task = rl::Task<Block, Push, Height, Up>;
#else
using Task = rl::Task<Block, Height, Up>;
#endif

int main() { return sizeof(Task) == 0; }
