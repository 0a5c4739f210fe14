// expect: mpmpbd Mpm<...>: TPIC needs a shape function with continuous slope; write QuadraticBSpline or CubicBSpline, or take PIC, FLIP or APIC
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>
#include <mpmpbd/scene/scene.hpp>

#ifdef MPMPBD_FIXED
using Tissue = mpmpbd::Mpm<mpmpbd::NeoHookean, mpmpbd::QuadraticBSpline, mpmpbd::Tpic>;
#else
using Tissue = mpmpbd::Mpm<mpmpbd::NeoHookean, mpmpbd::LinearBSpline, mpmpbd::Tpic>;
#endif

int main() { return sizeof(mpmpbd::Scene<Tissue>) == 0; }
