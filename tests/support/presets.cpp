#include "support/presets.hpp"

#include <mpmpbd/io/config.hpp>

#include "support/preset_numbers.hpp"
#include "support/scenes.hpp"

namespace test {

mpmpbd::SuturingConfig preset(std::string const& name, std::vector<std::string> const& settings) {
  return mpmpbd::io::read_config<mpmpbd::SuturingConfig>(scenes() / (name + ".toml"), settings);
}

PresetNumbers preset_numbers(std::string const& name) {
  auto const c = preset(name);
  auto const lame = c.tissue.lame();
  auto const thread = c.thread.material();
  return {c.domain.cell_size,
          c.tissue.density,
          lame.lambda,
          lame.mu,
          thread.radius,
          thread.line_density(),
          thread.axial_stiffness(),
          c.contact.friction,
          c.contact.clamp_pressure,
          c.time.step / c.time.substeps};
}

}  // namespace test
