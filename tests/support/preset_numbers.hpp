// Numbers of a preset of the stitch, for sources that nvcc reads too: fmt and file formats are beyond it.
#pragma once

#include <string>

namespace test {

struct PresetNumbers {
  double cell_size, density, lambda, mu;                              // [m], [kg/m^3], [Pa]
  double thread_radius, thread_line_density, thread_axial_stiffness;  // [m], [kg/m], [N]
  double friction, clamp_pressure;                                    // -, [Pa]
  double substep;                                                     // [s]
};
// Of examples/scenes/<name>.toml.
PresetNumbers preset_numbers(std::string const& name);

}  // namespace test
