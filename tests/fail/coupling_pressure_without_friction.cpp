// expect: mpmpbd Coupling<Strategy, laws...>: a pressure given but no friction that it could add to; add Friction
#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/coupling/tissue_pressure.hpp>

using namespace mpmpbd;

#ifdef MPMPBD_FIXED
using Laws = Coupling<Embedded, Friction, TissuePressure>;
#else
using Laws = Coupling<Embedded, TissuePressure>;
#endif

int main() { return Laws::PressureLaw::squeezes ? 0 : 1; }
