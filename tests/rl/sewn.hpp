// A whole stitch by the expert and what came of it, for environments on the host, on an emulated device and on a GPU.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <mpmpbd/rl/suturing/expert.hpp>
#include <mpmpbd/surface/events.hpp>

namespace test {

struct Stitch {
  int decisions;
  std::int64_t phase;
  double entry_miss, exit_miss;  // [m]
  double force;                  // the largest on the needle [N]
  std::uint32_t status;
  std::vector<std::int64_t> events;  // their kinds
};

template <class Envs> Stitch sew(Envs&& envs) {
  namespace rl = mpmpbd::rl;
  rl::SuturingExperts experts(envs);
  Stitch stitch{};
  while (!envs.waits(0)) {
    envs.step(experts.act(envs));
    auto const wrench = envs.template newest<rl::NeedleWrench>(0);
    stitch.force =
        std::max(stitch.force, std::hypot(double(wrench[0]), double(wrench[1]), double(wrench[2])));
  }
  auto const& out = envs.outcome();
  stitch.decisions = out.episode_length[0];
  stitch.phase = std::int64_t(envs.template metric<rl::metric::Phase>(0));
  stitch.entry_miss = double(envs.template metric<rl::metric::EntryMiss>(0));
  stitch.exit_miss = double(envs.template metric<rl::metric::ExitMiss>(0));
  stitch.status = out.status[0];
  auto const& state = std::as_const(envs).simulation().state();
  for (std::int64_t i = 0; i < state.template get<mpmpbd::event::Count>(0); ++i)
    stitch.events.push_back(state.template get<mpmpbd::event::Kind>(0, i));
  return stitch;
}

}  // namespace test
