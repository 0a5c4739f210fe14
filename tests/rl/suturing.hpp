// The suturing task for tests: preset coarse, with or without differences between episodes.
#pragma once

#include <filesystem>

#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/io/config.hpp>
#include <mpmpbd/rl/suturing/expert.hpp>
#include <mpmpbd/rl/suturing/task.hpp>
#include <mpmpbd/rl/vector_env.hpp>

#include "support/scenes.hpp"

namespace test {

namespace rl = mpmpbd::rl;

inline rl::SuturingTaskConfig suturing_config(std::string const& scene,
                                              std::vector<std::string> const& settings = {}) {
  return mpmpbd::io::read_config<rl::SuturingTaskConfig>(
      std::vector<mpmpbd::io::Path>{scenes() / scene, scenes() / "suturing_task.toml"}, settings);
}
inline rl::SuturingTaskConfig without_differences(rl::SuturingTaskConfig c) {
  c.random = {.shift = 0.0,
              .turn_deg = 0.0,
              .height = c.random.height,
              .needle_radius = 1.0,
              .marker_shift = 0.0,
              .marker_closer = 0.0,
              .modulus = 1.0,
              .friction = 1.0,
              .thread_stiffness = 1.0,
              .camera_shift = 0.0,
              .colour = 1.0};
  return c;
}

}  // namespace test
