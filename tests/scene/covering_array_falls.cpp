// The covering array, scenes 1 of 4; see covering_array.py.
#include "covering_array.hpp"

TEST_CASE("Each pair of policies meets: falls") { covering::check_rows(covering::Rows1{}); }
