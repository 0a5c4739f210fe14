// A surface that moves by more than a column within a step.
#pragma once

#include <mpmpbd/catalog/suturing.hpp>

namespace test {

using namespace mpmpbd;

// The tip waits in the air, `ahead` [cells] of a block that flies towards it and moves by half a cell in the step.
template <class Run> TipState met(double ahead, int substeps, auto... where) {
  SuturingConfig c;
  double const dx = c.domain.cell_size;
  c.domain.size = {{2.5, 1.5, 1.5}};  // a grid for the shared memory of a block
  c.tissue.points = {{24, 12, 12}};
  c.tissue.corner = {{0.25, 0.25, 0.25}};
  c.tissue.corner[0] =
      20.6 * dx - c.tissue.size[0];  // its face is 0.4 cells before the next column
  auto options = suturing::options(c);
  options.substeps = substeps;
  Run run(options, where...);
  suturing::set_up(run, 0, c);
  auto& state = run.state();
  auto const speed = float(0.5 * dx / c.time.step);
  for (std::int64_t p = 0; p < state.template table<Particles>().live(0); ++p)
    state.template set<particle::Velocity>(0, p, {{speed, 0.0f, 0.0f}});

  auto const needles = state.template view<Needles>();
  auto pose = needle::pose(needles, 0);
  Arc<double> const d = c.needle.arc();
  Arc<float> const arc{float(d.radius), float(d.angle), float(d.wire_radius), float(d.taper)};
  Vec3<float> const wanted =
      cast<float>(c.tissue.corner + vec(c.tissue.size[0] + ahead * dx, 0.5 * c.tissue.size[1],
                                        0.5 * c.tissue.size[2]));
  pose.position += wanted - to_world(pose, arc.point(0.0f));
  needle::set_pose(needles, 0, pose);
  Tip<float>::at(wanted).store(needles, 0);
  run.step(c.time.step);
  return Tip<float>::load(run.state().template view<Needles>(), 0).state;
}

}  // namespace test
