// B21: 10,000 steps, 2.7 s of gel in 2 mm cells.
// seconds: 200
// on a device
#include "catch.hpp"

#include "physics/thread_masses.hpp"

using namespace test;

TEMPLATE_TEST_CASE("a thread of any mass is still in its place after 10,000 steps",
                   "[coupling][embedded][mass][long]", double, float) {
  for (double ratio : {1e-4, 1e-2, 1.0, 1e2, 1e4}) {
    auto const r = swing<TestType>(ratio, 10000);
    CAPTURE(ratio, r.energy_rise, r.momentum_error, r.slip, r.energy_left);
    CHECK(r.energy_rise < 1e-3);
    CHECK(r.momentum_error < r.rounding);
    CHECK(r.slip < 0.05);
    CHECK(r.energy_left < 0.5);
    CHECK(r.status == 0);
  }
}
