// B2 for quadratic and cubic splines with APIC: both force forms, particles per cell and place in the cell.
// seconds: 25
#include "stability/time_limit.hpp"

using namespace test;

namespace {

template <class... Policies> void check() {
  check_lattices<Unheld<Policies...>>(smooth_fillings());
}

}  // namespace

TEST_CASE("quadratic splines with MLS forces", "[stability][B2]") { check<Apic, Mls>(); }
TEST_CASE("quadratic splines with forces by slopes", "[stability][B2]") {
  check<Apic, WeightGradient>();
}
TEST_CASE("cubic splines with MLS forces", "[stability][B2]") { check<CubicBSpline, Apic, Mls>(); }
TEST_CASE("cubic splines with forces by slopes", "[stability][B2]") {
  check<CubicBSpline, Apic, WeightGradient>();
}
