// A thread is kicked inside a free block of swirling tissue. No coupling may raise the energy that it
// sees, and over the whole motion nothing may feed on the coupling.
// seconds: 5
// on a device
#include "catch.hpp"

#include "physics/held_line.hpp"

namespace {

using namespace test;
using Q = mpmpbd::QuadraticBSpline;
using Slippery = mpmpbd::EmbeddedForm<Q, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;
using Rough = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::NoDrag, false>;

template <class Form> using Chain = HeldLine<double, Form>;

// Sideways, in a zigzag, and along itself; heavy beads get as much energy as those of a node's mass.
template <class Form> void kick(Chain<Form>& h, double mass) {
  h.add_thread(6, mass, 1000);
  if constexpr (Form::FrictionLaw::grips) h.rig.friction = {0.3, 0.02 * h.unit.modulus};
  double const speed = 0.2 / std::sqrt(std::max(1.0, mass)) * h.unit.speed();
  for (std::size_t k = 0; k < h.rig.bead.size(); ++k)
    h.rig.bead_velocity[k] = speed * mpmpbd::vec(1.0, k % 2 == 0 ? -0.3 : 0.3, 0.3);
  for (auto& p : h.tissue.particles) {
    auto const at = 1 / h.unit.length * p.x;
    p.v = 0.01 * h.unit.speed() * mpmpbd::vec(-std::sin(at[2]), std::cos(at[0]), 0.0);
  }
}

template <class Form> double total_energy(Chain<Form> const& h) {
  auto const& r = h.rig;
  double e = h.tissue.energy();
  for (std::size_t k = 0; k < r.bead.size(); ++k) {
    e += 0.5 * r.bead_mass[k] * mpmpbd::dot(r.bead_velocity[k], r.bead_velocity[k]);
    if (k + 1 == r.bead.size()) break;
    double const more = mpmpbd::norm(r.bead[k + 1] - r.bead[k]) - r.rest_length[k];
    e += 0.5 / (r.stretch_compliance * r.rest_length[k]) * more * more;
  }
  return e;
}

struct Gain {
  double of_coupling = -1;  // largest relative rise in one coupling
  double of_motion = 0;     // above the running minimum, relative
};

template <class Form> Gain follow(double mass) {
  Chain<Form> h(0.1, false, 0);
  kick(h, mass);
  Gain gain;
  auto const couple = [&] {
    mpmpbd::place_thread_points(mpmpbd::Solo{}, h.rig.view());
    double const before = kinetic_energy(h.rig) + thread_energy(h.rig, false);
    auto const faults = couple_on_back_end(h.rig);
    double const after = kinetic_energy(h.rig) + thread_energy(h.rig, true);
    gain.of_coupling = std::max(gain.of_coupling, after / before - 1);
    return faults;
  };
  for (double least = total_energy(h); h.before(60);) {
    REQUIRE(h.step([] {}, couple) == 0u);
    double const now = total_energy(h);
    least = std::min(least, now);
    gain.of_motion = std::max(gain.of_motion, now / least - 1);
  }
  return gain;
}

}  // namespace

TEMPLATE_TEST_CASE("a kicked thread gains no energy", "[coupling][energy]", Slippery, Rough) {
  for (double mass : {1e-4, 1e-2, 1.0, 1e2, 1e4}) {
    Gain const gain = follow<TestType>(mass);
    CAPTURE(mass, gain.of_coupling, gain.of_motion);
    CHECK(gain.of_coupling < 1e-12);
    CHECK(gain.of_motion < 0.005);
  }
}
