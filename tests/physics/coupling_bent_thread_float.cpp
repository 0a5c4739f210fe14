// T90 in float. See bent_thread.hpp.
// seconds: 130
// on a device
#include "physics/bent_thread_checks.hpp"

TEST_CASE("a taut bent thread stays where it is, in float", "[coupling][T90]") {
  test::check_bent_threads<float>();
}
