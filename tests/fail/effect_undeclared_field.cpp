// An effect that uses the mass of a node without saying so.
// expect: mpmpbd: this policy uses a field that it does not declare
#include <mpmpbd/effects/gravity.hpp>

using namespace mpmpbd;

struct Lift {
  using Role = role::Effect;
  static constexpr FixedString name = "lift";
  static constexpr Slot slot = Slot::on_grid;
#ifdef MPMPBD_FIXED
  using Reads = Fields<node::Velocity, node::Mass>;
#else
  using Reads = Fields<node::Velocity>;
#endif
  using Writes = Fields<node::Velocity>;
  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& node, K const&, Tick<T> const& tick) {
    node[node::Velocity{}][2] += tick.dt / node[node::Mass{}];
  }
};

static_assert(check_effect<Lift>());
