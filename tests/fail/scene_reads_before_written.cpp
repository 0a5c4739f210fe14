// expect: mpmpbd Pipeline: a stage reads a field that is neither state nor written by an earlier stage; move the stage later, or add the stage that writes it
// An effect that looks at the velocity gradient before anything has computed it.
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>

struct Looks {
  using Role = mpmpbd::role::Effect;
  static constexpr mpmpbd::FixedString name = "looks";
  static constexpr mpmpbd::Slot slot = mpmpbd::Slot::before_scatter;
#ifdef MPMPBD_FIXED
  using Reads = mpmpbd::Fields<mpmpbd::particle::Stress>;
#else
  using Reads = mpmpbd::Fields<mpmpbd::particle::Gradient>;  // known after the gather only
#endif
  using Writes = mpmpbd::Fields<>;
  template <class Item, class K, class T>
  static void apply(Item&, K const&, mpmpbd::Tick<T> const&) {}
};

int main() { return sizeof(mpmpbd::Scene<mpmpbd::Mpm<mpmpbd::NeoHookean>, Looks>) == 0; }
