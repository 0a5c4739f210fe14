// Materials and effects that say branch_free compute on packs of particles what they compute on one.
#include "catch.hpp"

#include <mpmpbd/core/pack.hpp>
#include <mpmpbd/effects/viscosity.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/st_venant_kirchhoff.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>
#include <mpmpbd/testing/samples.hpp>

#if defined(MPMPBD_HAS_PACKS)
namespace {
using namespace mpmpbd;
using Eight = Pack<float>;

void set_lane(Mat3<Eight>& to, int lane, Mat3<float> const& from) {
  for (int i = 0; i < 9; ++i) to.m[i].v[lane] = from.m[i];
}
Mat3<float> get_lane(Mat3<Eight> const& from, int at) {
  Mat3<float> r{};
  for (int i = 0; i < 9; ++i) r.m[i] = lane(from.m[i], at);
  return r;
}
}  // namespace

TEMPLATE_TEST_CASE("materials give the same bits in packs", "[material][pack]", NeoHookean,
                   StableNeoHookean, StVenantKirchhoff) {
  using M = TestType;
  static_assert(M::branch_free);
  if (!has_wide_vectors()) return;
  testing::Samples random(61);
  Lame<float> const k{6.1e3f, 2.4e4f};
  for (int s = 0; s < 500; ++s) {
    Local<Eight, Fields<particle::Deformation>> eight{};
    Local<float, Fields<particle::Deformation>> one[8]{};
    for (int l = 0; l < 8; ++l) {  // with inverted particles among them
      auto const F =
          cast<float>(s % 3 != 0 ? random.deformation(0.3, 3.0) : random.matrix<3, 3>(-1.0, 1.0));
      one[l][particle::Deformation{}] = F;
      set_lane(eight[particle::Deformation{}], l, F);
    }
    auto const tau = M::kirchhoff(eight, k);
    for (int l = 0; l < 8; ++l) CHECK(get_lane(tau, l) == M::kirchhoff(one[l], k));
  }
}

TEST_CASE("viscosity gives the same bits in packs", "[effect][viscosity][pack]") {
  using E = Viscosity;
  if (!has_wide_vectors()) return;
  testing::Samples random(62);
  Tick<float> const tick{1e-4f, 1e-4f, 2};
  parameters_t<E, float> const k{12.0f};
  for (int s = 0; s < 100; ++s) {
    detail::Archetype<E, Eight> eight{};
    detail::Archetype<E, float> one[8]{};
    for (int l = 0; l < 8; ++l) {
      one[l][particle::Deformation{}] = cast<float>(random.deformation(0.3, 3.0));
      one[l][particle::Affine{}] = cast<float>(random.matrix<3, 3>(-40.0, 40.0));
      set_lane(eight[particle::Deformation{}], l, one[l][particle::Deformation{}]);
      set_lane(eight[particle::Affine{}], l, one[l][particle::Affine{}]);
      E::apply(one[l], k, tick);
    }
    E::apply(eight, k, tick);
    for (int l = 0; l < 8; ++l)
      CHECK(get_lane(eight[particle::Stress{}], l) == one[l][particle::Stress{}]);
  }
}
#else
TEST_CASE("no packs on this compiler", "[material][pack]") { SUCCEED(); }
#endif
