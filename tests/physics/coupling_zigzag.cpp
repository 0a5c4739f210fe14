// A light thread that is pushed from its end. Tissue must hold every bead against buckling in a zigzag,
// the shortest wave a thread has and the one that a single contact point per segment does not see.
// seconds: 15
// on a device
#include "catch.hpp"

#include "physics/held_line.hpp"

namespace {

using namespace test;
using Line = HeldLine<double, mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::NoFriction,
                                                   mpmpbd::NoDrag, false>>;

constexpr int segments = 6;
constexpr double crooked = 0.002;  // initial offset of the beads, to either side [cells]

// Largest distance of a bead from the middle of its neighbours, across the thread [cells].
double zigzag(Line const& h) {
  double most = 0;
  for (std::size_t k = 1; k < segments; ++k) {
    auto const& b = h.rig.bead;
    auto d = b[k] - 0.5 * (b[k - 1] + b[k + 1]);
    d[2] = 0;
    most = std::max(most, mpmpbd::norm(d) / h.unit.length);
  }
  return most;
}

// Control: one point in the middle of each segment.
std::uint32_t couple_at_midpoints(Line& h) {
  auto& r = h.rig;
  auto const x = r.view();
  mpmpbd::Solo const team;
  mpmpbd::place_thread_points(team, x);
  place_on_segments(x, {0.5});
  mpmpbd::embed_points(team, x, r.nodes());
  return exchange_on_back_end(r, x);
}

struct Buckling {
  double early = 0, end = 0;  // zigzag at t = 600 and at the end
};

// The first bead is held: without friction nothing else keeps the thread from sliding out along itself.
template <class Couple> Buckling push(double mass, double load, double end, Couple const& couple) {
  Line h(0.2, true, 0.5);
  h.add_thread(segments, mass, 1000);
  h.rig.allocate({}, std::vector<mpmpbd::ContactPoint<double>>(segments));
  h.rig.known.front() = 1;
  for (std::size_t k = 0; k <= segments; ++k)
    h.rig.bead[k][0] += (k % 2 == 0 ? -1 : 1) * crooked * h.unit.length;
  Buckling r;
  auto const from_the_end = [&] {
    h.push(segments, mpmpbd::vec(0.0, 0.0, -load * std::min(1.0, h.time / 40)));
  };
  while (h.time < end && r.end < 3) {
    REQUIRE(h.step(from_the_end, [&] { return couple(h); }) == 0u);
    r.end = zigzag(h);
    if (h.time < 600) r.early = r.end;
  }
  return r;
}

}  // namespace

// It buckles at a load of 4.6; below that the crookedness grows by 1/(1 - load/4.6), as of any strut.
TEST_CASE("tissue holds a thread that is pushed from its end", "[coupling][zigzag]") {
  auto const couple = [](Line& h) { return couple_on_back_end(h.rig); };
  for (double mass : {1e-4, 1e-2})
    for (double load : {1.0, 2.0}) {
      Buckling const r = push(mass, load, 1000, couple);
      CAPTURE(mass, load, r.early, r.end);
      CHECK(r.end < 2 * crooked / (1 - load / 4));
      CHECK(r.end - r.early < 1e-4);
    }
  Buckling const buckled = push(1e-4, 5, 1000, couple);
  CAPTURE(buckled.early, buckled.end);
  CHECK(buckled.end < 0.6);  // it comes to rest, bent
  CHECK(std::abs(buckled.end - buckled.early) < 0.01);
}

TEST_CASE("with one point per segment a pushed thread folds up", "[coupling][zigzag][control]") {
  Buckling const r = push(1e-4, 0.5, 200, couple_at_midpoints);
  CAPTURE(r.early, r.end);
  CHECK(r.end > 0.2);
}
