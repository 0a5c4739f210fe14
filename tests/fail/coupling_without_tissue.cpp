// expect: mpmpbd Scene<...>: a coupling given but no tissue; add a body, for example Mpm<NeoHookean>
#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>

using namespace mpmpbd;

struct Tissue : Mpm<NeoHookean> {};
struct Suture : Pbd<Constraints<Distance>> {};
#ifdef MPMPBD_FIXED
struct Sewn : Scene<Tissue, Suture, Coupling<Embedded>> {};
#else
struct Sewn : Scene<Suture, Coupling<Embedded>> {};
#endif

int main() { return Sewn::has_body ? 0 : 1; }
