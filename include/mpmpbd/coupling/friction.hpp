// Coulomb friction between tissue and whatever is embedded in it.
#pragma once

#include <array>

#include <mpmpbd/core/fixed_string.hpp>
#include <mpmpbd/core/parameters.hpp>

namespace mpmpbd {

// Axial impulse of a point up to mu (|lateral impulse| + p 2 pi r ds dt): the tissue grips by its
// lateral load and by its clamp pressure p = max(0, clamp_pressure + tissue pressure).
// Without this policy a thread slides freely along itself.
struct Friction {
  static constexpr FixedString name = "Coulomb friction";
  static constexpr bool grips = true;
  template <class T> struct Parameters {
    T coefficient;     // mu
    T clamp_pressure;  // of an unloaded channel [Pa]
  };
  static constexpr std::array<ParameterInfo, 2> parameter_info{
      {bound::not_negative("coefficient", "1"), bound::any("clamp_pressure", "Pa")}};
};

struct NoFriction {
  static constexpr FixedString name = "no friction";
  static constexpr bool grips = false;
};

}  // namespace mpmpbd
