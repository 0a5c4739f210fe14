// expect: mpmpbd Mpm<...>: MLS forces need a shape function with constant inertia; write QuadraticBSpline or CubicBSpline, or take the force form WeightGradient
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/scene.hpp>

#ifdef MPMPBD_FIXED
using Tissue = mpmpbd::Mpm<mpmpbd::NeoHookean, mpmpbd::LinearBSpline, mpmpbd::WeightGradient>;
#else
using Tissue = mpmpbd::Mpm<mpmpbd::NeoHookean, mpmpbd::LinearBSpline, mpmpbd::Mls>;
#endif

int main() { return sizeof(mpmpbd::Scene<Tissue>) == 0; }
