// Colours for Gauss-Seidel: instances of one colour share no bead and no frame. Host, once, when a rod is made.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace mpmpbd {

// Greedy in the given order: every instance gets the lowest colour that none of its beads has yet, so the
// result depends on the instances alone. Along a thread, Distance needs 2 colours and Bend 3. Frames are numbered
// after the beads.
template <std::size_t points>
std::vector<int> colour_greedily(std::vector<std::array<std::int64_t, points>> const& instances,
                                 std::int64_t beads) {
  std::vector<std::vector<bool>> used(static_cast<std::size_t>(beads));
  auto has = [&](std::int64_t bead, std::size_t colour) {
    auto const& u = used[static_cast<std::size_t>(bead)];
    return colour < u.size() && u[colour];
  };
  std::vector<int> colours;
  colours.reserve(instances.size());
  for (auto const& one : instances) {
    std::size_t colour = 0;
    auto taken = [&] {
      for (auto b : one)
        if (has(b, colour)) return true;
      return false;
    };
    while (taken()) ++colour;
    for (auto b : one) {
      auto& u = used[static_cast<std::size_t>(b)];
      if (u.size() <= colour) u.resize(colour + 1, false);
      u[colour] = true;
    }
    colours.push_back(static_cast<int>(colour));
  }
  return colours;
}

}  // namespace mpmpbd
