// A3.7 of verification.md: 14 segments whose ends are led into an arc of 60 degrees share the turn (a case of Newton).
// seconds: 1
// on a device
#include "catch.hpp"
#include "physics/framed_at_rest.hpp"

using namespace rods;

namespace {
struct Body : Pbd<Cosserat, DirectFrames<3>> {};
int const segments = 14;
double const l = 0.1, EI = 400 * l, GJ = 1000 * l;  // [m], [N m^2]

// The last segment of a thread whose 13 joints turn by `turn` each, in the x-y plane: its ends.
std::array<V3, 2> led_to(double turn) {
  V3 x{}, before{};
  for (int i = 0; i < segments; ++i) {
    before = x;
    x += l * vec(std::cos(turn * i), std::sin(turn * i), 0.0);
  }
  return {before, x};
}
}  // namespace

TEST_CASE("A3.7: a thread that is led into an arc bends evenly", "[bend][frames][physics]") {
  auto line = straight({{0, 0, 0}}, {{segments * l, 0, 0}}, segments + 1);
  line[6][2] += 1e-3 * l;  // a little out of the plane
  RodAssembly<Body> rod;
  add_framed_thread(rod, line, thin_wire(EI, GJ, 0.7, 2e-3));
  hold_segment(rod, 0, 0);
  hold_segment(rod, segments - 1, segments - 1);
  Simulated<Body> rig(rod);

  double const turn = pi<double> / 3 / (segments - 1),
               unit = square(segments * l) * std::sqrt(0.7 / EI), h = 2e-3 * unit;
  int const leading = 1000;
  for (int s = 1; s <= 4 * leading; ++s) {
    double const part = std::min(1.0, double(s) / leading);
    auto const ends = led_to(part * turn);
    for (int e = 0; e < 2; ++e) {
      auto const b = segments - 1 + e;
      rig.store.set<bead::Velocity>(0, b, 1 / h * (ends[static_cast<std::size_t>(e)] - rig.x(b)));
    }
    double const rate = s <= leading ? pi<double> / 3 / (leading * h) : 0.0;
    rig.store.set<frame::AngularVelocity>(0, segments - 1, {{0, 0, rate}});
    rig.step(h, 0.0);
    slow_down(rig, std::exp(-10 * h / unit));
  }
  CHECK(rig.faults == 0);

  double squares = 0, most = 0, out = 0, stretch = 0;
  double const degree = pi<double> / 180;
  for (int f = 1; f < segments; ++f) {
    auto const c = joint(frame_at(rig, f - 1), frame_at(rig, f)).value;
    double const error = std::hypot(c[0], c[1]) - turn;
    squares += square(error);
    most = max(most, abs(error));
    stretch = max(stretch, abs(norm(rig.x(f) - rig.x(f - 1)) / l - 1));
    out = max(out, abs(rig.x(f)[2]));
  }
  double const rms = std::sqrt(squares / (segments - 1));
  CAPTURE(rms / degree, most / degree, out, stretch);
  CHECK(rms < 0.12 * degree);
  CHECK(most < 0.22 * degree);
  CHECK(out < 1e-4);
  CHECK(stretch < 1e-3);
}
