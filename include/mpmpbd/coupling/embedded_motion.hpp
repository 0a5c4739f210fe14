// The stages of `Embedded` that follow the exchange: surface and channels go with the tissue, the needle moves, and the
// tip's state advances.
#pragma once

#include <mpmpbd/coupling/embedded_exchange.hpp>
#include <mpmpbd/needle/kinematic.hpp>

namespace mpmpbd {

// Velocity of the tissue at a point, from nodes that have mass: linear fields are reproduced at the free
// surface too, so that the sheet does not lag behind.
template <class Shape, class Grid, class T> struct TissueVelocity {
  Grid const& grid;
  Lattice<T> lattice;

  MPMPBD_HD Vec3<T> operator()(Vec3<T> const& x) const {
    auto const mean =
        embedded_mean<Shape>(lattice, x, grid, [&](int node) { return grid.velocity(node); });
    return mean.mass > T(0) ? mean.value : averaged(x);
  }

 private:
  // Where the nodes with mass do not carry a linear field: their mean.
  MPMPBD_HD Vec3<T> averaged(Vec3<T> const& x) const {
    auto const near = detail::neighbourhood<Shape>(lattice, x);
    Vec3<T> v{};
    T sum = T(0);
    if (!near.inside) return v;
    detail::for_each_node<Shape>(lattice, near, [&](int, int i, T w, Vec3<T> const&) {
      if (!(grid.mass(i) > T(0))) return;
      v = add_product(v, w, grid.velocity(i));
      sum += w;
    });
    return sum > T(0) ? T(1) / sum * v : v;
  }
};

// Vertices of the surface, then the points of the tracks.
template <class In> struct MoveTracers {
  static constexpr FixedString name = "tracers";
  using Kind = kind::ItemWise;
  using Items = TypeList<SheetVertices, ChannelPoints>;
  using Parts = TypeList<Surface>;
  using Reads = union_t<Fields<node::Velocity, node::Mass, sheet::Position>, channel::State,
                        channel::PointState>;
  using Writes = union_t<Fields<sheet::Position>, channel::PointState>;

  template <class Env> MPMPBD_HD static int count(Env const& env) {
    return vertices(env) + detail::channels_of_environment(env).track_slots();
  }
  template <class Env, class Ctx, class Grid>
  MPMPBD_HD static void run(Env const& env, int item, Ctx const& context, Grid const& grid) {
    using T = typename Ctx::Scalar;
    TissueVelocity<typename In::Body::Shape, Grid, T> const velocity{grid, context.lattice};
    int const n = vertices(env);
    if (item < n) {
      advect(detail::row<sheet::Position>(env), item, velocity, context.tick.dt);
      if constexpr (detail::looks_where_it_moves<Grid>) look(env, item, context, grid);
    } else {
      detail::channels_of_environment(env).advect_track(item - n, velocity, context.tick.dt);
    }
  }

 private:
  template <class Env, class Ctx, class Grid>
  MPMPBD_HD static void look(Env const& env, int vertex, Ctx const& context, Grid const& grid) {
    using Exchange = ExchangeImpulses<In>;
    auto const n = Exchange::counts(env, context);
    EmbeddedArrays<typename Ctx::Scalar, typename Exchange::Form> a;
    a.cut(grid.scratch, n);
    auto const columns = detail::sheet_columns(n, context.lattice, a.column_first, a.column_item);
    if (detail::left_lists(detail::sheet_of_environment(env), vertex, columns, a))
      grid.add(*a.moved_vertices, 1);
  }
  template <class Env> MPMPBD_HD static int vertices(Env const& env) {
    return static_cast<int>(env.template live<SheetVertices>());
  }
};

template <class In> struct AdvanceNeedle {
  static constexpr FixedString name = "needle";
  using Kind = kind::Together;
  using Exchange = ExchangeImpulses<In>;
  using Needle = typename In::Needle;
  using Parts =
      join_t<TypeList<Needle>, std::conditional_t<In::has_surface, TypeList<Surface>, TypeList<>>>;
  using Reads = union_t<Fields<contact::Impulse>, needle::State>;
  using Writes = union_t<
      needle::State,
      typename Exchange::template if_t<In::has_surface, union_t<Surface::Writes, tip::Memory>>>;

  template <class Team_, class Env, class Ctx, class Grid>
  MPMPBD_HD static std::uint32_t run(Team_ const& team, Env const& env, Ctx const& context,
                                     Grid const& grid) {
    move_needle(team, env, context);
    if constexpr (In::has_surface)
      return advance_surface(team, env, context, grid);
    else
      return 0;
  }

 private:
  template <class Team_, class Env, class Ctx>
  MPMPBD_HD static void move_needle(Team_ const& team, Env const& env, Ctx const& context) {
    using T = typename Ctx::Scalar;
    team.one([&] {
      if (env.template live<Needles>() == 0) return;
      auto const& d = env.template domain<Needles>();
      if constexpr (Needle::is_dynamic) {
        auto pose = needle::pose(d.view, d.first);
        auto twist = needle::twist(d.view, d.first);
        Needle::body(context.template of<Needle>()).advance(pose, twist, context.tick.dt);
        needle::set_pose(d.view, d.first, pose);
        needle::set_twist(d.view, d.first, twist);
      } else {
        kinematic::finish_commanded(d.view, d.first, T(context.tick.dt));
      }
    });
    team.sync();
  }

  template <class Team_, class Env, class Ctx, class Grid>
  MPMPBD_HD static std::uint32_t advance_surface(Team_ const& team, Env const& env,
                                                 Ctx const& context, Grid const& grid) {
    using T = typename Ctx::Scalar;
    auto const n = Exchange::counts(env, context);
    EmbeddedArrays<T, typename Exchange::Form> a;
    a.cut(grid.scratch, n);
    auto const sheet = detail::sheet_of_environment(env);
    auto const columns = detail::sheet_columns(n, context.lattice, a.column_first, a.column_item);
    std::uint32_t faults = detail::renew_lists<Grid>(team, sheet, columns, a);
    if (n.needle_points == 0) return faults;
    team.groups(1, [&](auto const& group, int) {
      auto const& d = env.template domain<Needles>();
      auto const k = context.template of<Needle>();
      auto const pose = needle::pose(d.view, d.first);
      auto const arc = Needle::arc(k);
      int const tip = n.exchange().thread_points();
      // The tip pushes along its axis alone. That axis has turned with the needle meanwhile: the part along
      // the new one would never reach the cap of a needle that turns fast.
      T const impulse = norm(env.template get<contact::Impulse>(tip));
      auto const& events = env.template domain<Events>();
      auto const& e = env.template domain<Environments>();
      faults |= update_needle_surface(
          group, d.view, d.first, 0, to_world(pose, arc.point(T(0))), impulse, context.tick,
          context.tick.time, sheet, columns, context.lattice.dx,
          TipForces<T>{k.puncture_force, k.cutting_force}, marker_at(env, sheet, 0),
          marker_at(env, sheet, 1), detail::channels_of_environment(env),
          event_log(events.view, e.view, e.first));
    });
    team.sync();
    return faults;
  }

  // Where marker m is now (0: entry, 1: exit); infinitely far where the scene has set none, or the sheet has no such triangle.
  template <class Env, class S>
  MPMPBD_HD static auto marker_at(Env const& env, S const& sheet, int m) {
    using T = typename Env::Scalar;
    auto const& d = env.template domain<Markers>();
    Vec3<T> const nowhere = vec(infinity<T>, infinity<T>, infinity<T>);
    if (m >= d.count) return nowhere;
    SurfaceMark<T> const mark = marker::load(d.view, d.first + m);
    return mark.triangle >= 0 && mark.triangle < sheet.triangles ? position(sheet, mark) : nowhere;
  }
};

// What a scene has of them.
template <class In>
using FollowTissue =
    join_t<std::conditional_t<In::has_surface, TypeList<MoveTracers<In>>, TypeList<>>,
           std::conditional_t<In::has_needle, TypeList<AdvanceNeedle<In>>, TypeList<>>>;

}  // namespace mpmpbd
