// A3.9 of verification.md: a thread that hangs between two points is a catenary, also with a little EI.
// seconds: 1
// on a device
#include "catch.hpp"
#include "physics/rods_at_rest.hpp"

using namespace rods;

namespace {
struct Body : Pbd<Constraints<Distance, Bend>, DirectBanded<4>> {};
double const span = 0.83, line_density = 3.7e-3;
int const segments = 64;

struct Hung {
  double sag, support;  // in spans, and in weights of a span
};
// From a V of the right length, both ends held.
Hung hang(double over_span, double bending_stiffness) {
  double const depth = 0.5 * span * std::sqrt(square(over_span) - 1);
  Line const vee{{{0, 0.1, 0.4}}, {{0.5 * span, 0.1, 0.4 - depth}}, {{span, 0.1, 0.4}}};
  // EA = 4 EI / r^2 is a million weights of a span: inextensible.
  double const weight = line_density * gravity * span;
  auto const wire =
      thin_wire(bending_stiffness, line_density, 2e-3 * std::sqrt(bending_stiffness / weight));
  RodAssembly<Body> rod;
  add_thread(rod, vee, segments + 1, wire);
  rod.prescribe(0);
  rod.prescribe(segments);
  Simulated<Body> rig(rod);
  double const unit = std::sqrt(span / gravity);
  CHECK(settle(
      rig, 0.02 * unit, 3 / unit, 1e-8 * span / unit, 6000, [](auto&, double) {}, gravity));
  CHECK(rig.faults == 0);
  CHECK(rig.residual<Distance>() < 1e-9 * span);
  // The support holds the first link and the half segment that hangs on the fixed bead itself.
  double const l = over_span * span / segments;
  V3 const along_link = direction(rig.x(1) - rig.x(0));
  V3 const pull = -rig.store.get<instance<Distance>::Multiplier>(0, 0) * along_link -
                  vec(0.0, 0.0, 0.5 * line_density * gravity * l);
  return {(0.4 - rig.x(segments / 2)[2]) / span, norm(pull) / weight};
}
}  // namespace

TEST_CASE("A3.9: a thread between two points hangs as a catenary", "[constraint][physics]") {
  struct Row {
    double over_span, a, sag;  // the catenary a cosh(x/a), in spans
  };
  double const weight = line_density * gravity * span;
  for (auto const& row :
       {Row{1.25, 0.4227523489, 0.3317968864}, Row{1.5, 0.3082364697, 0.5026332616}})
    for (double stiffness :
         {1e-9, 1e-6}) {  // of weight x span^2: boundary layers of 5e-5 and 2e-3 spans
      auto const thread = hang(row.over_span, stiffness * weight * square(span));
      CAPTURE(row.over_span, stiffness, thread.sag, thread.support);
      CHECK(thread.sag == Approx(row.sag).epsilon(2e-3));
      CHECK(thread.support == Approx(row.a + row.sag).epsilon(2e-3));
    }
}
