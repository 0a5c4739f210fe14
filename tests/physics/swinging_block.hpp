// A block on a floor that swings under gravity, for about three of its periods.
#pragma once

#include <mpmpbd/effects/walls.hpp>

#include "stability/block.hpp"

namespace test {

template <class Material, class... Policies>
struct Swinging : Scene<Mpm<Material, Policies...>, Gravity, Wall<Sticky, 2, Side::low>> {};

inline constexpr double swinging_step = 3e-4;  // [s]
inline constexpr int swinging_steps = 600;
// `amplitude`: of gravity, in terrestrial ones downwards and a third of that sideways.
template <class S, class T, class Backend = Serial> Block<S, T, Backend> swung(double amplitude) {
  BlockCase const c{.low = vec(4.13, 4.27, 3.0)};
  Block<S, T, Backend> block(c, lame(1e4, 0.4));
  block.run.template set<Gravity>({{amplitude * 3.0, 0.0, amplitude * -9.81}});
  block.run.template set<Wall<Sticky, 2, Side::low>>({3 * c.cell});
  for (int s = 0; s < swinging_steps; ++s) block.run.step(swinging_step);
  return block;
}

}  // namespace test
