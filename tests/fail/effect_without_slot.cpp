// An effect that does not say where in the substep it acts.
// expect: mpmpbd Effect: say where it acts
#include <mpmpbd/effects/gravity.hpp>

using namespace mpmpbd;

struct Wind {
  using Role = role::Effect;
  static constexpr FixedString name = "wind";
#ifdef MPMPBD_FIXED
  static constexpr Slot slot = Slot::on_grid;
#endif
  using Reads = Fields<node::Velocity>;
  using Writes = Fields<node::Velocity>;
  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& node, K const&, Tick<T> const& tick) {
    node[node::Velocity{}][0] += tick.dt;
  }
};

static_assert(check_effect<Wind>());
