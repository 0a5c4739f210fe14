// The work done on each particle's material: what it does not store as strain energy has been dissipated.
#pragma once

#include <mpmpbd/effects/concepts.hpp>

namespace mpmpbd {

namespace particle {
struct StrainWork : Field<"W", "J", Number, Particles> {};  // since its first substep
// F and P = tau F^-T of the substep before, where the last piece of the path began.
struct WorkDeformation : Field<"F_W", "1", Matrix, Particles> {};
struct WorkStress : Field<"P_W", "Pa", Matrix, Particles> {};
}  // namespace particle

// W += V0 (P_old + P)/2 : (F - F_old), the trapezoidal rule along the path of F: second order, and the energy's
// exact difference for a quadratic energy. Name it after the effects whose stresses it is to count (viscosity,
// Prony): then sum W - sum V0 psi(F) is what the material has dissipated, at least 0 for a passive one.
// Counts from the first substep in which it acts; det F = 0 adds nothing.
struct StrainWork {
  using Role = role::Effect;
  static constexpr FixedString name = "strain work";
  static constexpr Slot slot = Slot::before_scatter;
  using Reads = Fields<particle::Deformation, particle::Stress, particle::Volume,
                       particle::StrainWork, particle::WorkDeformation, particle::WorkStress>;
  using Writes = Fields<particle::StrainWork, particle::WorkDeformation, particle::WorkStress>;

  template <class Item, class T>
  MPMPBD_HD static void apply(Item& p, detail::NoParameters const&, Tick<T> const&) {
    auto const& F = p[particle::Deformation{}];
    auto& before = p[particle::WorkDeformation{}];
    if (!(abs(determinant(F)) > T(0))) return;
    auto const P = p[particle::Stress{}] * transpose(inverse(F));
    if (dot(before, before) > T(0))  // zero until it has acted once
      p[particle::StrainWork{}] +=
          T(0.5) * p[particle::Volume{}] * dot(p[particle::WorkStress{}] + P, F - before);
    before = F;
    p[particle::WorkStress{}] = P;
  }
};

}  // namespace mpmpbd
