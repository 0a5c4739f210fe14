// B48, bodies on which nothing acts; see random_scenes.hpp.
// seconds: 18
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/pic.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>

#include "stability/random_scenes.hpp"

using namespace test;
using namespace test::random_scenes;

namespace {

template <class... Policies> struct Free : Scene<Mpm<Policies...>> {};

using All = TypeList<Composed<Free<NeoHookean>>, Composed<Free<NeoHookean>, float>,
                     Composed<Free<StableNeoHookean, CubicBSpline, WeightGradient>>,
                     Composed<Free<FixedCorotated, Tpic, WeightGradient>>,
                     Composed<Free<NeoHookean, Flip, WeightGradient>>,
                     Composed<Free<PerParticle<StableNeoHookean>>>,
                     Composed<Free<FibreReinforced<>, Pic, CubicBSpline>>>;

}  // namespace

TEST_CASE("250 random bodies keep momentum and gain no energy", "[stability][B48]") {
  check(All{}, 250);
}
