// Air around threads: exponential, the same at any step, and only for beads that are free.
#include <mpmpbd/effects/air.hpp>

#include "catch.hpp"

using namespace mpmpbd;

namespace {
double speed_after(double time, int steps, double inverse_mass) {
  Local<double, Fields<bead::Velocity, bead::InverseMass>> bead{};
  bead[bead::Velocity{}] = vec(0.1, 0.2, 0.3);
  bead[bead::InverseMass{}] = inverse_mass;
  for (int i = 0; i < steps; ++i)
    Air::apply(bead, Air::Parameters<double>{5.0}, Tick<double>{time / steps, time / steps, i});
  return bead[bead::Velocity{}][2];
}
}  // namespace

TEST_CASE("a free bead loses its speed exponentially, whatever the step", "[effect][air]") {
  CHECK(speed_after(0.4, 1, 100.0) == Approx(0.3 * std::exp(-2.0)).epsilon(1e-12));
  CHECK(speed_after(0.4, 400, 100.0) == Approx(0.3 * std::exp(-2.0)).epsilon(1e-12));
}

TEST_CASE("a bead of prescribed motion does not feel the air", "[effect][air]") {
  CHECK(speed_after(0.4, 10, 0.0) == 0.3);
}
