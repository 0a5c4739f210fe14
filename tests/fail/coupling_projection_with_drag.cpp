// expect: mpmpbd GridProjection: its drag is a share of the slip per substep, the parameter drag_factor
#include <mpmpbd/coupling/grid_projection.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>

using namespace mpmpbd;

struct Tissue : Mpm<NeoHookean> {};
struct Suture : Pbd<Constraints<Distance>> {};
#ifdef MPMPBD_FIXED
struct Sewn : Scene<Tissue, Suture, Coupling<GridProjection, Friction>> {};
#else
struct Sewn : Scene<Tissue, Suture, Coupling<GridProjection, Friction, Drag>> {};
#endif

int main() { return static_cast<int>(Sewn::Substep::Stages::size) - 4; }
