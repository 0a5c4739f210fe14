// Reports tissue that is stretched farther than its particles can tell: numerical fracture.
#pragma once

#include <array>

#include <mpmpbd/core/status.hpp>
#include <mpmpbd/core/sym_eigen.hpp>
#include <mpmpbd/effects/concepts.hpp>

namespace mpmpbd {

// Tissue whose particles lie about a cell apart gives way there and separates, whatever its material says. That is no
// model of tearing, so a scene that names this effect sets Fault::fracture when a principal stretch of a particle is
// larger than `most`, once per step; environment::FaultCount counts the steps. It changes nothing.
// Measured (tests/stability/fracture.cpp): bars of 1, 2 and 3 particles per cell and axis that are pulled slowly part when
// their particles along the stretch are 0.97 to 1.16 cells apart, with quadratic and cubic splines alike. So not beyond
// the support of the shape function: one particle per cell cannot tell a stretch that varies from cell to cell.
// Limits: it sees the deformation gradient and knows before the tissue parts; the gap itself it does not see.
struct StretchLimit {
  using Role = role::Effect;
  static constexpr FixedString name = "stretch limit";
  static constexpr Slot slot = Slot::before_scatter;
  static constexpr bool branch_free = true;
  using Reads = Fields<particle::Deformation>;
  using Writes = Fields<>;

  template <class T> struct Parameters {
    T most;  // principal stretch [1]
  };
  static constexpr std::array<ParameterInfo, 1> parameter_info{{bound::positive("most", "1")}};

  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item&, K const&, Tick<T> const&) {}

  // At the start of each step.
  template <class Item, class K> MPMPBD_HD static std::uint32_t faults(Item const& p, K const& k) {
    auto const& F = p[particle::Deformation{}];
    auto const most = k.most * k.most;
    bool const beyond = dot(F, F) > most && symmetric_eigen(F * transpose(F)).values[0] > most;
    return beyond ? static_cast<std::uint32_t>(Fault::fracture) : 0;
  }

  // The limit for particles that are `spacing` [m] apart at rest in cells of `cell_size` [m]: 0.95 cells. Particles as far
  // apart as that at rest may be stretched by a tenth.
  template <class T = double> static Parameters<T> of(double spacing, double cell_size) {
    return {static_cast<T>(max(0.95 * cell_size / spacing, 1.1))};
  }
};

}  // namespace mpmpbd
