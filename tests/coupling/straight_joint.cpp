// A joint that is exactly straight has no plane of its own, and is as stiff as one that is nearly so.
#include "catch.hpp"

#include <mpmpbd/coupling/thread_blocks.hpp>

using namespace mpmpbd;

namespace {
// The stiffness of a joint of two segments of 3 and 5 mm along (1, 2, -2)/3, whose last bead is moved aside.
Mat3<double> stiffness(Vec3<double> const& aside, int a, int b) {
  Vec3<double> const along = 1.0 / 3 * vec(1.0, 2.0, -2.0);
  Vec3<double> x[] = {{}, 3e-3 * along, 8e-3 * along + aside};
  double const rest[] = {3e-3, 5e-3, 0.0}, mass[] = {1e-5, 1e-5, 1e-5};
  bool const known[] = {false, false, false};
  ThreadState<double> s{};
  s.beads = 3;
  s.position = x;
  s.mass = mass;
  s.known = known;
  s.rest_length = rest;
  s.bending_stiffness = 4e-7;
  Link<double> links[3] = {};
  double length[3] = {};
  for (int k = 0; k < 2; ++k) {
    length[k] = norm(x[k + 1] - x[k]);
    links[k].direction = direction(x[k + 1] - x[k]);
  }
  return detail::joint_block(detail::bend_joint(s, links, length, 1), a, b, 1e-3);
}
}  // namespace

TEST_CASE("a straight joint resists bending in every direction", "[coupling][bend]") {
  Vec3<double> const one = vec(2.0, -1.0, 0.0), other = vec(2.0, 4.0, 5.0);  // across the joint
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      auto const straight = stiffness({}, a, b);
      CHECK(norm(straight) > 0.0);
      for (double const size : {1e-16, 1e-12, 1e-9})
        for (auto const& aside : {size * one, size * other}) {
          CAPTURE(a, b, size);
          CHECK(norm(stiffness(aside, a, b) - straight) < 1e-5 * norm(straight));
        }
    }
}
