// GridProjection: the reference scheme - grid nodes near a line take its velocity, the line feels it later.
//
// Needle and thread are lines, a piece of thread between two beads being a line of its own. A node within
// `contact_radius` of a line that comes nearer to it takes the line's lateral velocity and keeps its axial
// one. What it lost is an impulse on the first bead of the piece that acts in the next substep, after which
// the rod's own solver moves the thread.
//
// It is kept to compare with, and for lines that nothing pushes back at. Its limits, each an expected value
// of tests/physics/grid_projection*.cpp and tests/coupling/grid_projection*.cpp:
//   - a pull along the line meets no friction: only nodes that come nearer are gripped;
//   - drag takes a share of the slip per substep: its force grows as 1/dt;
//   - a line between the nodes finds none of them ahead: thin threads cut through (radius below 1.12 dx);
//   - of the points around a joint that bends by 90 degrees a quarter is missed, a quarter is hit twice;
//   - the first bead of a piece gets all of its impulse: the moment J x (x_i - x_c) is lost, and a thread
//     numbered from its other end moves differently;
//   - a thread lighter than the nodes it moves explodes: the slip grows by -(node mass / bead mass) per
//     substep, since the thread learns of the tissue's mass one substep late;
//   - the tip feels nothing: no puncture, no cutting, no channel.
// Linear momentum is conserved when the impulses under way are counted; nothing else is.
#pragma once

#include <mpmpbd/coupling/coupling.hpp>
#include <mpmpbd/coupling/embedded_fields.hpp>
#include <mpmpbd/needle/arc_needle.hpp>
#include <mpmpbd/needle/kinematic.hpp>
#include <mpmpbd/needle/points.hpp>
#include <mpmpbd/pbd/access.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>
#include <mpmpbd/pbd/constraints/swage.hpp>
#include <mpmpbd/scene/rod_stage.hpp>

