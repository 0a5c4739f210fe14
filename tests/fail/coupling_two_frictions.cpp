// expect: mpmpbd Coupling<Strategy, laws...>: two laws of the same kind given; keep one friction, one drag and one pressure
#include <mpmpbd/coupling/embedded.hpp>

using namespace mpmpbd;

struct Sticky : Friction {};
#ifdef MPMPBD_FIXED
using Laws = Coupling<Embedded, Friction>;
#else
using Laws = Coupling<Embedded, Friction, Sticky>;
#endif

int main() { return Laws::FrictionLaw::grips ? 0 : 1; }
