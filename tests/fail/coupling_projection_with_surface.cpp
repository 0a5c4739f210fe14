// expect: mpmpbd GridProjection: a tip feels nothing here and nothing is punctured; take Surface out
#include <mpmpbd/coupling/grid_projection.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>
#include <mpmpbd/surface/surface.hpp>

using namespace mpmpbd;

struct Tissue : Mpm<NeoHookean> {};
#ifdef MPMPBD_FIXED
struct Insertion : Scene<Tissue, ArcNeedle, Coupling<GridProjection>> {};
#else
struct Insertion : Scene<Tissue, ArcNeedle, Surface, Coupling<GridProjection>> {};
#endif

int main() { return static_cast<int>(Insertion::Substep::Stages::size) - 4; }
