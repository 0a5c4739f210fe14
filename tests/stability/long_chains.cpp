// B26: inextensible chains of thousands of links, by one iteration and by elimination.
// seconds: 15
#include "catch.hpp"
#include "pbd/rig.hpp"

using namespace rods;

namespace {

template <class Solver> struct Chain : Pbd<Constraints<Distance>, Solver> {};

// Largest over all steps, of a chain of 1 m that falls from horizontal.
struct Fall {
  double longest = 0,
         stretch = 0;  // of one link and of the whole chain, over its rest length, minus 1
  bool finite = true;
  std::uint32_t faults = 0;
};
template <class Solver> Fall fall(int links, double h, double duration) {
  using Body = Chain<Solver>;
  double const l = 1.0 / links;
  Rig<Body> rig(chain<Body>(straight({{0, 0, 0}}, {{1, 0, 0}}, links + 1), 0.1 * l, 0.0));
  Fall f;
  for (double t = 0; t < duration; t += h) {
    rig.step(h);
    double sum = 0;
    for (std::int64_t b = 1; b <= links; ++b) {
      double const r = norm(rig.x(b) - rig.x(b - 1));
      f.longest = std::max(f.longest, r / l - 1);
      sum += r;
    }
    f.stretch = std::max(f.stretch, sum - 1);
  }
  f.finite = rig.finite();
  f.faults = rig.faults;
  return f;
}

}  // namespace

// At rest one sweep per step leaves the mean link longer by T h^2/m at tension T, as a spring m/h^2 would be. So
// the chain is a rope of wave speed l/h, and chains of equal N h stretch alike: 50 links at 1/1200 s are the
// table's row of 20 steps a frame. No link is longer than all the energy of the fall makes that spring,
// sqrt(N g L) h/l; coloured links take turns and share it unevenly, by up to 2. Without constraint the
// first link reaches g t^2/2 l.
TEST_CASE("B26: long inextensible chains with one iteration", "[constraint][hard]") {
  auto const most = [](int links, double h) { return 2 * std::sqrt(gravity * links) * h * links; };
  Fall const chain = fall<Xpbd<1>>(1000, 1.0 / 24000, 2.0);
  CAPTURE(chain.stretch, chain.longest);
  CHECK(chain.finite);
  CHECK(chain.stretch <= 1.3 * 0.0463);
  CHECK(chain.longest < most(1000, 1.0 / 24000));
  CHECK(most(1000, 1.0 / 24000) < 1e-3 * gravity * square(2.0) / 2 * 1000);

  Fall const few = fall<Xpbd<1>>(50, 1.0 / 240, 1.0), many = fall<Xpbd<1>>(5000, 1.0 / 24000, 1.0);
  CAPTURE(few.stretch, few.longest, many.stretch, many.longest);
  CHECK(many.finite);
  CHECK(many.stretch <= 1.3 * few.stretch);
  CHECK(many.longest < most(5000, 1.0 / 24000));
}

// A single elimination is as good at the table's N h. At steps so long that a taut thread sways off (A3.4) it
// stretches 16-fold, stays finite and says so; four eliminations hold.
TEST_CASE("B26: long inextensible chains with direct solvers", "[constraint][hard]") {
  Fall const once = fall<DirectBanded<1>>(1000, 1.0 / 24000, 0.8);
  CAPTURE(once.longest, once.stretch, once.faults);
  CHECK(once.finite);
  CHECK(once.stretch <= 1.3 * 0.0463);
  for (int links : {1000, 5000}) {
    double const time = links == 1000 ? 2.0 : 0.4, h = 1.0 / 1000;
    Fall const late = fall<DirectBanded<1>>(links, h, time),
               four = fall<DirectBanded<4>>(links, h, time);
    CAPTURE(links, late.longest, late.stretch, four.longest, four.stretch);
    CHECK(late.finite);
    CHECK(has(late.faults, Fault::solver));
    CHECK(four.finite);
    CHECK(four.stretch < 1e-6);
    CHECK(four.longest < 0.00585);  // the best of the table, for every link
    CHECK(four.faults == 0);
  }
}
