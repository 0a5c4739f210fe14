// seconds: 8
// on a device
// A3.4 of verification.md: at equal cost, substeps stretch a chain far less than iterations do.
//
// 50 inextensible links, 1 m, from horizontal, 2 s of frames of 1/60 s. The table's stretch is the largest
// total length over the rest length, minus 1.
#include "catch.hpp"
#include "physics/rods_on_back_end.hpp"

using namespace rods;

namespace {
template <class Body, class T = double>
double stretch(int substeps, double tip_mass, VisitOrder order) {
  int const N = 50;
  double const length = 1.0, m = 0.02, dt = 1.0 / 60 / substeps;
  auto rod = chain<Body>(straight({{0.3, 0.2, 0.1}}, {{0.3 + length, 0.2, 0.1}}, N + 1), m, 0.0);
  rod.set_mass(N, m * tip_mass);
  Simulated<Body, T> rig(rod, order);
  double worst = 0;
  for (int s = 0; s < 120 * substeps; ++s) {
    rig.step(dt);
    worst = std::max(worst, rig.length() / length - 1);
  }
  return worst;
}
template <int n> struct Iterated : Pbd<Constraints<Distance>, Xpbd<n>> {};
struct Stepped : Pbd<Constraints<Distance>, Xpbd<1>> {};
struct Small : Pbd<Constraints<Distance>, SmallSteps<20>> {};
struct Once : Pbd<Constraints<Distance>, DirectBanded<1>> {};
struct Twice : Pbd<Constraints<Distance>, DirectBanded<2>> {};
struct Often : Pbd<Constraints<Distance>, DirectBanded<8>> {};

template <int budget>
void row(double tip, double iterated_table, double stepped_table, double least_ratio) {
  for (auto order : {VisitOrder::along, VisitOrder::coloured}) {
    double const iterated = stretch<Iterated<budget>>(1, tip, order),
                 stepped = stretch<Stepped>(budget, tip, order);
    INFO("budget " << budget << ", tip x " << tip << ", coloured "
                   << (order == VisitOrder::coloured));
    INFO("iterations " << iterated << " (table " << iterated_table << "), substeps " << stepped
                       << " (table " << stepped_table << ")");
    CHECK(iterated == Approx(iterated_table).epsilon(0.02));
    CHECK(stepped == Approx(stepped_table).epsilon(0.02));
    CHECK(stepped <= 1.3 * stepped_table);
    CHECK(iterated >= least_ratio * stepped);
  }
}
}  // namespace

TEST_CASE("A3.4: small steps beat iterations", "[constraint][physics]") {
  row<20>(1, 0.449, 0.0463, 8);
  row<40>(1, 0.236, 0.0151, 8);
  row<80>(1, 0.122, 0.00585, 8);
}
TEST_CASE("A3.4: small steps with a heavy tip", "[constraint][physics]") {
  row<80>(100, 0.588, 0.0308, 8);
  row<80>(1000, 3.97, 0.077, 8);
  row<80>(1e4, 15.8, 0.62, 8);
}
TEST_CASE("A3.4: the scheduling policy is the same as calling small steps",
          "[constraint][physics]") {
  STATIC_REQUIRE(Small::substeps == 20);
  double const by_policy = stretch<Small>(1, 1, VisitOrder::coloured);  // measured once per frame
  CHECK(by_policy <= 1.3 * 0.0463);
  CHECK(by_policy > 0.5 * 0.0463);
}
TEST_CASE("A3.4: the direct solver needs few of either", "[constraint][physics]") {
  CHECK(stretch<Twice>(1, 1, VisitOrder::coloured) <
        1e-3);  // the same frame in which 80 iterations leave 0.122
  CHECK(stretch<Twice>(20, 1, VisitOrder::coloured) < 1e-6);
  CHECK(stretch<Twice>(20, 1e4, VisitOrder::coloured) < 1e-6);
  CHECK(stretch<Twice, float>(20, 1, VisitOrder::coloured) < 1e-4);
  for (double tip : {1.0, 100.0, 1000.0, 1e4})
    CHECK(stretch<Often>(1, tip, VisitOrder::coloured) < 1e-4);
}
// The limit of a single elimination: directions are those of the prediction, so a taut thread sways off when
// h^2 T / (m l) exceeds about 1; here it is 1e3 and more. The run stays finite, and the status word says so.
TEST_CASE("A3.4: one elimination is not enough for a taut thread, and says so",
          "[constraint][physics]") {
  auto rod = chain<Once>(straight({{0.3, 0.2, 0.1}}, {{1.3, 0.2, 0.1}}, 51), 0.02, 0.0);
  rod.set_mass(50, 0.02 * 1e4);
  Simulated<Once> rig(rod);
  for (int s = 0; s < 120; ++s) rig.step(1.0 / 60);
  CHECK(rig.finite());
  CHECK(rig.length() < 100.0);
  CHECK(has(rig.faults, Fault::solver));
}
