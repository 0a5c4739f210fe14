// Nothing to store per particle.
// expect: mpmpbd PerParticle<Material>: this material has no parameters
#include <mpmpbd/mpm/body.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/per_particle.hpp>

using namespace mpmpbd;

struct Dust {
  using Role = role::Material;
  static constexpr FixedString name = "dust";
  using Reads = Fields<>;
  using Writes = Fields<>;
  template <class P, class K> MPMPBD_HD static auto kirchhoff(P const&, K const&) {
    return Mat3<typename P::Scalar>{};
  }
  template <class P, class K> MPMPBD_HD static auto energy(P const&, K const&) {
    return typename P::Scalar{};
  }
  template <class P, class K> MPMPBD_HD static auto stiffness(P const&, K const&) {
    return Stiffness<typename P::Scalar>{};
  }
};

#ifdef MPMPBD_FIXED
using Material = Mpm<Dust>::Material;
#else
using Material = Mpm<PerParticle<Dust>>::Material;
#endif
