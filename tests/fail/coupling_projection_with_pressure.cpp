// expect: mpmpbd GridProjection: its friction knows no pressure, only the lateral slip it stops
#include <mpmpbd/coupling/grid_projection.hpp>
#include <mpmpbd/coupling/tissue_pressure.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>

using namespace mpmpbd;

struct Tissue : Mpm<NeoHookean> {};
struct Suture : Pbd<Constraints<Distance>> {};
#ifdef MPMPBD_FIXED
struct Sewn : Scene<Tissue, Suture, Coupling<GridProjection, Friction>> {};
#else
struct Sewn : Scene<Tissue, Suture, Coupling<GridProjection, Friction, TissuePressure>> {};
#endif

int main() { return static_cast<int>(Sewn::Substep::Stages::size) - 4; }
