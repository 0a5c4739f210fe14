// T90 in newtons: the thread and the tissue of preset phantom, its step and its friction. See bent_thread.hpp.
// seconds: 50
// on a device
#include "physics/bent_thread_checks.hpp"
#include "support/preset_numbers.hpp"

using namespace test;

namespace {

// The scene's tissue is viscous too, which only calms it.
BentCase pulled_with(double newtons) {
  auto const scene = preset_numbers("phantom");
  Units const u{scene.cell_size, scene.density, scene.mu};
  BentCase c;
  c.unit = u;
  c.lambda = scene.lambda / scene.mu;
  c.tension = newtons / u.force();
  c.bead_mass = scene.thread_line_density * u.length * bent_length / c.segments / u.mass();
  c.stiffness = scene.thread_axial_stiffness / u.force();
  c.radius = scene.thread_radius / u.length;
  c.friction = scene.friction;
  c.clamp_pressure = scene.clamp_pressure / u.modulus;
  c.dt = scene.substep / u.time();
  c.end = 1 / u.time();
  return c;
}

template <class T> void check_held(BentCase const& c) {
  BentResult const r = run_bent<T>(c);
  CAPTURE(c.tension * c.unit.force(), c.friction, r.slip_end, r.slip_most, r.tissue, r.stretch,
          r.held);
  CHECK_FALSE(r.ran_away);
  CHECK(r.slip_most < 0.1);
  CHECK(std::abs(r.held / c.tension - 1) < 0.01);
}

}  // namespace

TEST_CASE("the phantom's thread does not cut through its tissue", "[coupling][T90]") {
  for (double newtons : {0.05, 0.2, 0.5}) check_held<double>(pulled_with(newtons));
}

TEST_CASE("nor does it in float", "[coupling][T90]") { check_held<float>(pulled_with(0.5)); }

TEST_CASE("nor without friction", "[coupling][T90]") {
  BentCase c = pulled_with(0.5);
  c.friction = 0;
  check_held<double>(c);
}

TEST_CASE("without a warm start it cuts through", "[coupling][T90][control]") {
  BentCase c = pulled_with(0.5);
  c.friction = 0;
  c.end = 800;
  c.scheme = Scheme::cold_start;
  BentResult const r = run_bent<double>(c);
  CAPTURE(r.ran_away, r.slip_most);
  CHECK((r.ran_away || r.slip_most > 0.1));
}
