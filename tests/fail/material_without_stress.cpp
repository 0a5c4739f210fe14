// A material that forgot its stress.
// expect: mpmpbd MaterialModel: give the Kirchhoff stress [Pa]
#include <mpmpbd/mpm/body.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>

using namespace mpmpbd;

struct Gel {
  using Role = role::Material;
  static constexpr FixedString name = "gel";
  using Reads = Fields<particle::Deformation>;
  using Writes = Fields<>;
  template <class T> using Parameters = Lame<T>;
  static constexpr auto parameter_info = lame_info;

#ifdef MPMPBD_FIXED
  template <class P, class K> MPMPBD_HD static auto kirchhoff(P const& p, K const& k) {
    return NeoHookean::kirchhoff(p, k);
  }
#endif
  template <class P, class K> MPMPBD_HD static auto energy(P const& p, K const& k) {
    return NeoHookean::energy(p, k);
  }
  template <class P, class K> MPMPBD_HD static auto stiffness(P const& p, K const& k) {
    return NeoHookean::stiffness(p, k);
  }
};

using Material = Mpm<Gel>::Material;
