// A loaded line holds on to the tissue: it sinks in as far as the tissue yields, and no further.
// seconds: 45
// on a device
#include "physics/held_line_checks.hpp"

using namespace test;

namespace {

// Force on bead k of n under a load of 1 that is spread evenly along the thread, or acts on its middle.
double even(std::size_t k, std::size_t n) {
  return (k == 0 || k + 1 == n ? 0.5 : 1.0) / double(n - 1);
}
double middle(std::size_t k, std::size_t n) { return k == n / 2 ? 1.0 : 0.0; }

template <class Share> auto load_thread(Held& h, double load, Share const& share) {
  return [&h, load, share] {
    std::size_t const n = h.rig.bead.size();
    for (std::size_t k = 0; k < n; ++k)
      h.push(k, mpmpbd::vec(load * ramp(h.time) * share(k, n), 0.0, 0.0));
  };
}

template <class Share> void check_thread(double load, Share const& share) {
  for (double mass : {1e-4, 1e-2, 1.0, 100.0}) {
    Held h = held_thread(mass);
    Slip const slip = watch(h, load_thread(h, load, share), second);
    CAPTURE(mass, slip.settled, slip.growth, slip.reaction);
    CHECK(slip.growth < 1e-3);
    CHECK(std::abs(slip.reaction / load - 1) < 0.01);
  }
}

}  // namespace

TEST_CASE("a thread under an even load does not creep", "[coupling][hold]") {
  check_thread(8, even);
}

TEST_CASE("a thread pushed at one point does not creep", "[coupling][hold]") {
  check_thread(4, middle);
}

TEST_CASE("without a warm start a thread pushed at one point cuts through",
          "[coupling][hold][control]") {
  Held h = held_thread(1e-4);
  auto const push = load_thread(h, 4, middle);
  Slip const slip = watch(
      h,
      [&] {
        push();
        for (auto& p : h.rig.points) p.impulse = {};
      },
      20);
  CAPTURE(slip.settled, slip.reaction);
  CHECK(slip.settled > 0.3);
}

// The share of the lateral impulses that cancels. A line that ends inside the tissue is held more at its
// ends, so the bar passes through.
TEST_CASE("impulses along an evenly loaded line do not fight each other", "[coupling][load]") {
  Held thread = held_thread(1e-2), bar = held_bar(1e-2, 0);
  watch(thread, load_thread(thread, 8, even), 10);
  watch(
      bar, [&] { bar.push(0, mpmpbd::vec(8 * ramp(bar.time), 0.0, 0.0)); }, 10);
  CAPTURE(roughness(thread), roughness(bar));
  CHECK(roughness(thread) < 1.02);
  CHECK(roughness(bar) < 1.02);
}
