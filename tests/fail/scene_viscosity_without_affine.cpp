// expect: an effect reads the affine velocity C, which PIC and FLIP do not carry
#include <mpmpbd/effects/viscosity.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/pic.hpp>
#include <mpmpbd/scene/scene.hpp>

using namespace mpmpbd;

#ifdef MPMPBD_FIXED
struct Tissue : Mpm<NeoHookean> {};
#else
struct Tissue : Mpm<NeoHookean, Pic> {};
#endif
struct Sticky : Scene<Tissue, Viscosity> {};

int main() { return Sticky::has_body ? 0 : 1; }
