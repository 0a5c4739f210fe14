// Newtonian viscosity of a fluid, or of a Kelvin-Voigt solid: tau += 2 eta J dev(sym L).
#pragma once

#include <array>

#include <mpmpbd/effects/concepts.hpp>

namespace mpmpbd {

// L is the affine velocity C that APIC and TPIC carry, so the effect composes with these two alone
// (`needs_affine`); PIC and FLIP never write C. Power 2 eta J |dev sym L|^2 >= 0.
// Limits: explicit. With c = damping(p, k), G = D^-1 dx^2 and omega^2 = G bulk3 / (rho0 dx^2), a single
// particle is stable for dt < 2/omega (sqrt(1 + xi^2) - xi), xi = G c / (2 rho0 dx^2 omega).
struct Viscosity {
  using Role = role::Effect;
  static constexpr FixedString name = "viscosity";
  static constexpr Slot slot = Slot::before_scatter;
  static constexpr bool needs_affine = true;
  static constexpr bool branch_free = true;
  using Reads = Fields<particle::Deformation, particle::Affine, particle::Stress>;
  using Writes = Fields<particle::Stress>;

  template <class T> struct Parameters {
    T eta;  // dynamic viscosity [Pa s]
  };
  static constexpr std::array<ParameterInfo, 1> parameter_info{
      {bound::not_negative("eta", "Pa s")}};

  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& p, K const& k, Tick<T> const&) {
    auto const& C = p[particle::Affine{}];
    auto const rate = deviator(C + transpose(C));
    p[particle::Stress{}] =
        add_product(p[particle::Stress{}], k.eta * determinant(p[particle::Deformation{}]), rate);
  }

  // Largest eigenvalue of dtau/dL [Pa s]: what a time step limit needs.
  template <class Item, class K> MPMPBD_HD static auto damping(Item const& p, K const& k) {
    return 2 * k.eta * abs(determinant(p[particle::Deformation{}]));
  }
};

}  // namespace mpmpbd
