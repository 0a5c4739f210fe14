// How the suturing scene is set up from its configuration.
#pragma once

#include <mpmpbd/catalog/suturing_config.hpp>
#include <mpmpbd/catalog/suturing_scene.hpp>
#include <mpmpbd/geometry/polyline.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/simulation.hpp>

namespace mpmpbd {

namespace suturing {

// The thread at the start: down from the needle's blunt end, then along the top of the tissue beside the
// needle's way, towards the side where the needle goes in. From there it is drawn after the needle.
inline std::vector<Vec3<double>> thread_line(SuturingConfig const& c) {
  auto const path = c.path();
  auto const pose = c.script().start;
  auto const end =
      swage_point(c.needle.arc(), pose, Sweep<double>::of(pose, {}, c.time.step)).position;
  Vec3<double> const back = -direction(c.exit() - c.entry()), aside = -path.axis;
  double const above = 0.1 * c.domain.cell_size + c.thread.radius;
  Vec3<double> const foot = end - (dot(end - c.entry(), path.up) - above) * path.up;
  double const r = c.needle.radius;
  Vec3<double> const way[] = {end, foot + 0.5 * r * aside, foot + 0.9 * r * aside + 0.5 * r * back,
                              foot + 0.9 * r * aside + c.thread.length * back};
  std::vector<Vec3<double>> line(static_cast<std::size_t>(c.thread.beads));
  walk_polyline(way, 4, c.thread.segment(), c.thread.beads, [&](std::int64_t i, auto const& x) {
    line[line.size() - 1 - static_cast<std::size_t>(i)] = x;  // the last bead is at the needle
  });
  return line;
}

inline RodAssembly<Suture> thread(SuturingConfig const& c) {
  RodAssembly<Suture> rod;
  auto const line = thread_line(c);
  auto const made =
      add_thread(rod, std::span<Vec3<double> const>(line.data(), line.size()), c.thread.material());
  auto const blunt = c.needle.arc().point(c.needle.arc().length());
  rod.add<Swage>({made.last - 1}, {blunt[0], blunt[1], blunt[2], 0.0});
  return rod;
}

// The tissue's surface, a vertex per cell edge.
inline SheetMesh<double> surface_mesh(SuturingConfig const& c) {
  Vec3<int> cells{};
  for (int a = 0; a < 3; ++a)
    cells[a] = std::max(1, static_cast<int>(std::lround(c.tissue.size[a] / c.domain.cell_size)));
  return box_sheet(Box<double>{c.tissue.corner, c.tissue.corner + c.tissue.size}, cells);
}

inline SimulationOptions options(SuturingConfig const& c, std::int64_t environments = 1) {
  SimulationOptions o;
  o.environments = environments;
  o.cell_size = c.domain.cell_size;
  for (int a = 0; a < 3; ++a) o.nodes[a] = c.domain.nodes()[a];
  o.substeps = c.time.substeps;
  auto const mesh = surface_mesh(c);
  int const needle_points =
      contact_points(ArcPoints<double>::over(c.needle.arc(), c.domain.cell_size));
  o.capacity = thread(c).capacity();
  for (Capacity const& more : std::initializer_list<Capacity>{
           {Particles::name.view(), c.tissue.point_count()},
           {Needles::name.view(), 1},
           {ContactPoints::name.view(), c.thread.beads + needle_points},
           {SheetVertices::name.view(), static_cast<std::int64_t>(mesh.positions.size())},
           {SheetTriangles::name.view(), static_cast<std::int64_t>(mesh.triangles.size())},
           {Markers::name.view(), 2},
           {Events::name.view(), 16},
           {Channels::name.view(), 2},
           {ChannelPoints::name.view(), 2 * 128}})
    o.capacity.push_back(more);
  return o;
}

// Puts one environment into the state at the start of a stitch.
template <class Sim> void set_up(Sim& sim, std::int64_t env, SuturingConfig const& c) {
  using T = typename Sim::Scalar;
  auto& state = sim.state();
  sim.template set<NeoHookean>(env, c.tissue.lame());
  sim.template set<Viscosity>(env, {c.tissue.viscosity});
  sim.template set<Gravity>(env, {{c.domain.gravity[0], c.domain.gravity[1], c.domain.gravity[2]}});
  sim.template set<Air>(env, {c.thread.air});
  sim.template set<Floor>(env, {c.tissue.corner[2]});
  sim.template set<ArcNeedle>(env, c.needle.parameters());
  sim.template set<Embedded>(env, {c.thread.radius});
  sim.template set<Friction>(env, {c.contact.friction, c.contact.clamp_pressure});
  sim.template set<Drag>(env, {c.contact.drag});
  auto const points = c.tissue.positions();
  sim.add_particles(env, points, c.tissue.density, c.tissue.point_volume());
  thread(c).write(state, env);
  state.template table<ContactPoints>().set_live(env,
                                                 state.template table<ContactPoints>().capacity());

  auto const mesh = surface_mesh(c);
  load_sheet(mesh, state.template table<SheetVertices>(), state.template table<SheetTriangles>(),
             env);
  state.template table<Markers>().set_live(env, 2);
  auto const view = state.template view<Markers>();
  auto const sheet = sheet_of(mesh);
  auto mark = [&](std::int64_t m, Vec3<double> const& x) {
    auto const at = mark_at(sheet, x);
    marker::store(view, env * view.capacity + m, SurfaceMark<T>{at.triangle, cast<T>(at.weights)});
  };
  mark(0, c.entry());
  mark(1, c.exit());

  state.template table<Needles>().set_live(env, 1);
  auto const needles = state.template view<Needles>();
  std::int64_t const item = env * needles.capacity;
  auto const start = c.script().start;
  needle::set_pose(needles, item, cast_pose<T>(start));
  Tip<T>::at(cast<T>(to_world(start, c.needle.arc().point(0.0)))).store(needles, item);
}

// Takes the coupling away: a surface without triangles is never met, so neither needle nor thread touches
// tissue. What a stitch is judged by has to fail then.
template <class Sim> void uncouple(Sim& sim, std::int64_t env) {
  sim.state().template table<SheetTriangles>().set_live(env, 0);
}

}  // namespace suturing

}  // namespace mpmpbd
