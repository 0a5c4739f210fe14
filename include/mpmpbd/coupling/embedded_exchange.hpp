// The stage of `Embedded` that exchanges impulses: bodies into compact arrays, what every point is, the solve.
#pragma once

#include <mpmpbd/coupling/embedded_arrays.hpp>
#include <mpmpbd/coupling/embedded_fields.hpp>
#include <mpmpbd/coupling/thread_at_mouth.hpp>
#include <mpmpbd/needle/arc_needle.hpp>
#include <mpmpbd/needle/contact_points.hpp>
#include <mpmpbd/pbd/access.hpp>
#include <mpmpbd/pbd/constraints/attachment.hpp>
#include <mpmpbd/pbd/constraints/bend.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>
#include <mpmpbd/pbd/constraints/pin.hpp>
#include <mpmpbd/pbd/constraints/swage.hpp>
#include <mpmpbd/scene/rod_stage.hpp>
#include <mpmpbd/surface/surface.hpp>

namespace mpmpbd {

struct Embedded;

namespace detail {
template <class Rods, class C> inline constexpr bool has_constraint = Rods::Set::template has<C>;
template <class C> inline constexpr bool has_constraint<Absent, C> = false;

template <class F, class Env> MPMPBD_HD FieldRow<Env, F> row(Env const& env) { return {env}; }

// The sheet of an environment, and its columns (margin: a quarter of a cell).
template <class Env> MPMPBD_HD auto sheet_of_environment(Env const& env) {
  return make_sheet(row<sheet::Position>(env), env.template live<SheetVertices>(),
                    row<sheet::Corners>(env), env.template live<SheetTriangles>());
}
template <class T>
MPMPBD_HD auto sheet_columns(BodyCounts const& n, Lattice<T> const& lattice, IntegerRow first,
                             IntegerRow item) {
  return make_columns(Vec<T, 2>{}, lattice.dx, n.column_count[0], n.column_count[1],
                      T(0.25) * lattice.dx, first, item, n.column_items());
}
// Where a vertex is along x and y [m].
template <class S> MPMPBD_HD auto along_columns(S const& sheet, int vertex) {
  auto const x = sheet.vertex(vertex);
  return Vec<typename decltype(x)::Scalar, 2>{{x[0], x[1]}};
}
// Lists the triangles over the columns.
template <class Team_, class S, class C, class Arrays>
MPMPBD_HD std::uint32_t list_triangles(Team_ const& team, S const& sheet, C const& columns,
                                       Arrays const& a) {
  team.one([&] { *a.moved_vertices = 0; });
  each_loaded<8>(
      team, static_cast<int>(sheet.vertices), [&](int i) { return along_columns(sheet, i); },
      [&](int i, auto const& x) { a.listed_at[i] = x; });
  return columns.build(team, sheet);
}
// Whether a vertex has moved by more than the lists allow for since.
template <class S, class C, class Arrays>
MPMPBD_HD bool left_lists(S const& sheet, int vertex, C const& columns, Arrays const& a) {
  auto const d = along_columns(sheet, vertex) - a.listed_at[vertex];
  return max(abs(d[0]), abs(d[1])) > columns.margin;
}
// Whether vertices are looked at where they are moved: by many blocks of a device, where that of the coupling would look at one
// after the other while all others wait.
template <class Grid>
inline constexpr bool looks_where_it_moves = requires(Grid const& grid, int& counter) {
  grid.add(counter, 1);
};
// Lists them anew where one has.
template <class Grid, class Team_, class S, class C, class Arrays>
MPMPBD_HD std::uint32_t renew_lists(Team_ const& team, S const& sheet, C const& columns,
                                    Arrays const& a) {
  if constexpr (!looks_where_it_moves<Grid>) {
    each_loaded<16>(
        team, static_cast<int>(sheet.vertices),
        [&](int i) { return left_lists(sheet, i, columns, a); },
        [&](int, bool moved) {
          if (moved) team.add(*a.moved_vertices, 1);
        });
    team.sync();
  }
  if (*a.moved_vertices == 0) return 0;
  team.sync();
  return list_triangles(team, sheet, columns, a);
}
template <class Env> MPMPBD_HD auto channels_of_environment(Env const& env) {
  auto const& c = env.template domain<Channels>();
  return channel_set(c.view, env.template domain<ChannelPoints>().view, c.first / c.view.capacity);
}
}  // namespace detail

template <class In> struct ExchangeImpulses {
  static constexpr FixedString name = "exchange";
  using Kind = kind::Together;
  using Rods = typename In::Rods;
  using Needle = typename In::Needle;
  using Laws = typename In::Coupling;
  using Pressure = typename Laws::PressureLaw;
  using Shape = typename In::Body::Shape;
  using Forces = in_slot_t<Slot::before_solve, typename In::Effects>;
  using After = in_slot_t<Slot::after_solve, typename In::Effects>;
  using OnNeedle = in_slot_t<Slot::on_needle, typename In::Effects>;
  using OfEffects = join_t<Forces, OnNeedle, After>;
  using Parts = join_t<Forces, OnNeedle, typename Laws::Leaves, After>;

  static constexpr bool stretches = detail::has_constraint<Rods, Distance>;
  static constexpr bool pins = detail::has_constraint<Rods, Pin>;
  static constexpr bool attaches = detail::has_constraint<Rods, Attachment>;
  static constexpr bool bends = detail::has_constraint<Rods, Bend>;
  static constexpr bool swaged = detail::has_constraint<Rods, Swage>;
  using Form = EmbeddedForm<Shape, typename Laws::FrictionLaw, typename Laws::DragLaw, bends>;

  template <bool there, class List> using if_t = std::conditional_t<there, List, Fields<>>;
  using BeadState = Fields<bead::Position, bead::Velocity, bead::InverseMass, bead::Impulse,
                           bead::Tension, bead::PeakTension>;
  template <class R, bool there> struct InstancesOf {
    using type = union_t<typename R::Reads, typename R::Writes>;
  };
  template <class R> struct InstancesOf<R, false> { using type = Fields<>; };
  using Reads =
      union_t<Fields<node::Velocity, node::Mass, particle::Mass, particle::Volume>,
              if_t<In::has_rods, BeadState>, typename InstancesOf<Rods, In::has_rods>::type,
              typename Pressure::Reads, typename detail::ReadsOf<OfEffects>::type>;
  using Writes =
      union_t<Fields<node::Velocity, contact::Impulse, contact::Covered>,
              if_t<In::has_rods, BeadState>,
              if_t<In::has_needle, union_t<needle::State, needle::Report>>,
              if_t<In::has_surface,
                   union_t<Surface::Writes, tip::Memory, Fields<channel::Member<ContactPoints>>>>,
              typename detail::WritesOf<OfEffects>::type>;

  template <class Env, class Ctx>
  MPMPBD_HD static BodyCounts counts(Env const& env, Ctx const& context) {
    BodyCounts n;
    n.lattice_nodes = static_cast<int>(context.lattice.count());
    if constexpr (In::has_rods) n.beads = static_cast<int>(env.template live<Beads>());
    if constexpr (In::has_needle)
      if (env.template live<Needles>() > 0) n.needle_points = contact_points(arc_points(context));
    if constexpr (attaches)
      n.attached_points = static_cast<int>(env.template live<Instances<Attachment>>());
    if constexpr (In::has_surface) {
      n.triangles = env.template live<SheetTriangles>();
      n.vertices = static_cast<int>(env.template live<SheetVertices>());
      n.column_count[0] = context.lattice.nodes[0];
      n.column_count[1] = context.lattice.nodes[1];
    }
    n.fit(places(env));
    return n;
  }
  // The most that each of these numbers can become while the state lies on a device: a needle may grow there, and takes the
  // places of attachments.
  template <class Env, class Ctx>
  MPMPBD_HD static BodyCounts most(Env const& env, Ctx const& context) {
    BodyCounts n = counts(env, context);
    if constexpr (In::has_needle) {
      auto const left = static_cast<int>(places(env)) - n.exchange().thread_points();
      n.needle_points = max(n.needle_points, left);
    }
    return n;
  }
  // Whether the thread of this environment is tied to the needle: a scene may name `Swage` and have none yet.
  template <class Env> MPMPBD_HD static bool is_swaged([[maybe_unused]] Env const& env) {
    if constexpr (swaged)
      return env.template live<Instances<Swage>>() > 0;
    else
      return false;
  }
  template <class Env> MPMPBD_HD static std::int64_t places(Env const& env) {
    return env.template domain<ContactPoints>().view.capacity;
  }

  // Bytes of scratch for one environment.
  template <class Env, class Ctx>
  static std::size_t scratch_bytes(Env const& env, Ctx const& context) {
    using T = typename Ctx::Scalar;
    EmbeddedArrays<T, Form> a;
    BodyCounts const n = most(env, context);
    return a.cut(nullptr, n).used +
           Pressure::template bytes<T, Shape>(n.exchange().points(), n.lattice_nodes,
                                              env.template live<Particles>());
  }

  // Bytes of fast memory (FastMemory) that help.
  template <class Env, class Ctx>
  static std::size_t fast_bytes(Env const& env, Ctx const& context) {
    using T = typename Ctx::Scalar;
    EmbeddedArrays<T, Form> a;
    BodyCounts const n = most(env, context);
    FastMemory const all{nullptr, ~std::size_t{0}};
    return a.cut(nullptr, n, all).fast_used + work_alignment +
           exchange_fast_bytes<T, Form>(n.exchange());
  }

  template <class Team_, class Env, class Ctx, class Grid>
  MPMPBD_HD static std::uint32_t run(Team_ const& team, Env const& env, Ctx const& context,
                                     Grid const& grid) {
    using T = typename Ctx::Scalar;
    BodyCounts const n = counts(env, context);
    bool const has_thread = n.beads > 0;  // one that has no place rests as it is
    std::uint32_t faults = move_by_others(team, env, context, has_thread);
    if (n.overflow) faults |= static_cast<std::uint32_t>(Fault::overflow);
    EmbeddedArrays<T, Form> a;
    FastMemory fast;
    if constexpr (requires { grid.fast; }) fast = grid.fast;
    std::size_t const used = a.cut(grid.scratch, n, fast).used;
    team.one([&] { *a.view = view(env, context, n, a); });
    team.sync();
    auto& x = *a.view;
    auto const end = load_needle(team, env, context, x);
    load_points(team, env, x);
    load_thread(team, env, context, x, a);
    tie_thread(team, env, context, x, end);
    place_thread_points(team, x);
    place_needle_points(team, env, context, x);
    place_attachments(team, env, x);
    embed_points(team, x, grid);
    faults |= settle_points(team, env, context, x, a, n, grid);
    Pressure::template gather<Shape>(team, env, x, static_cast<char*>(grid.scratch) + used);
    faults |= exchange(team, x, grid);
    store(team, env, context, x);
    if constexpr (In::has_rods)
      if (has_thread) detail::apply_all_to_beads(After{}, team, env, context);
    return faults;
  }

 private:
  // What acts on thread and needle beside tissue, each other and the thread's stiffness: as velocity changes.
  template <class Team_, class Env, class Ctx>
  MPMPBD_HD static std::uint32_t move_by_others(Team_ const& team, Env const& env,
                                                Ctx const& context,
                                                [[maybe_unused]] bool has_thread) {
    std::uint32_t faults = 0;
    detail::apply_all_to_needle(OnNeedle{}, team, env, context);
    if constexpr (In::has_rods) {
      if (!has_thread) return faults;
      using Takes = typename Laws::Strategy::Takes;
      detail::apply_all_to_beads(Forces{}, team, env, context);
      if constexpr (without_t<typename Rods::Set::List, Takes>::size > 0) {
        faults |= Rods::predict(team, env, context.tick);
        faults |= Rods::template solve<Takes>(team, env, context.tick);
        faults |= Rods::finish_as_velocity(team, env, context.tick);
      }
    }
    return faults;
  }

  template <class Ctx> MPMPBD_HD static auto arc_points(Ctx const& context) {
    return ArcPoints<typename Ctx::Scalar>::over(Needle::arc(context.template of<Needle>()),
                                                 context.lattice.dx);
  }

  template <class Env, class Ctx, class Arrays>
  MPMPBD_HD static auto view(Env const& env, Ctx const& context, BodyCounts const& n,
                             Arrays const& a) {
    using T = typename Ctx::Scalar;
    ExchangeView<T, Form> x{};
    x.lattice = context.lattice;
    x.rest_density = env.template get<particle::Mass>(0) / env.template get<particle::Volume>(0);
    x.dt = context.tick.dt;
    x.previous_dt = context.tick.previous_dt;
    x.thread = {n.beads,       a.position,   a.velocity, a.mass, a.known,
                a.rest_length, a.rest_angle, a.impulse,  T(0),   T(0)};
    x.needle = a.needle;
    x.points = a.points;
    x.needle_points = n.needle_points;
    x.attached_points = n.attached_points;
    x.friction = context.template of<typename Laws::FrictionLaw>();
    x.drag = context.template of<typename Laws::DragLaw>();
    use_workspace(x, n.exchange(), a.exchange, a.exchange_fast);
    return x;
  }

  template <class Team_, class Env, class X>
  MPMPBD_HD static void load_points(Team_ const& team, Env const& env, X const& x) {
    using T = typename X::Scalar;
    team.each(x.count(), [&](int q) {
      ContactPoint<T>& p = x.points[q];
      p = {};
      p.impulse = env.template get<contact::Impulse>(q);
      p.contact = Contact::member;
    });
  }

  template <class Team_, class Env, class Ctx, class X, class Arrays>
  MPMPBD_HD static void load_thread(Team_ const& team, Env const& env,
                                    [[maybe_unused]] Ctx const& context, X& x, Arrays const& a) {
    using T = typename X::Scalar;
    if constexpr (In::has_rods) {
      if (x.thread.beads == 0) return;  // none, or left out: constraints know those of the scene
      team.each(x.thread.beads, [&](int k) {
        T const inverse_mass = env.template get<bead::InverseMass>(k);
        a.position[k] = env.template get<bead::Position>(k);
        a.velocity[k] = env.template get<bead::Velocity>(k);
        a.impulse[k] = env.template get<bead::Impulse>(k);
        a.known[k] = !(inverse_mass > T(0));
        a.mass[k] = inverse_mass > T(0) ? T(1) / inverse_mass : T(0);
        a.rest_length[k] = T(0);
        a.rest_angle[k] = T(0);
      });
      team.sync();
      load_segments(team, env, a);
      load_pins(team, env, a);
      team.sync();
      team.one([&] {
        x.thread.stretch_compliance = stretch_compliance<T>(env);
        x.thread.bending_stiffness = bending_stiffness<T>(env, a);
      });
      team.each(x.thread_points(),
                [&](int q) { x.points[q].radius = context.template of<Embedded>().thread_radius; });
    }
  }

  // Rest lengths and angles stand with the constraints, which are ordered by colour.
  template <class Team_, class Env, class Arrays>
  MPMPBD_HD static void load_segments(Team_ const& team, Env const& env, Arrays const& a) {
    if constexpr (stretches)
      team.each(static_cast<int>(env.template live<Instances<Distance>>()), [&](int i) {
        a.rest_length[env.template get<typename instance<Distance>::Index>(i)[0]] =
            load_parameters<Distance>(env, i).rest_length;
      });
    if constexpr (bends)
      team.each(static_cast<int>(env.template live<Instances<Bend>>()), [&](int i) {
        a.rest_angle[env.template get<typename instance<Bend>::Index>(i)[1]] =
            load_parameters<Bend>(env, i).rest_turn;
      });
  }
  // A pinned bead is one of known velocity.
  template <class Team_, class Env, class Arrays>
  MPMPBD_HD static void load_pins([[maybe_unused]] Team_ const& team,
                                  [[maybe_unused]] Env const& env,
                                  [[maybe_unused]] Arrays const& a) {
    using T = typename Env::Scalar;
    if constexpr (pins)
      team.each(static_cast<int>(env.template live<Instances<Pin>>()), [&](int i) {
        auto const b = env.template get<typename instance<Pin>::Index>(i);
        a.known[b] = true;
        a.velocity[b] = Vec3<T>{};
      });
  }
  // 1/EA [1/N] and EI [N m^2] of the threads, from their first segment and joint.
  template <class T, class Env> MPMPBD_HD static T stretch_compliance(Env const& env) {
    if constexpr (stretches)
      if (env.template live<Instances<Distance>>() > 0) {
        auto const k = load_parameters<Distance>(env, 0);
        return k.compliance / k.rest_length;
      }
    return T(0);
  }
  template <class T, class Env, class Arrays>
  MPMPBD_HD static T bending_stiffness([[maybe_unused]] Env const& env,
                                       [[maybe_unused]] Arrays const& a) {
    if constexpr (bends)
      if (env.template live<Instances<Bend>>() > 0) {
        auto const middle = env.template get<typename instance<Bend>::Index>(0)[1];
        T const length = T(0.5) * (a.rest_length[middle - 1] + a.rest_length[middle]);
        T const compliance = load_parameters<Bend>(env, 0).compliance;
        return compliance > T(0) ? length / compliance : T(0);
      }
    return T(0);
  }

  // By one lane, while others load points and thread. Returns the needle's blunt end, which that lane alone knows.
  template <class Team_, class Env, class Ctx, class X>
  MPMPBD_HD static auto load_needle(Team_ const& team, Env const& env,
                                    [[maybe_unused]] Ctx const& context, X const& x) {
    using T = typename X::Scalar;
    SwagePoint<T> end{};
    team.one([&] {
      RigidBody<T>& body = *x.needle;
      body = {};
      body.motion = Motion::absent;
      if constexpr (In::has_needle) {
        if (x.needle_points == 0) return;
        auto const& d = env.template domain<Needles>();
        auto const pose = needle::pose(d.view, d.first);
        auto const twist = needle::twist(d.view, d.first);
        if constexpr (Needle::is_dynamic)
          load_dynamic(body, Needle::body(context.template of<Needle>()), pose, twist,
                       is_swaged(env));
        else
          load_kinematic(body, pose, twist, x.dt);
        if constexpr (swaged)
          end = swage_point(Needle::arc(context.template of<Needle>()), pose,
                            Sweep<T>::of(pose, twist, x.dt));
      }
    });
    return end;
  }
  template <class T>
  MPMPBD_HD static void load_kinematic(RigidBody<T>& body, Pose<T> const& pose,
                                       Twist<T> const& twist, T dt) {
    auto const sweep = Sweep<T>::of(pose, twist, dt);
    body.motion = Motion::kinematic;
    body.centre = pose.position;
    body.velocity = sweep.linear;
    body.spin = sweep.angular;
  }
  template <class T>
  MPMPBD_HD static void load_dynamic(RigidBody<T>& body, NeedleBody<T> const& of,
                                     Pose<T> const& pose, Twist<T> const& twist, bool is_swaged) {
    body.motion = Motion::dynamic;
    body.swaged = is_swaged;
    body.centre = of.centre_of_mass(pose);
    body.velocity = of.velocity_of_centre(pose, twist);
    body.spin = twist.angular;
    body.mass = of.mass;
    for (int c = 0; c < 3; ++c) {
      Vec3<T> axis{};
      axis[c] = T(1);
      Vec3<T> const column = of.times_inertia(pose, axis);
      for (int r = 0; r < 3; ++r) body.inertia(r, c) = column[r];
    }
  }
  // The swaged bead sits at the blunt end; with a needle whose motion is given, its velocity is known.
  template <class Team_, class Env, class Ctx, class X, class T>
  MPMPBD_HD static void tie_thread(Team_ const& team, [[maybe_unused]] Env const& env,
                                   [[maybe_unused]] Ctx const& context, [[maybe_unused]] X& x,
                                   [[maybe_unused]] SwagePoint<T> const& end) {
    if constexpr (In::has_needle && swaged)
      team.one([&] {
        if (x.needle_points == 0 || !is_swaged(env)) return;
        auto const b = static_cast<int>(env.template get<typename instance<Swage>::Index>(0));
        if (b >= x.thread.beads) return;  // the thread is left out
        x.thread.position[b] = end.position;
        if constexpr (!Needle::is_dynamic) {
          x.thread.velocity[b] = end.velocity;
          const_cast<bool*>(x.thread.known)[b] = true;
        }
        hold_thread(env, context, x.thread, b);
      });
    team.sync();
  }
  // It leaves the needle as the wire ends.
  template <class Env, class Ctx, class T>
  MPMPBD_HD static void hold_thread(Env const& env, Ctx const& context, ThreadState<T>& thread,
                                    int bead) {
    auto const& d = env.template domain<Needles>();
    auto const arc = Needle::arc(context.template of<Needle>());
    Vec3<T> const tangent =
        quaternion::rotate(needle::pose(d.view, d.first).orientation, arc.tangent(arc.length()));
    thread.held = bead;
    thread.held_tangent = detail::is_segment(thread, bead) ? -tangent : tangent;
  }

  template <class Team_, class Env, class Ctx, class X>
  MPMPBD_HD static void place_needle_points(Team_ const& team, Env const& env, Ctx const& context,
                                            X const& x) {
    if constexpr (In::has_needle) {
      auto const& d = env.template domain<Needles>();
      auto const pose = needle::pose(d.view, d.first);
      auto const arc = Needle::arc(context.template of<Needle>());
      auto const points = arc_points(context);
      team.each(x.needle_points, [&](int i) {
        place_contact_point(x.points[x.thread_points() + i], i, arc, points, pose);
      });
      team.sync();
    }
  }

  template <class Team_, class Env, class X>
  MPMPBD_HD static void place_attachments(Team_ const& team, Env const& env, X const& x) {
    if constexpr (attaches) {
      team.each(x.attached_points, [&](int i) {
        auto& p = x.points[x.first_attached() + i];
        auto const b = static_cast<int>(env.template get<typename instance<Attachment>::Index>(i));
        p.segment = b + 1 < x.thread.beads ? b : b - 1;
        p.along = b == p.segment ? 0 : 1;
        p.position = x.thread.position[b];
        p.contact = Contact::tied;
      });
      team.sync();
    }
  }

  // What every point is. With a surface: by puncture and channel. Without: it is coupled where tissue is.
  template <class Team_, class Env, class Ctx, class X, class Arrays, class Grid>
  MPMPBD_HD static std::uint32_t settle_points(Team_ const& team, Env const& env,
                                               Ctx const& context, X const& x, Arrays const& a,
                                               BodyCounts const& n, Grid const& grid) {
    using T = typename X::Scalar;
    std::uint32_t faults = 0;
    if constexpr (In::has_surface) {
      auto const sheet = detail::sheet_of_environment(env);
      auto const columns = detail::sheet_columns(n, context.lattice, a.column_first, a.column_item);
      auto const channels = detail::channels_of_environment(env);
      if (context.tick.substep == 0) faults |= detail::list_triangles(team, sheet, columns, a);
      auto const member = detail::row<channel::Member<ContactPoints>>(env);
      team.each(2 * x.thread_points(), [&](int i) {
        int const k = i / 2, side = i % 2 == 0 ? side_before : side_after;
        detail::thread_place(a.aside, k, side) = detail::look_aside(x, grid, k, side);
      });
      team.sync();
      auto const& d = env.template domain<Needles>();
      update_members(
          team, x.points, x.thread_points(), x.needle_points, is_swaged(env),
          [&](int k, int side) { return detail::thread_place(a.aside, k, side); }, member,
          Tip<T>::load(d.view, d.first), channels, 0, sheet, context.lattice.dx, a.following);
      team.sync();
      team.each(x.thread_points(), [&](int k) {
        if (detail::hold_at_mouth(x, a.aside, member, k, 1) ||
            detail::hold_at_mouth(x, a.aside, member, k, -1))
          embed_point(x, grid, k);
      });
      team.sync();
      team.groups(x.first_attached(), [&](auto const& group, int q) {
        faults |= settle_point(group, x.points, q, x.thread_points(), channels, 0, sheet, columns,
                               context.lattice.dx);
      });
      team.sync();
      detail::hand_over_impulses(team, x, member);
    } else {
      team.each(x.first_attached(), [&](int q) {
        auto& p = x.points[q];
        bool const tip = x.needle_points > 0 && q == x.thread_points();
        if (tip)
          p.contact = Contact::off;
        else if (p.contact == Contact::member && !(p.coverage >= T(ChannelLimits::coverage)))
          p.contact = Contact::off;
      });
    }
    team.sync();
    return faults;
  }

  template <class Team_, class Env, class Ctx, class X>
  MPMPBD_HD static void store(Team_ const& team, Env const& env, Ctx const& context, X const& x) {
    team.each(x.count(), [&](int q) {
      env.template set<contact::Impulse>(q, x.points[q].impulse);
      env.template set<contact::Covered>(q, x.points[q].coverage);
    });
    if constexpr (In::has_rods)
      team.each(x.thread.beads, [&](int k) { store_bead(env, context, x, k); });
    if constexpr (In::has_needle)
      team.one([&] {
        if (x.needle_points > 0) store_needle(env, context, x);
      });
    team.sync();
  }
  template <class Env, class Ctx, class X>
  MPMPBD_HD static void store_bead(Env const& env, Ctx const& context, X const& x, int k) {
    using T = typename X::Scalar;
    env.template set<bead::Position>(k, x.thread.position[k]);
    env.template set<bead::Velocity>(k, x.thread.velocity[k]);
    env.template set<bead::Impulse>(k, x.thread.impulse[k]);
    bool const first = context.tick.substep == 0;
    T const now = tension(x, k);
    T const mean = first ? T(0) : env.template get<bead::Tension>(k);
    T const peak = first ? now : max(now, env.template get<bead::PeakTension>(k));
    env.template set<bead::Tension>(k, mean + now / T(context.tick.substeps));
    env.template set<bead::PeakTension>(k, peak);
  }
  template <class Env, class Ctx, class X>
  MPMPBD_HD static void store_needle(Env const& env, Ctx const& context, X const& x) {
    using T = typename X::Scalar;
    auto const& d = env.template domain<Needles>();
    auto const pose = needle::pose(d.view, d.first);
    if constexpr (Needle::is_dynamic) {
      auto const body = Needle::body(context.template of<Needle>());
      Vec3<T> const spin = x.needle->spin;
      needle::set_twist(d.view, d.first,
                        Twist<T>{x.needle->velocity - cross(spin, body.arm(pose)), spin});
    }
    // Everything is loaded before anything is stored: a device waits once then.
    bool const first = context.tick.substep == 0;
    auto const before = [&]<class F>(F) {
      return first ? value_t<F, T>{} : env.template get<F>(0);
    };
    Vec3<T> const force = before(needle::Force{}), moment = before(needle::Moment{});
    T const at_tip = before(needle::TipForce{}), peak = before(needle::PeakForce{}),
            pull = before(needle::ThreadPull{});
    T const share = T(1) / T(context.tick.substeps);
    auto const w = needle_wrench(x, pose.position);
    env.template set<needle::Force>(0, force + share * w.force);
    env.template set<needle::Moment>(0, moment + share * w.moment);
    ContactPoint<T> const& tip = x.points[x.thread_points()];
    env.template set<needle::TipForce>(0, at_tip + share * (dot(tip.axis, tip.impulse) / x.dt));
    T const size = norm(w.force);
    env.template set<needle::PeakForce>(0, first ? size : max(size, peak));
    T const now = is_swaged(env) && x.thread.beads > 1 ? tension(x, x.thread.beads - 2) : T(0);
    env.template set<needle::ThreadPull>(0, pull + share * now);
  }
};

}  // namespace mpmpbd
