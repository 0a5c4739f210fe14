// How time goes in a task: settings that every task has.
#pragma once

#include <mpmpbd/io/config_keys.hpp>

namespace mpmpbd::rl {

struct EpisodeConfig {
  int decision_interval = 20;
  int limit = 200;
  int frames = 1;

  void declare(ConfigKeys& keys) {
    keys(decision_interval, bound::between("decision_interval", "1", 1, 100000),
         "steps of the scene for one decision of the agent");
    keys(limit, bound::between("limit", "1", 1, 100000000),
         "decisions after which an episode is cut off");
    keys(frames, bound::between("frames", "1", 1, 64),
         "observations that are shown: the present one and those before it");
  }
  bool operator==(EpisodeConfig const&) const = default;
};

}  // namespace mpmpbd::rl
