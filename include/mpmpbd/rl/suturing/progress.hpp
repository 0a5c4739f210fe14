// How far a stitch has come: phases, and the way of the needle within a decision.
#pragma once

#include <mpmpbd/coupling/embedded_exchange.hpp>
#include <mpmpbd/rl/suturing/hand.hpp>

namespace mpmpbd::rl {

// Insertion: the tip is to go in at the entry marker. Driving: it is to come out at the exit
// marker. Extraction: it is to be drawn on until enough of it is out. Lost: the tip went through
// the surface elsewhere.
enum class StitchPhase : std::int64_t { insertion, driving, extraction, finished, lost };

namespace stitch {
struct Phase : Field<"phase", "1", Integer, Environments> {};
struct PhaseBefore : Field<"phase_before", "1", Integer, Environments> {};  // at the last decision
// What has been reached, each once and in this order: in at the entry marker, out at the exit
// marker, finished.
struct Milestones : Field<"milestones", "1", Integer, Environments> {};
struct MilestonesBefore : Field<"milestones_before", "1", Integer, Environments> {};
struct EventsSeen : Field<"events_seen", "1", Integer, Environments> {};
// Distance of the tip to the marker when it went through the surface; -1: it has not.
struct EntryMiss : Field<"entry_miss", "m", Number, Environments> {};
struct ExitMiss : Field<"exit_miss", "m", Number, Environments> {};
// From the entry marker to the tip, seen from the arc's centre; counts on past half a turn.
struct Angle : Field<"angle", "rad", Number, Environments> {};
struct AngleBefore : Field<"angle_before", "rad", Number, Environments> {};
struct CentreBefore : Field<"centre_before", "m", Vector, Environments> {};

using Memory = Fields<Phase, PhaseBefore, Milestones, MilestonesBefore, EventsSeen, EntryMiss,
                      ExitMiss, Angle, AngleBefore, CentreBefore>;

template <class Env> MPMPBD_HD StitchPhase phase(Env const& env) {
  return static_cast<StitchPhase>(env.template get<Phase>(0));
}
template <class Env> MPMPBD_HD StitchPhase phase_before(Env const& env) {
  return static_cast<StitchPhase>(env.template get<PhaseBefore>(0));
}

enum Milestone : std::int64_t { entered = 1, came_out = 2, done = 3 };
// Whether a milestone was reached in this decision.
template <class Env> MPMPBD_HD bool has_just(Env const& env, Milestone reached) {
  return env.template get<Milestones>(0) >= reached &&
         env.template get<MilestonesBefore>(0) < reached;
}

enum Marker : int { entry = 0, exit = 1 };
// Where a marker is now [m].
template <class Env> MPMPBD_HD auto marker_position(Env const& env, Marker which) {
  auto const& markers = env.template domain<Markers>();
  return position(mpmpbd::detail::sheet_of_environment(env),
                  marker::load(markers.view, markers.first + which));
}
template <class Env> MPMPBD_HD auto needle_pose(Env const& env) {
  auto const& needles = env.template domain<Needles>();
  return needle::pose(needles.view, needles.first);
}
template <class Env, class Ctx> MPMPBD_HD auto tip_position(Env const& env, Ctx const& context) {
  auto const arc = ArcNeedle::arc(context.template of<ArcNeedle>());
  return to_world(needle_pose(env), arc.point(typename Env::Scalar(0)));
}
template <class Env> MPMPBD_HD TipState tip_state(Env const& env) {
  return static_cast<TipState>(env.template get<tip::State>(0));
}
// From a marker to the tip, seen from the arc's centre [rad], in (-pi, pi].
template <class Env, class Ctx>
MPMPBD_HD auto angle_past(Env const& env, Ctx const& context, Marker which) {
  auto const centre = needle_pose(env).position;
  return plane::angle(marker_position(env, which) - centre, tip_position(env, context) - centre);
}
}  // namespace stitch

// Only a puncture opens the driving phase and only an exit ends it, each within `reach` of its
// marker; whatever else the tip does with a marker, from within the tissue or a second time, is no
// event. A puncture after the exit loses the stitch, too.
struct StitchProgress {
  using Role = role::Progress;
  static constexpr FixedString name = "StitchProgress";
  using Reads = union_t<needle::State, tip::Memory, marker::State, event::State,
                        Fields<event::Count, sheet::Position, sheet::Corners>>;
  using Writes = stitch::Memory;

