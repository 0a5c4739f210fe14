// Viscous drag of a body that slides along its channel.
#pragma once

#include <array>

#include <mpmpbd/core/fixed_string.hpp>
#include <mpmpbd/core/parameters.hpp>

namespace mpmpbd {

// Force per length = coefficient * sliding speed; implicit in time, so it neither depends on dt nor
// reverses the sliding.
struct Drag {
  static constexpr FixedString name = "viscous drag";
  static constexpr bool drags = true;
  template <class T> struct Parameters {
    T coefficient;  // [N s/m^2]
  };
  static constexpr std::array<ParameterInfo, 1> parameter_info{
      {bound::not_negative("coefficient", "N s/m^2")}};
};

struct NoDrag {
  static constexpr FixedString name = "no drag";
  static constexpr bool drags = false;
};

}  // namespace mpmpbd
