// A material that reads a fibre direction without saying so.
// expect: mpmpbd: this policy uses a field that it does not declare
#include <mpmpbd/mpm/body.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>

using namespace mpmpbd;

struct Tendon : NeoHookean {
#ifdef MPMPBD_FIXED
  using Reads = Fields<particle::Deformation, particle::Fibre>;
#endif
  template <class P, class K> MPMPBD_HD static auto kirchhoff(P const& p, K const& k) {
    using T = typename P::Scalar;
    Vec3<T> const a = p[particle::Deformation{}] * p[particle::Fibre{}];
    return NeoHookean::kirchhoff(p, k) + k.mu * outer(a, a);
  }
};

using Material = Mpm<Tendon>::Material;
