// The covering array, scenes 2 of 4; see covering_array.py.
#include "covering_array.hpp"

TEST_CASE("Each pair of policies meets: hangs") { covering::check_rows(covering::Rows2{}); }
