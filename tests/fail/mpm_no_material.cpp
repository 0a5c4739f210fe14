// expect: mpmpbd Mpm<...>: no material given; add one, for example Mpm<NeoHookean>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>

#ifdef MPMPBD_FIXED
using Tissue = mpmpbd::Mpm<mpmpbd::NeoHookean, mpmpbd::Apic>;
#else
using Tissue = mpmpbd::Mpm<mpmpbd::Apic>;
#endif

int main() { return sizeof(mpmpbd::Scene<Tissue>) == 0; }
