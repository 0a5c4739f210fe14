// B2 for transfers other than APIC, which remember less of a motion.
// seconds: 20
#include <mpmpbd/mpm/transfer/pic.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>

#include "stability/time_limit.hpp"

using namespace test;

namespace {

template <class... Policies> void check() {
  check_lattices<Unheld<Policies...>>(smooth_fillings());
}

}  // namespace

TEST_CASE("TPIC", "[stability][B2]") { check<Tpic, WeightGradient>(); }
TEST_CASE("FLIP", "[stability][B2]") { check<Flip, WeightGradient>(); }
TEST_CASE("PIC", "[stability][B2]") { check<Pic, Mls>(); }
