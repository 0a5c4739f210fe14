// Parts of a small task, from which those that must not compile are put together.
#pragma once

#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/rl/task.hpp>

using namespace mpmpbd;

struct Push {
  using Role = role::Action;
  static constexpr FixedString name = "push";
  static constexpr int size = 1;
  using Reads = Fields<>;
  using Writes = Fields<particle::Velocity>;
};
struct Height {
  using Role = role::Observation;
  static constexpr FixedString name = "height";
  static constexpr int size = 1;
  using Reads = Fields<particle::Position>;
  using Writes = Fields<>;
};
struct Up {
  using Role = role::RewardTerm;
  static constexpr FixedString name = "up";
  using Reads = Fields<particle::Position>;
  using Writes = Fields<>;
};
struct Block : Scene<Mpm<NeoHookean>> {};
