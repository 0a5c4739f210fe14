// expect: mpmpbd Coupling<Strategy, laws...>: a law is a friction (grips), a drag (drags) or a pressure (squeezes), for example Coupling<Embedded, Friction, Drag, TissuePressure>
#include <mpmpbd/coupling/embedded.hpp>

using namespace mpmpbd;

struct Lubricated {
  static constexpr FixedString name = "lubricated";
#ifdef MPMPBD_FIXED
  static constexpr bool grips = false;
#endif
};
using Laws = Coupling<Embedded, Lubricated>;

int main() { return Laws::FrictionLaw::grips ? 1 : 0; }
