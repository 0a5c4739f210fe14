// expect: mpmpbd Mpm<...>: takes a material, a shape function, a transfer scheme and a force form; effects, rods and couplings belong to the Scene
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>

#ifdef MPMPBD_FIXED
using Fall = mpmpbd::Scene<mpmpbd::Mpm<mpmpbd::NeoHookean>, mpmpbd::Gravity>;
#else
using Fall = mpmpbd::Scene<mpmpbd::Mpm<mpmpbd::NeoHookean, mpmpbd::Gravity>>;
#endif

int main() { return sizeof(Fall) == 0; }
