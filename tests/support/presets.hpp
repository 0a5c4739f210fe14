// The presets of the stitch.
#pragma once

#include <string>
#include <vector>

#include <mpmpbd/catalog/suturing_config.hpp>

namespace test {

// examples/scenes/<name>.toml, changed by `settings` as on a command line.
mpmpbd::SuturingConfig preset(std::string const& name,
                              std::vector<std::string> const& settings = {});

}  // namespace test
