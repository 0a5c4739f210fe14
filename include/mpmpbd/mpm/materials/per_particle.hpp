// PerParticle<Material>: the same law, its parameters stored with every particle instead of once per
// environment. For layered or random tissue, without a change to the material.
#pragma once

#include <mpmpbd/core/joined.hpp>
#include <mpmpbd/mpm/materials/forwards_update.hpp>

namespace mpmpbd {

// The field `PerParticle<M>::Values` holds the numbers in the order of M::parameter_info;
// `pack(k)` checks and makes them. Limits: parameter_count<M> more numbers to load per particle; a
// particle whose values were never set is all zeros: no stress.
template <class Material>
struct PerParticle : detail::ForwardsUpdate<PerParticle<Material>, Material> {
  static constexpr int count = static_cast<int>(parameter_count<Material>);
  static_assert(count > 0,
                "mpmpbd PerParticle<Material>: this material has no parameters; write the material "
                "itself");

  // Named after the material; several units, see parameter_info.
  struct Values : Field<Material::name, "mixed",
                        std::conditional_t<count == 1, Number, Numbers<count>>, Particles> {};

  using Role = role::Material;
  static constexpr FixedString name = joined(FixedString("per-particle "), Material::name);
  using Reads = union_t<typename Material::Reads, Fields<Values>>;
  using Writes = typename Material::Writes;
  static constexpr bool needs_positive_volume = requires {
    requires Material::needs_positive_volume;
  };

  // The value of the field for parameters k; throws std::invalid_argument naming what is out of bounds.
  template <class T> static value_t<Values, T> pack(parameters_t<Material, T> const& k) {
    check_parameters<Material, T>(k);
    value_t<Values, T> v{};
    auto const* from = reinterpret_cast<T const*>(&k);
    if constexpr (count == 1)
      v = *from;
    else
      for (int i = 0; i < count; ++i) v[i] = from[i];
    return v;
  }
  // The parameters of one particle.
  template <class P, class K> MPMPBD_HD static auto inner(P const& p, K const&) {
    using T = typename P::Scalar;
    parameters_t<Material, T> own{};
    auto* to = reinterpret_cast<T*>(&own);
    auto const& v = p[Values{}];
    if constexpr (count == 1)
      *to = v;
    else
      for (int i = 0; i < count; ++i) to[i] = v[i];
    return own;
  }

  template <class P, class K> MPMPBD_HD static auto kirchhoff(P const& p, K const& k) {
    return Material::kirchhoff(p, inner(p, k));
  }
  template <class P, class K> MPMPBD_HD static auto energy(P const& p, K const& k) {
    return Material::energy(p, inner(p, k));
  }
  template <class P, class K> MPMPBD_HD static auto stiffness(P const& p, K const& k) {
    return Material::stiffness(p, inner(p, k));
  }
};

}  // namespace mpmpbd