namespace mpmpbd {

// Momentum that the tissue has lost to a body and that the body gets in the next substep.
namespace bead {
struct Recoil : Field<"recoil", "N s", Vector, Beads> {};
}  // namespace bead
namespace needle {
struct Recoil : Field<"recoil", "N s", Vector, Needles> {};
struct RecoilMoment : Field<"recoil_moment", "N m s", Vector, Needles> {
};  // about the arc's centre
}  // namespace needle

// A line as one grid node sees it.
template <class T> struct NearLine {
  bool near;         // within the contact radius, and between the ends of the line
  Vec3<T> velocity;  // of the line where it is nearest [m/s]
  Vec3<T> axis;      // of the line there, unit
  Vec3<T> away;      // from there to the node [m]
};

namespace detail {

// The velocity of a node after contact. On the line itself every direction comes nearer.
template <class T>
MPMPBD_HD Vec3<T> projected(NearLine<T> const& line, Vec3<T> const& u, T friction, T drag_factor) {
  Vec3<T> const slip = u - line.velocity;
  T along = dot(slip, line.axis);
  Vec3<T> lateral = slip - along * line.axis;
  along *= 1 - drag_factor;
  if (dot(lateral, line.away) < T(0) || dot(line.away, line.away) == T(0)) {
    T const grip = friction * norm(lateral);
    along = abs(along) > grip ? along - (along > T(0) ? grip : -grip) : T(0);
    lateral = {};
  }
  return line.velocity + along * line.axis + lateral;
}

template <class T>
MPMPBD_HD NearLine<T> near_segment(Vec3<T> const& x, Vec3<T> const& a, Vec3<T> const& b,
                                   Vec3<T> const& va, Vec3<T> const& vb, T radius) {
  NearLine<T> line{};
  Vec3<T> const chord = b - a;
  T const length = norm(chord);
  if (!(length > T(0))) return line;
  line.axis = T(1) / length * chord;
  T const s = dot(x - a, line.axis) / length;
  line.away = x - a - (s * length) * line.axis;
  line.velocity = (1 - s) * va + s * vb;
  line.near = s >= T(0) && s <= T(1) && !(norm(line.away) > radius);
  return line;
}

template <class T>
MPMPBD_HD NearLine<T> near_arc(Vec3<T> const& x, Arc<T> const& arc, Pose<T> const& pose,
                               Sweep<T> const& sweep, T radius) {
  NearLine<T> line{};
  T const s = arc.nearest(to_body(pose, x));
  Vec3<T> const foot = to_world(pose, arc.point(s));
  line.axis = quaternion::rotate(pose.orientation, arc.tangent(s));
  line.away = x - foot;
  line.velocity = sweep.mean_velocity(foot);
  line.near = s > T(0) && s < arc.length() && !(norm(line.away) > radius);
  return line;
}

// Projects the nodes of a box (widened by the contact radius) onto a line, in the order of the lattice.
// took(x, J): the node at x lost J.
template <class T, class Grid, class Line, class Took>
MPMPBD_HD void project_nodes(Lattice<T> const& lattice, Grid const& grid, Vec3<T> const& low,
                             Vec3<T> const& high, T radius, T friction, T drag_factor,
                             Line const& line_near, Took const& took) {
  int first[3], end[3];
  for (int a = 0; a < 3; ++a) {
    if (!is_finite(low[a] + high[a])) return;
    T const top = T(lattice.nodes[a] - 1);
    first[a] = static_cast<int>(clamp(ceil((low[a] - radius) * lattice.inverse_dx), T(0), top + 1));
    end[a] =
        static_cast<int>(clamp(floor((high[a] + radius) * lattice.inverse_dx), T(-1), top)) + 1;
  }
  for (int k = first[2]; k < end[2]; ++k)
    for (int j = first[1]; j < end[1]; ++j)
      for (int i = first[0]; i < end[0]; ++i) {
        int const n = static_cast<int>(lattice.index(i, j, k));
        if (!(grid.mass(n) > T(0))) continue;
        Vec3<T> const x = lattice.position(i, j, k);
        NearLine<T> const line = line_near(x);
        if (!line.near) continue;
        Vec3<T> const before = grid.velocity(n), inverse_mass = grid.inverse_mass(n);
        Vec3<T> after = projected(line, before, friction, drag_factor);
        for (int a = 0; a < 3; ++a)
          if (!(inverse_mass[a] > T(0))) after[a] = before[a];  // held by a wall
        grid.set_velocity(n, after);
        took(x, grid.mass(n) * (before - after));
      }
}

// What a stage declares of rods that may be absent.
template <class Rods> struct RodFields {
  using Reads = typename Rods::Reads;
  using Writes = typename Rods::Writes;
  using Leaves = typename Rods::Leaves;
  static constexpr bool swaged = Rods::Set::template has<Swage>;
};
template <> struct RodFields<Absent> {
  using Reads = Fields<>;
  using Writes = Fields<>;
  using Leaves = TypeList<>;
  static constexpr bool swaged = false;
};

}  // namespace detail

template <class In> struct ProjectNodes {
  static constexpr FixedString name = "project";
  using Kind = kind::Together;
  using Rods = typename In::Rods;
  using Needle = typename In::Needle;
  using Laws = typename In::Coupling;
  using Strategy = typename Laws::Strategy;
  using Forces = in_slot_t<Slot::before_solve, typename In::Effects>;
  using After = in_slot_t<Slot::after_solve, typename In::Effects>;
  using OnNeedle = in_slot_t<Slot::on_needle, typename In::Effects>;
  using OfRods = detail::RodFields<Rods>;
  using Parts = join_t<Forces, OnNeedle, typename OfRods::Leaves, After, typename Laws::Leaves>;
  static constexpr bool swaged = In::has_needle && OfRods::swaged;

  static_assert(
      !Laws::DragLaw::drags,
      "mpmpbd GridProjection: its drag is a share of the slip per substep, the parameter "
      "drag_factor, and no force per speed; take Drag out, or write Coupling<Embedded, Drag>");
  static_assert(
      !Laws::PressureLaw::squeezes,
      "mpmpbd GridProjection: its friction knows no pressure, only the lateral slip it stops; take "
      "TissuePressure out, or write Coupling<Embedded, Friction, TissuePressure>");
  static_assert(
      !In::has_surface,
      "mpmpbd GridProjection: a tip feels nothing here and nothing is punctured; take Surface out, "
      "or write Coupling<Embedded>");

  template <bool there, class List> using if_t = std::conditional_t<there, List, Fields<>>;
  using NeedleFields =
      union_t<needle::State, Fields<needle::Force, needle::Moment, needle::PeakForce,
                                    needle::Recoil, needle::RecoilMoment>>;
  using OfEffects = join_t<Forces, OnNeedle, After>;
  using Reads =
      union_t<Fields<node::Velocity, node::Mass>, typename OfRods::Reads,
              if_t<In::has_rods, Fields<bead::Recoil>>, if_t<In::has_needle, NeedleFields>,
              typename detail::ReadsOf<OfEffects>::type>;
  using Writes =
      union_t<Fields<node::Velocity>, typename OfRods::Writes,
              if_t<In::has_rods, Fields<bead::Recoil>>, if_t<swaged, Fields<bead::InverseMass>>,
              if_t<In::has_needle, NeedleFields>, typename detail::WritesOf<OfEffects>::type>;

  template <class Team_, class Env, class Ctx, class Grid>
  MPMPBD_HD static std::uint32_t run(Team_ const& team, Env const& env, Ctx const& context,
                                     Grid const& grid) {
    std::uint32_t faults = 0;
    if constexpr (In::has_needle) team.one([&] { kick_needle(env, context); });
    team.sync();
    detail::apply_all_to_needle(OnNeedle{}, team, env, context);
    if constexpr (In::has_rods) faults |= move_thread(team, env, context);
    // One lane, line by line and node by node: a node may belong to two lines.
    team.one([&] {
      if constexpr (In::has_rods)
        for (std::int64_t k = 0; k + 1 < env.template live<Beads>(); ++k)
          if (is_segment(env, k)) project_on_segment(env, context, grid, k);
      if constexpr (In::has_needle)
        if (env.template live<Needles>() > 0) project_on_needle(env, context, grid);
    });
    team.sync();
    return faults;
  }

 private:
  // The recoil of the last substep, then forces and constraints: an ordinary step of the rods.
  template <class Team_, class Env, class Ctx>
  MPMPBD_HD static std::uint32_t move_thread(Team_ const& team, Env const& env,
                                             Ctx const& context) {
    using T = typename Ctx::Scalar;
    team.each(static_cast<int>(env.template live<Beads>()), [&](int k) {
      Vec3<T> const kick =
          env.template get<bead::InverseMass>(k) * env.template get<bead::Recoil>(k);
      env.template set<bead::Velocity>(k, env.template get<bead::Velocity>(k) + kick);
      env.template set<bead::Recoil>(k, Vec3<T>{});
    });
    team.sync();
    std::int64_t const tied = tied_bead(env);
    T const inverse_mass = tied >= 0 ? env.template get<bead::InverseMass>(tied) : T(0);
    if (tied >= 0) team.one([&] { lead_bead(env, context, tied); });
    team.sync();
    auto part = context;
    part.tick.dt = context.tick.dt / T(Rods::substeps);
    part.tick.previous_dt = context.tick.previous_dt / T(Rods::substeps);
    std::uint32_t faults = 0;
    for (int s = 0; s < Rods::substeps; ++s) {
      detail::apply_all_to_beads(Forces{}, team, env, part);
      if (tied >= 0) team.one([&] { env.template set<bead::Velocity>(tied, lead(env, context)); });
      team.sync();
      faults |= Rods::predict(team, env, part.tick);
      faults |= Rods::template solve<typename Strategy::Takes>(team, env, part.tick);
      faults |= Rods::finish(team, env, part.tick);
    }
    detail::apply_all_to_beads(After{}, team, env, context);
    if (tied >= 0) team.one([&] { env.template set<bead::InverseMass>(tied, inverse_mass); });
    team.sync();
    return faults;
  }

  // The bead that is tied to the needle, -1 for none. The needle leads it and does not feel it.
  template <class Env> MPMPBD_HD static std::int64_t tied_bead([[maybe_unused]] Env const& env) {
    if constexpr (swaged)
      if (env.template live<Instances<Swage>>() > 0 && env.template live<Needles>() > 0)
        return env.template get<typename instance<Swage>::Index>(0);
    return -1;
  }
  template <class Env, class Ctx>
  MPMPBD_HD static void lead_bead(Env const& env, Ctx const& context, std::int64_t tied) {
    if constexpr (swaged) {
      auto const end = swage_point(Needle::arc(context.template of<Needle>()), pose_of(env),
                                   sweep_of(env, context));
      env.template set<bead::Position>(tied, end.position);
      env.template set<bead::InverseMass>(tied, typename Ctx::Scalar(0));
    }
  }
  template <class Env, class Ctx> MPMPBD_HD static auto lead(Env const& env, Ctx const& context) {
    Vec3<typename Ctx::Scalar> velocity{};
    if constexpr (swaged)
      velocity = swage_point(Needle::arc(context.template of<Needle>()), pose_of(env),
                             sweep_of(env, context))
                     .velocity;
    return velocity;
  }

  template <class Env, class Ctx, class Grid>
  MPMPBD_HD static void project_on_segment(Env const& env, Ctx const& context, Grid const& grid,
                                           std::int64_t k) {
    using T = typename Ctx::Scalar;
    auto const& of = context.template of<Strategy>();
    Vec3<T> const a = env.template get<bead::Position>(k);
    Vec3<T> const b = env.template get<bead::Position>(k + 1);
    Vec3<T> const va = env.template get<bead::Velocity>(k);
    Vec3<T> const vb = env.template get<bead::Velocity>(k + 1);
    Vec3<T> low{}, high{}, taken{};
    for (int c = 0; c < 3; ++c) {
      low[c] = min(a[c], b[c]);
      high[c] = max(a[c], b[c]);
    }
    detail::project_nodes(
        context.lattice, grid, low, high, of.contact_radius, grip(context), of.drag_factor,
        [&](Vec3<T> const& x) { return detail::near_segment(x, a, b, va, vb, of.contact_radius); },
        [&](Vec3<T> const&, Vec3<T> const& J) { taken += J; });
    env.template set<bead::Recoil>(k, taken);
  }
  // Whether a segment of a thread runs from bead k to the next, and not the gap between two threads.
  template <class Env> MPMPBD_HD static bool is_segment(Env const& env, std::int64_t k) {
    if constexpr (Rods::Set::template has<Distance>) {
      for (std::int64_t i = 0; i < env.template live<Instances<Distance>>(); ++i)
        if (env.template get<typename instance<Distance>::Index>(i)[0] == k) return true;
      return false;
    } else {
      return true;
    }
  }

  template <class Env, class Ctx, class Grid>
  MPMPBD_HD static void project_on_needle(Env const& env, Ctx const& context, Grid const& grid) {
    using T = typename Ctx::Scalar;
    auto const& of = context.template of<Strategy>();
    auto const arc = Needle::arc(context.template of<Needle>());
    auto const pose = pose_of(env);
    auto const sweep = sweep_of(env, context);
    Vec3<T> const half{{arc.radius, arc.radius, arc.radius}};
    Vec3<T> taken{}, moment{};
    detail::project_nodes(
        context.lattice, grid, pose.position - half, pose.position + half, of.contact_radius,
        grip(context), of.drag_factor,
        [&](Vec3<T> const& x) { return detail::near_arc(x, arc, pose, sweep, of.contact_radius); },
        [&](Vec3<T> const& x, Vec3<T> const& J) {
          taken += J;
          moment += cross(x - pose.position, J);
        });
    report(env, context, taken, moment);
    move_needle(env, context);
  }
  // The wrench of the tissue on the needle: what the grid lost, per time, as a mean over the step.
  template <class Env, class Ctx, class T>
  MPMPBD_HD static void report(Env const& env, Ctx const& context, Vec3<T> const& taken,
                               Vec3<T> const& moment) {
    bool const first = context.tick.substep == 0;
    T const share = T(1) / T(context.tick.substeps), rate = T(1) / context.tick.dt;
    auto const mean = [&]<class F>(F, Vec3<T> const& now) {
      Vec3<T> const so_far = first ? Vec3<T>{} : env.template get<F>(0);
      env.template set<F>(0, so_far + share * now);
    };
    mean(needle::Force{}, rate * taken);
    mean(needle::Moment{}, rate * moment);
    T const size = rate * norm(taken);
    T const peak = first ? size : max(size, env.template get<needle::PeakForce>(0));
    env.template set<needle::PeakForce>(0, peak);
    env.template set<needle::Recoil>(0, taken);
    env.template set<needle::RecoilMoment>(0, moment);
  }
  template <class Env, class Ctx>
  MPMPBD_HD static void move_needle(Env const& env, Ctx const& context) {
    using T = typename Ctx::Scalar;
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
  }
  // A needle that can be moved gets the recoil of the last substep.
  template <class Env, class Ctx>
  MPMPBD_HD static void kick_needle(Env const& env, Ctx const& context) {
    if (env.template live<Needles>() == 0) return;
    if constexpr (Needle::is_dynamic) {
      auto const& d = env.template domain<Needles>();
      auto const pose = needle::pose(d.view, d.first);
      auto const body = Needle::body(context.template of<Needle>());
      needle::set_twist(
          d.view, d.first,
          body.kicked(pose, needle::twist(d.view, d.first), env.template get<needle::Recoil>(0),
                      pose.position, env.template get<needle::RecoilMoment>(0)));
    }
  }

  template <class Env> MPMPBD_HD static auto pose_of(Env const& env) {
    auto const& d = env.template domain<Needles>();
    return needle::pose(d.view, d.first);
  }
  template <class Env, class Ctx>
  MPMPBD_HD static auto sweep_of(Env const& env, Ctx const& context) {
    using T = typename Ctx::Scalar;
    auto const& d = env.template domain<Needles>();
    return Sweep<T>::of(pose_of(env), needle::twist(d.view, d.first), context.tick.dt);
  }
  template <class Ctx> MPMPBD_HD static auto grip([[maybe_unused]] Ctx const& context) {
    using T = typename Ctx::Scalar;
    if constexpr (Laws::FrictionLaw::grips)
      return context.template of<typename Laws::FrictionLaw>().coefficient;
    else
      return T(0);
  }
};

struct GridProjection {
  static constexpr FixedString name = "GridProjection";
  using Takes = TypeList<Swage>;
  static constexpr Conserves conserves = Conserves::momentum;

  template <class T> struct Parameters {
    T contact_radius;  // [m]
    T drag_factor;     // share of the axial slip that a node near a line loses per substep [1]
  };
  static constexpr std::array<ParameterInfo, 2> parameter_info{
      {bound::positive("contact_radius", "m"), {"drag_factor", "1", 0.0, 1.0}}};

  template <class In> using Stages = TypeList<ProjectNodes<In>>;

  // Momentum that has left the tissue and has not reached the bodies yet [N s].
  template <class In, class Env> MPMPBD_HD static auto momentum_under_way(Env const& env) {
    Vec3<typename Env::Scalar> sum{};
    if constexpr (In::has_rods)
      for (std::int64_t k = 0; k < env.template live<Beads>(); ++k)
        sum += env.template get<bead::Recoil>(k);
    if constexpr (In::has_needle)
      if (env.template live<Needles>() > 0) sum += env.template get<needle::Recoil>(0);
    return sum;
  }
};

}  // namespace mpmpbd
