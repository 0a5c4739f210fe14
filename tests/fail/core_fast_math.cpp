// expect: mpmpbd does not support -ffast-math
// What the flag defines, defined by hand: every failing program is compiled with the same flags.
#ifndef MPMPBD_FIXED
#define __FAST_MATH__ 1
#endif
#include <mpmpbd/core/math.hpp>

int main() {}
