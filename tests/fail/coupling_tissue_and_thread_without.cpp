// expect: mpmpbd Scene<...>: tissue and threads given but no coupling, so they would pass through each other; add Coupling<Embedded>
#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>

using namespace mpmpbd;

struct Tissue : Mpm<NeoHookean> {};
struct Suture : Pbd<Constraints<Distance>> {};
#ifdef MPMPBD_FIXED
struct Sewn : Scene<Tissue, Suture, Coupling<Embedded>> {};
#else
struct Sewn : Scene<Tissue, Suture> {};
#endif

int main() { return Sewn::has_rods ? 0 : 1; }
