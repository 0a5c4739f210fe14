// B2 for linear splines, whose stiffness has no bound over the cell: the limit hangs on where the particles are.
// seconds: 30
#include <mpmpbd/mpm/transfer/pic.hpp>

#include "stability/time_limit.hpp"

using namespace test;

namespace {

template <class Transfer> void check() {
  using Tissue = Unheld<LinearBSpline, Transfer, WeightGradient>;
  check_lattices<Tissue>({{1, 0.5, 1}, {1, 0.05, 1}, {1, 0.003, 1}});  // alone
  check_lattices<Tissue>({{1, 0.5}, {1, 0.05}, {1, 0.003}, {2, 0.25}, {2, 0.07}, {2, 0.003}});
  check_lattices<Tissue>({{3, 0.1}, {4, 0.125}, {4, 0.02}});
}

}  // namespace

TEST_CASE("linear splines with APIC", "[stability][B2]") { check<Apic>(); }
TEST_CASE("linear splines with FLIP", "[stability][B2]") { check<Flip>(); }
TEST_CASE("linear splines with PIC", "[stability][B2]") { check<Pic>(); }
