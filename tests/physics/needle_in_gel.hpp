// A needle in a block of gel. Without a surface: every point with gel around it is coupled, and the tip cuts
// for nothing.
#pragma once

#include "physics/back_end.hpp"
#include "physics/gel.hpp"

namespace test {

template <class... Laws>
struct NeedleInGel : Scene<Gel, ArcNeedle, Coupling<Embedded, Laws...>, Damping, Walls<Sticky>> {};

template <class S, class T, class Backend = BackEnd>
Simulation<S, Backend, T> gel_scene(GelBlock const& block, Arc<double> const& arc,
                                    Backend where = {}) {
  int const contacts = contact_points(ArcPoints<double>::over(arc, gel_cell));
  Simulation<S, Backend, T> run(
      block.options({{Needles::name.view(), 1}, {ContactPoints::name.view(), contacts}}), where);
  block.fill(run);
  if constexpr (!S::Needle::is_dynamic)
    run.template set<ArcNeedle>({arc.radius, arc.angle, arc.wire_radius, arc.taper, 0.0, 0.0});
  for (int e = 0; e < block.environments; ++e) {
    run.state().template table<ContactPoints>().set_live(e, contacts);
    run.state().template table<Needles>().set_live(e, 1);
  }
  return run;
}

// Environment `e` has one needle; its pose and twist are set from outside.
template <class Sim> void place_needle(Sim& run, std::int64_t e, Pose<double> const& pose) {
  needle::set_pose(run.state().template view<Needles>(), e, cast_pose<typename Sim::Scalar>(pose));
}
template <class Sim>
void drive_needle(Sim& run, std::int64_t e, Vec3<double> const& velocity,
                  Vec3<double> const& spin) {
  using T = typename Sim::Scalar;
  needle::set_twist(run.state().template view<Needles>(), e,
                    Twist<T>{cast<T>(velocity), cast<T>(spin)});
}

// A straight needle: an arc of 1000 times its length in radius, whose ends are 1/8000 of it beside a line.
inline Arc<double> straight_needle(double length, double wire_radius) {
  return {1e3 * length, 1e-3, wire_radius, 0.0};
}
// Its pose with the tip at a point, looking along `forward`; `aside` is across.
inline Pose<double> straight_pose(Arc<double> const& needle, Vec3<double> const& tip,
                                  Vec3<double> const& forward, Vec3<double> const& aside) {
  return {tip - needle.radius * aside,
          quaternion::from_axes(aside, forward, cross(aside, forward))};
}

}  // namespace test
