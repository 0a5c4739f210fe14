// B48, bodies under loads in a box; see random_scenes.hpp.
// seconds: 10
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/st_venant_kirchhoff.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>

#include "stability/random_scenes.hpp"

using namespace test;
using namespace test::random_scenes;

namespace {

template <class Body_, class... Loads> struct Boxed : Scene<Body_, Gravity, Loads...> {};

using All =
    TypeList<Composed<Boxed<Mpm<NeoHookean>, Walls<Sticky>>>,
             Composed<Boxed<Mpm<NeoHookean>, Walls<Sticky>>, float>,
             Composed<Boxed<Mpm<FixedCorotated, CubicBSpline>, Walls<Slip>>>,
             Composed<Boxed<Mpm<StableNeoHookean, Flip>, Damping, Walls<Separating>>>,
             Composed<Boxed<Mpm<WeaklyCompressibleFluid>, Viscosity, StrainWork, Walls<Slip>>>,
             Composed<Boxed<Mpm<StVenantKirchhoff, Tpic>, PinnedRegion, Walls<Separating>>>,
             Composed<Boxed<Mpm<NeoHookean>, Prony<1>, StrainWork, Walls<Separating>>>>;

}  // namespace

TEST_CASE("250 random bodies under loads stay in their box and gain no energy",
          "[stability][B48]") {
  check(All{}, 250);
}
