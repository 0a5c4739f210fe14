// The scripted hand: tells the needle, step by step, how to move so that it keeps to a script.
#pragma once

#include <mpmpbd/catalog/suturing.hpp>
#include <mpmpbd/needle/script.hpp>

namespace mpmpbd::suturing {

struct ScriptedHand {
  Script script;

  // The needle's motion during the next `h` [s]: from where it is to where the script wants it at `time` + h.
  template <class Sim> void command(Sim& sim, std::int64_t env, double time, double h) const {
    using T = typename Sim::Scalar;
    auto const needles = sim.state().template view<Needles>();
    std::int64_t const item = env * needles.capacity;
    auto const now = needle::pose(needles, item);
    auto const twist =
        twist_between(Pose<double>{cast<double>(now.position), cast<double>(now.orientation)},
                      script.pose(time + h), h);
    needle::set_twist(needles, item, Twist<T>{cast<T>(twist.linear), cast<T>(twist.angular)});
  }
};

}  // namespace mpmpbd::suturing
