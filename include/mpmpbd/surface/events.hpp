// What happened at the surface: punctures and exits, in order, with place, time and force.
#pragma once

#include <mpmpbd/core/status.hpp>
#include <mpmpbd/surface/sheet.hpp>

namespace mpmpbd {

struct Events {
  static constexpr FixedString name = "event";
};

enum class EventKind : std::int64_t { none, entry, exit };

namespace event {
struct Kind : Field<"kind", "1", Integer, Events> {};  // EventKind
struct Needle : Field<"needle", "1", Integer, Events> {};
struct Triangle : Field<"triangle", "1", Integer, Events> {};
struct Weights : Field<"weights", "1", Numbers<2>, Events> {};
struct Position : Field<"x", "m", Vector, Events> {};  // when it happened
struct Step : Field<"step", "1", Integer, Events> {};
struct Time : Field<"time", "s", Number, Events> {};
struct Force : Field<"force", "N", Number, Events> {};  // axial force on the tip in that substep
// Distance to the marker in the deformed state; infinite where the scene has set none.
struct Miss : Field<"miss", "m", Number, Events> {};
struct Count : Field<"events", "1", Integer, Environments> {};

using State = Fields<Kind, Needle, Triangle, Weights, Position, Step, Time, Force, Miss>;
}  // namespace event

template <class T> struct SurfaceEvent {
  EventKind kind;
  std::int64_t needle;
  SurfaceMark<T> mark;
  Vec3<T> position;
  std::int64_t step;
  T time, force, miss;
};

// One environment's list. `first` is its first slot, `env` its slot in the table of environments.
template <class View, class EnvironmentView> struct EventLog {
  using T = typename View::Scalar;
  View view;
  EnvironmentView environments;
  std::int64_t env;

  MPMPBD_HD std::int64_t first() const { return env * view.capacity; }
  MPMPBD_HD std::int64_t count() const { return environments.template get<event::Count>(env); }
  MPMPBD_HD void clear() const { environments.template set<event::Count>(env, 0); }

  // Fault::overflow when the list is full; the event is then left out.
  MPMPBD_HD std::uint32_t append(SurfaceEvent<T> const& e) const {
    std::int64_t const n = count();
    if (n >= view.capacity) return static_cast<std::uint32_t>(Fault::overflow);
    std::int64_t const at = first() + n;
    view.template set<event::Kind>(at, static_cast<std::int64_t>(e.kind));
    view.template set<event::Needle>(at, e.needle);
    view.template set<event::Triangle>(at, e.mark.triangle);
    view.template set<event::Weights>(at, e.mark.weights);
    view.template set<event::Position>(at, e.position);
    view.template set<event::Step>(at, e.step);
    view.template set<event::Time>(at, e.time);
    view.template set<event::Force>(at, e.force);
    view.template set<event::Miss>(at, e.miss);
    environments.template set<event::Count>(env, n + 1);
    return 0u;
  }
  MPMPBD_HD SurfaceEvent<T> operator()(std::int64_t i) const {
    std::int64_t const at = first() + i;
    return {static_cast<EventKind>(view.template get<event::Kind>(at)),
            view.template get<event::Needle>(at),
            {view.template get<event::Triangle>(at), view.template get<event::Weights>(at)},
            view.template get<event::Position>(at),
            view.template get<event::Step>(at),
            view.template get<event::Time>(at),
            view.template get<event::Force>(at),
            view.template get<event::Miss>(at)};
  }
};
template <class View, class EnvironmentView>
MPMPBD_HD EventLog<View, EnvironmentView> event_log(View const& view,
                                                    EnvironmentView const& environments,
                                                    std::int64_t env) {
  return {view, environments, env};
}

}  // namespace mpmpbd
