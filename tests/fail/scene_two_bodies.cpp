// expect: mpmpbd Scene<...>: more than one Mpm body given; a scene has one body of material points
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>

using Tissue = mpmpbd::Mpm<mpmpbd::NeoHookean>;
#ifdef MPMPBD_FIXED
using Both = mpmpbd::Scene<Tissue>;
#else
using Both = mpmpbd::Scene<Tissue, mpmpbd::Mpm<mpmpbd::NeoHookean, mpmpbd::CubicBSpline>>;
#endif

int main() { return sizeof(Both) == 0; }
