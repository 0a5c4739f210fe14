// expect: mpmpbd Mpm<...>: more than one material given; a body has one, write PerParticle<Material> for parameters that vary inside it
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>

#ifdef MPMPBD_FIXED
using Tissue = mpmpbd::Mpm<mpmpbd::FixedCorotated>;
#else
using Tissue = mpmpbd::Mpm<mpmpbd::NeoHookean, mpmpbd::FixedCorotated>;
#endif

int main() { return sizeof(mpmpbd::Scene<Tissue>) == 0; }
