// A wall whose condition is no condition.
// expect: mpmpbd Wall<Condition, axis, side>: a condition gives
#include <mpmpbd/effects/walls.hpp>

using namespace mpmpbd;

struct Bouncy {
  static constexpr FixedString name = "bouncy";
#ifdef MPMPBD_FIXED
  template <class Node, class T> MPMPBD_HD static void hold(Node& n, int axis, T inward) {
    if (n[node::Velocity{}][axis] * inward < T(0)) n[node::Velocity{}][axis] *= T(-0.5);
  }
#endif
};

static_assert(check_effect<Wall<Bouncy, 2, Side::low>>());
