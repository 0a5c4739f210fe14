// expect: mpmpbd Task<...>: two observation groups, reward terms or metrics have the same name, by which they are logged; rename one
#include "fail/lift_task.hpp"

struct Higher : Height {};

#ifdef MPMPBD_FIXED
using Task = rl::Task<Block, Push, Height, Up>;
#else
using Task = rl::Task<Block, Push, Height, Higher, Up>;
#endif

int main() { return sizeof(Task) == 0; }
