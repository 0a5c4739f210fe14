// expect: mpmpbd Simulation: the scene does not store this field; a policy that names it in Reads or Writes makes it state
// A view of directions of fibres, of a material that has none.
#include <mpmpbd/backend/cuda.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>

using namespace mpmpbd;

#ifdef MPMPBD_FIXED
using Seen = particle::Velocity;
#else
using Seen = particle::Fibre;
#endif

Array look(Simulation<Scene<Mpm<NeoHookean>>, Cuda, float>& run) { return run.array<Seen>(); }

int main() {}