  template <class T> struct Parameters {
    T reach;    // how far from its marker the tip may go through the surface [m]
    T out;      // angle past the exit marker with which the stitch is finished [rad]
    T x, y, z;  // where observed positions are counted from [m]
  };
  static constexpr ParameterInfo parameter_info[] = {
      bound::positive("reach", "m"), bound::between("out", "rad", 0.0, pi<double>),
      bound::any("x", "m"), bound::any("y", "m"), bound::any("z", "m")};

  template <class Env, class Ctx> MPMPBD_HD static void begin(Env const& env, Ctx const& context) {
    using T = typename Env::Scalar;
    set_phase(env, StitchPhase::insertion);
    env.template set<stitch::Milestones>(0, 0);
    env.template set<stitch::EventsSeen>(0, 0);
    env.template set<stitch::EntryMiss>(0, T(-1));
    env.template set<stitch::ExitMiss>(0, T(-1));
    env.template set<stitch::Angle>(0, stitch::angle_past(env, context, stitch::entry));
    decide(env, context);
  }
  template <class Env, class Ctx> MPMPBD_HD static void decide(Env const& env, Ctx const&) {
    env.template set<stitch::PhaseBefore>(0, env.template get<stitch::Phase>(0));
    env.template set<stitch::MilestonesBefore>(0, env.template get<stitch::Milestones>(0));
    env.template set<stitch::AngleBefore>(0, env.template get<stitch::Angle>(0));
    env.template set<stitch::CentreBefore>(0, stitch::needle_pose(env).position);
  }
  template <class Env, class Ctx>
  MPMPBD_HD static void advance(Env const& env, Ctx const& context) {
    using T = typename Env::Scalar;
    auto const& events = env.template domain<Events>();
    auto const& environments = env.template domain<Environments>();
    auto const log = event_log(events.view, environments.view, environments.first);
    T const reach = context.template of<StitchProgress>().reach;
    for (auto i = env.template get<stitch::EventsSeen>(0); i < log.count(); ++i)
      take(env, log(i), reach);
    env.template set<stitch::EventsSeen>(0, log.count());

    T const before = env.template get<stitch::Angle>(0);
    T const change = stitch::angle_past(env, context, stitch::entry) - before;
    T const turn = T(2) * pi<T>;
    env.template set<stitch::Angle>(0, before + (change - turn * floor(change / turn + T(0.5))));

    bool const out =
        stitch::tip_state(env) == TipState::outside &&
        stitch::angle_past(env, context, stitch::exit) >= context.template of<StitchProgress>().out;
    if (stitch::phase(env) == StitchPhase::extraction && out)
      pass(env, stitch::done, StitchPhase::finished);
  }

 private:
  template <class Env> MPMPBD_HD static void set_phase(Env const& env, StitchPhase phase) {
    env.template set<stitch::Phase>(0, static_cast<std::int64_t>(phase));
  }
  template <class Env>
  MPMPBD_HD static void pass(Env const& env, stitch::Milestone milestone, StitchPhase next) {
    env.template set<stitch::Milestones>(0, milestone);
    set_phase(env, next);
  }
  template <class Env, class Event, class T>
  MPMPBD_HD static void take(Env const& env, Event const& event, T within) {
    auto const phase = stitch::phase(env);
    bool const near = event.miss < within;
    bool const goes_in = event.kind == EventKind::entry;
    if (phase == StitchPhase::insertion && goes_in) {
      env.template set<stitch::EntryMiss>(0, event.miss);
      if (near) return pass(env, stitch::entered, StitchPhase::driving);
      set_phase(env, StitchPhase::lost);
    } else if (phase == StitchPhase::driving && !goes_in) {
      env.template set<stitch::ExitMiss>(0, event.miss);
      if (near) return pass(env, stitch::came_out, StitchPhase::extraction);
      set_phase(env, StitchPhase::lost);
    } else if (phase == StitchPhase::extraction && goes_in) {
      set_phase(env, StitchPhase::lost);
    }
  }
};

namespace stitch {
template <class Ctx, class T> MPMPBD_HD Vec3<T> from_origin(Ctx const& context, Vec3<T> const& x) {
  auto const& k = context.template of<StitchProgress>();
  return x - vec(k.x, k.y, k.z);
}
}  // namespace stitch

// The episode is over when the stitch is finished or lost.
struct StitchOver {
  using Role = role::Termination;
  static constexpr FixedString name = "StitchOver";
  using Reads = Fields<stitch::Phase>;
  using Writes = Fields<>;
  template <class Env, class Ctx> MPMPBD_HD static bool holds(Env const& env, Ctx const&) {
    return stitch::phase(env) >= StitchPhase::finished;
  }
};

}  // namespace mpmpbd::rl
