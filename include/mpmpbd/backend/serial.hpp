// The serial back end: plain loops in order. The reference for every other back end.
#pragma once

#include <cstdint>

#include <mpmpbd/core/fixed_string.hpp>
#include <mpmpbd/core/wide.hpp>

namespace mpmpbd {

struct Serial {
  static constexpr FixedString name = "serial";
  static constexpr int grids = 1;  // of an environment, kept at a time

  Kernels kernels = Kernels::widest;

  int lanes() const { return 1; }

  // Calls f(i, lane) for every i in [0, count); nothing may depend on the order.
  template <class Function> void for_each(std::int64_t count, Function&& f) const {
    for (std::int64_t i = 0; i < count; ++i) f(i, 0);
  }
};

}  // namespace mpmpbd
