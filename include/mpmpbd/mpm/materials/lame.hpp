// The two constants of an isotropic solid, and their conversion from Young's modulus and Poisson's ratio.
#pragma once

#include <array>

#include <mpmpbd/core/matrix.hpp>
#include <mpmpbd/core/parameters.hpp>

namespace mpmpbd {

template <class T> struct Lame {
  T mu;      // shear modulus [Pa]
  T lambda;  // first Lame constant [Pa]
};

inline constexpr std::array<ParameterInfo, 2> lame_info{
    {bound::positive("mu", "Pa"), bound::not_negative("lambda", "Pa")}};

// Lame constants [Pa] of a solid with Young's modulus E [Pa] and Poisson's ratio nu.
// Refuses E <= 0 and nu outside [0, 0.5): throws std::invalid_argument.
template <class T = double> Lame<T> lame(double young_modulus, double poisson_ratio) {
  check_parameter("elastic solid", bound::positive("young_modulus", "Pa"), young_modulus);
  check_parameter("elastic solid", {"poisson_ratio", "1", 0.0, 0.5, true, false}, poisson_ratio);
  double const mu = young_modulus / (2 * (1 + poisson_ratio));
  double const lambda =
      young_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
  return {static_cast<T>(mu), static_cast<T>(lambda)};
}

// An upper bound of the largest eigenvalue of b = F F^T, from its two first invariants: mean +
// sqrt(2/3) |dev b|. The same for R F, exact at rest and in uniaxial stretch, at most 4/3 too large.
template <class T> MPMPBD_HD T largest_stretch_squared(Mat3<T> const& F) {
  T scale = T(0);  // entries of F/scale are at most 1, so nothing overflows before the result does
  for (int i = 0; i < 9; ++i) scale += abs(F.m[i]);
  if (!(scale > T(0))) return scale;
  Mat3<T> const G = T(1) / scale * F;
  Mat3<T> const b = G * transpose(G);
  T const size = multiply_add(T(0.81649658092772603), norm(deviator(b)), T(1) / 3 * trace(b));
  return scale * (scale * size);
}

}  // namespace mpmpbd
