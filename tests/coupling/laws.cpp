// Every coupling strategy passes the laws that it claims. A new one is a line here.
#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/coupling/grid_projection.hpp>
#include <mpmpbd/testing/coupling_laws.hpp>

#include <algorithm>

#include "catch.hpp"

using namespace mpmpbd;

namespace {

template <class Laws_, class T> void check_laws(CouplingCase<Laws_> const& c) {
  for (auto const& law : coupling_laws<Laws_, T>(c)) {
    INFO(law.text());
    CHECK(law.holds());
  }
}

}  // namespace

TEMPLATE_TEST_CASE("Embedded keeps its laws", "", float, double) {
  check_laws<Coupling<Embedded>, TestType>({.strategy = {1e-4}});
  check_laws<Coupling<Embedded, Friction, Drag>, TestType>({{1e-4}, {0.2, 100.0}, {0.5}});
}

// The reference scheme keeps linear momentum, which is all that it claims; these it breaks.
TEMPLATE_TEST_CASE("GridProjection breaks the laws that it is known to break", "", float, double) {
  using Laws_ = Coupling<GridProjection, Friction>;
  auto const laws = coupling_laws<Laws_, TestType>(
      {.strategy = {2e-3, 0.0}, .friction = {0.2, 0.0}}, Conserves::momentum_and_angular);
  for (auto const* broken :
       {"angular momentum, thread", "gain of energy, bead/node mass 0.0001",
        "gain of energy, bead/node mass 0.01", "gain of energy, bead/node mass 1",
        "thread numbered from its other end", "impulse over 16 places"}) {
    auto const law = find_law(laws, broken);
    INFO(law.text());
    CHECK(law.error > law.limit);
  }
  for (auto const* kept : {"linear momentum", "gain of energy, bead/node mass 100",
                           "gain of energy, bead/node mass 10000", "reported force",
                           "reported moment", "no force without touch", "free flight"}) {
    auto const law = find_law(laws, kept);
    INFO(law.text());
    // In float the rod's own solver knows a velocity to an ulp of the position per dt only.
    CHECK(law.error <= (sizeof(TestType) == 4 ? std::max(law.limit, 1e-4) : law.limit));
  }
  CHECK(find_law(laws, "gain of energy, bead/node mass 0.0001").error > 100);  // 333
}
