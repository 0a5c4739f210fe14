// Numerical fracture: tissue that is stretched until its particles lie a cell apart gives way there and separates,
// whatever its material says. It is not a model of tearing, so it is reported (Fault::fracture).
//
// Measured (tests/stability/fracture.cpp): bars of 1, 2 and 3 particles per cell and axis, pulled slowly, part when
// their particles along the stretch are 0.97 to 1.16 cells apart, with quadratic and cubic splines alike. Within the
// support of the shape function, then: one particle per cell is too few to tell a stretch that varies from cell to cell.
#pragma once

#include <mpmpbd/core/sym_eigen.hpp>
#include <mpmpbd/mpm/lattice.hpp>

namespace mpmpbd {

// Whether a particle is stretched so far that the tissue is about to part: neighbours along its longest axis, cbrt(V0)
// apart at rest, are more than 0.95 cells apart. Tissue that is as coarse at rest may stretch by a tenth.
// Limits: it sees the deformation gradient, not the neighbours, so a gap that opens between two bodies is none.
template <class P> MPMPBD_HD bool is_torn(P const& p, typename P::Scalar dx) {
  using T = typename P::Scalar;
  auto const& F = p[particle::Deformation{}];
  T const most = max(T(0.857375) * dx * dx * dx / p[particle::Volume{}], T(1.331));  // stretch^3
  auto const beyond = [&](T stretch2) { return stretch2 * stretch2 * stretch2 > most * most; };
  return beyond(dot(F, F)) && beyond(symmetric_eigen(F * transpose(F)).values[0]);
}

}  // namespace mpmpbd
