// expect: mpmpbd Scene<...>: a material, shape function, transfer scheme or force form belongs into the body; write Scene<Mpm<NeoHookean, ...>, ...>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>

#ifdef MPMPBD_FIXED
using Fall = mpmpbd::Scene<mpmpbd::Mpm<mpmpbd::NeoHookean>, mpmpbd::Gravity>;
#else
using Fall = mpmpbd::Scene<mpmpbd::NeoHookean, mpmpbd::Gravity>;
#endif

int main() { return sizeof(Fall) == 0; }
