// expect: mpmpbd Scene<...>: a needle given but no coupling, so it would touch nothing; add Coupling<Embedded>
#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>

using namespace mpmpbd;

struct Tissue : Mpm<NeoHookean> {};
#ifdef MPMPBD_FIXED
struct Insertion : Scene<Tissue, ArcNeedle, Coupling<Embedded>> {};
#else
struct Insertion : Scene<Tissue, ArcNeedle> {};
#endif

int main() { return Insertion::has_needle ? 0 : 1; }
