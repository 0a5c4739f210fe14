// An effect that accelerates particles after they have given their momentum to the grid.
// expect: mpmpbd Effect: particle::Acceleration goes to the grid with the scatter
#include <mpmpbd/effects/concepts.hpp>

using namespace mpmpbd;

struct Pull {
  using Role = role::Effect;
  static constexpr FixedString name = "pull";
#ifdef MPMPBD_FIXED
  static constexpr Slot slot = Slot::before_scatter;
#else
  static constexpr Slot slot = Slot::after_gather;
#endif
  using Reads = Fields<particle::Position>;
  using Writes = Fields<particle::Acceleration>;
  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& p, K const&, Tick<T> const&) {
    p[particle::Acceleration{}] -= p[particle::Position{}];
  }
};

static_assert(check_effect<Pull>());
