// T90: a taut thread round a bend of 90 degrees, in double. See bent_thread.hpp.
// seconds: 130
// on a device
#include "physics/bent_thread_checks.hpp"

TEST_CASE("a taut bent thread stays where it is", "[coupling][T90]") {
  test::check_bent_threads<double>();
}
