// An after_update that nobody would call: the tick is missing.
// expect: mpmpbd MaterialModel: after_update cannot be called
#include <mpmpbd/mpm/body.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>

using namespace mpmpbd;

struct Fluid : NeoHookean {
  using Writes = Fields<particle::Deformation>;
#ifdef MPMPBD_FIXED
  template <class P, class K, class T>
  MPMPBD_HD static void after_update(P& p, K const&, Tick<T> const&){
#else
  template <class P, class K> MPMPBD_HD static void after_update(P& p, K const&) {
#endif
      p[particle::Deformation{}] *= 1;
}
}
;

using Material = Mpm<Fluid>::Material;
