// What every disc in free flight keeps.
#pragma once

#include "catch.hpp"
#include "physics/spinning_disc.hpp"

namespace test {

template <int cells_per_radius, class... Policies> Outcome fly(double revolutions = 1.0) {
  auto const o = spin(Disc<Mpm<FixedCorotated, Policies...>, cells_per_radius>(), revolutions);
  UNSCOPED_INFO("spin - 1 = " << o.spin - 1.0 << ", after 100 steps " << o.spin_100 << " (PIC "
                              << o.pic << "), kinetic " << o.kinetic << ", lost " << o.lost
                              << ", momentum " << o.momentum);
  CHECK(o.momentum < o.rounding);
  CHECK(o.status == 0);
  return o;
}

}  // namespace test
