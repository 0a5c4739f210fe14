// The tip of a needle and the surface: outside, touching, inside. The only way into tissue is a
// puncture.
//
// A puncture is decided by force and an exit by distance, never by how much tissue the grid sees
// around the tip. All thresholds have hysteresis: a tip that presses just below the puncture force,
// or slides along the surface, makes no event however long it does.
#pragma once

#include <mpmpbd/needle/fields.hpp>
#include <mpmpbd/surface/events.hpp>
#include <mpmpbd/surface/queries.hpp>

namespace mpmpbd {

enum class TipState : std::int64_t { outside, touch, inside };

namespace tip {
struct State : Field<"tip", "1", Integer, Needles> {};           // TipState
struct Position : Field<"tip_x", "m", Vector, Needles> {};       // in the last substep
struct TouchPoint : Field<"touch_x", "m", Vector, Needles> {};   // where it met the surface
struct TouchNormal : Field<"touch_n", "1", Vector, Needles> {};  // outwards, then
struct Triangle : Field<"tip_triangle", "1", Integer, Needles> {
};  // touched or left there; -1 none
struct Weights : Field<"tip_weights", "1", Numbers<2>, Needles> {};
struct Cap : Field<"tip_cap", "N", Number, Needles> {};  // largest axial force, next substep

using Memory = Fields<State, Position, TouchPoint, TouchNormal, Triangle, Weights, Cap>;
}  // namespace tip

template <class T> struct Tip {
  TipState state;
  Vec3<T> position;
  Vec3<T> touch_point, touch_normal;
  SurfaceMark<T> mark;
  T cap;

  MPMPBD_HD static Tip at(Vec3<T> const& x) {
    return {TipState::outside, x, {}, {}, {-1, {}}, T(0)};
  }

  template <class View> MPMPBD_HD static Tip load(View const& v, std::int64_t item) {
    return {static_cast<TipState>(v.template get<tip::State>(item)),
            v.template get<tip::Position>(item),
            v.template get<tip::TouchPoint>(item),
            v.template get<tip::TouchNormal>(item),
            {v.template get<tip::Triangle>(item), v.template get<tip::Weights>(item)},
            v.template get<tip::Cap>(item)};
  }
  template <class View> MPMPBD_HD void store(View const& v, std::int64_t item) const {
    v.template set<tip::State>(item, static_cast<std::int64_t>(state));
    v.template set<tip::Position>(item, position);
    v.template set<tip::TouchPoint>(item, touch_point);
    v.template set<tip::TouchNormal>(item, touch_normal);
    v.template set<tip::Triangle>(item, mark.triangle);
    v.template set<tip::Weights>(item, mark.weights);
    v.template set<tip::Cap>(item, cap);
  }
};

struct TipLimits {
  static constexpr double clearance = 0.1;  // beyond the sheet before the tip counts as out [cells]
  static constexpr double dimple = 1.5;     // pressed in without puncture [cells]
  static constexpr double penetration = 0.5;  // below the sheet without puncture [cells]
  static constexpr double tolerance = 1e-4;   // of the puncture force, relative
  static constexpr double reach = 2.0;        // how far the surface is looked for [cells]
};

template <class T> struct TipForces {
  T puncture;  // axial force at which it goes through the surface [N]
  T cutting;   // axial force on it in tissue [N]
};

template <class T> struct TipChange {
  EventKind kind;       // of the event of this substep
  SurfaceMark<T> mark;  // where on the surface
  Vec3<T> position;     // the same, now [m]
  T force;              // on the tip in this substep [N]
  std::uint32_t faults;
};

// One substep: the tip has moved to `to` and the sheet with the tissue, and `impulse` >= 0 is what
// the tip gave to the tissue along its axis under the cap of the substep before [N s]. Every lane
// of a group has a `tip` of its own; what becomes of them is the same.
template <class Group_, class S, class C, class T>
MPMPBD_HD TipChange<T> advance_tip(Group_ const& group, Tip<T>& tip, Vec3<T> const& to, T impulse,
                                   T dt, S const& sheet, C const& columns, T dx,
                                   TipForces<T> const& forces) {
  TipChange<T> change{EventKind::none, {-1, {}}, {}, T(0), 0u};
  if (!is_finite(to) || !is_finite(impulse)) {
    change.faults = static_cast<std::uint32_t>(Fault::not_finite);
    return change;
  }
  Vec3<T> const from = tip.position;
  tip.position = to;
  change.force = impulse / dt;
  if (norm(to - from) > dx) change.faults |= static_cast<std::uint32_t>(Fault::speed);
  if (sheet.triangles == 0) {  // nothing to be inside of, and nothing is passed
    tip.state = TipState::outside;
    tip.mark = {-1, {}};
    tip.cap = T(0);
    return change;
  }

  auto const surface = nearest_on_sheet(group, sheet, columns, to, T(TipLimits::reach) * dx);
  T const limit = T(TipLimits::penetration) * dx;
  bool const clear = surface.distance > T(TipLimits::clearance) * dx;
  auto nearest = [&] { return surface.found ? surface.mark : mark_at(sheet, to); };
  // The first way in, or the last way out, of this substep's path; else the nearest point: the
  // sheet came to the tip.
  auto on_path = [&](bool leaving) {
    auto const path = crossings(sheet, columns, from, to);
    SurfaceMark<T> mark{-1, {}};
    for (int i = 0; i < path.count; ++i)
      if (path.list[i].leaving == leaving && (leaving || mark.triangle < 0))
        mark = path.list[i].mark;
    return mark.triangle >= 0 ? mark : nearest();
  };
  auto raise = [&change](EventKind kind, SurfaceMark<T> const& mark, Vec3<T> const& x) {
    change.kind = kind;
    change.mark = mark;
    change.position = x;
  };

  if (tip.state == TipState::outside) {
    if (surface.distance <= T(0)) {
      tip.state = TipState::touch;
      tip.mark = on_path(false);
      tip.touch_point = position(sheet, tip.mark);
      tip.touch_normal = direction(sheet.triangle(tip.mark.triangle).area_normal());
      tip.cap = forces.puncture;
    } else if (norm(to - from) > limit) {
      // In and out again within the substep: a corner may be grazed, a body may not be passed
      // through.
      auto const path = crossings(sheet, columns, from, to);
      for (int i = 0; i + 1 < path.count; i += 2)
        if ((path.list[i + 1].share - path.list[i].share) * norm(to - from) > limit)
          change.faults |= static_cast<std::uint32_t>(Fault::penetration);
    }
  } else if (tip.state == TipState::touch) {
    // The impulse is capped at cap * dt, so "reached" is equality, up to rounding and to the turn
    // of the tip's axis within a substep.
    // Where nothing resists, to be below the sheet is enough.
    bool const pushes = tip.cap > T(0) ? impulse > T(0) : surface.distance <= T(0);
    if (pushes && impulse >= (T(1) - T(TipLimits::tolerance)) * tip.cap * dt) {
      auto const mark = surface.found ? surface.mark : tip.mark;
      tip.state = TipState::inside;
      tip.mark = {-1, {}};
      tip.cap = forces.cutting;
      raise(EventKind::entry, mark, position(sheet, mark));
    } else if (clear) {
      tip.state = TipState::outside;
      tip.mark = {-1, {}};
      tip.cap = T(0);
    } else if (dot(tip.touch_point - to, tip.touch_normal) > T(TipLimits::dimple) * dx) {
      change.faults |= static_cast<std::uint32_t>(Fault::dimple);
    }
  } else if (surface.inside) {
    tip.mark = {-1, {}};  // it looked out and came back
  } else {
    if (tip.mark.triangle < 0) tip.mark = on_path(true);
    if (clear) {
      raise(EventKind::exit, tip.mark, position(sheet, tip.mark));
      tip.state = TipState::outside;
      tip.mark = {-1, {}};
      tip.cap = T(0);
    }
  }
  if (tip.state == TipState::touch && surface.distance < -limit)
    change.faults |= static_cast<std::uint32_t>(Fault::penetration);
  return change;
}
template <class S, class C, class T>
MPMPBD_HD TipChange<T> advance_tip(Tip<T>& tip, Vec3<T> const& to, T impulse, T dt, S const& sheet,
                                   C const& columns, T dx, TipForces<T> const& forces) {
  return advance_tip(Solo{}, tip, to, impulse, dt, sheet, columns, dx, forces);
}

}  // namespace mpmpbd
