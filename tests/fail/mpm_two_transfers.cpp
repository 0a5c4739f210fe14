// expect: mpmpbd Mpm<...>: more than one transfer scheme given; keep one of them
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/pic.hpp>
#include <mpmpbd/scene/scene.hpp>

#ifdef MPMPBD_FIXED
using Tissue = mpmpbd::Mpm<mpmpbd::NeoHookean, mpmpbd::MlsApic>;
#else
using Tissue = mpmpbd::Mpm<mpmpbd::NeoHookean, mpmpbd::Pic, mpmpbd::MlsApic>;
#endif

int main() { return sizeof(mpmpbd::Scene<Tissue>) == 0; }
