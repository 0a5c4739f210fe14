// How one point of a needle or thread answers the tissue that moves past it.
//
// Within a pass each point is linear: dJ = -B (u - N V) + offset, with u the tissue's velocity at the
// point, N V the body's, B = (isotropic I + axial d d^T) / D. Which B it has, its hold, is found by trial.
#pragma once

#include <mpmpbd/core/matrix.hpp>
#include <mpmpbd/coupling/drag.hpp>
#include <mpmpbd/coupling/friction.hpp>

namespace mpmpbd {

enum class Contact : int {
  off,      // outside the tissue, or not a member of a channel
  member,   // in tissue: cannot move sideways in it, slides along `axis` against friction
  surface,  // lies on the tissue: pushes it along `axis` (into the tissue), never pulls
  tip,      // pushes along `axis` with at most `force_cap`, never pulls
  tied,     // attached: no relative motion
};

// A point where a body meets tissue. Position, axis and so on are new every substep; `impulse` is state.
template <class T> struct ContactPoint {
  Vec3<T> position;  // [m]
  Vec3<T> axis;      // unit: tangent (member), inward normal (surface), direction of motion (tip)
  Vec3<T> impulse;   // J, of the body on the tissue in the last substep [N s]
  T length;          // of body that the point stands for [m]
  T radius;          // of the body [m]
  T pressure;        // of the tissue around the point, normal to the axis [Pa]
  T force_cap;       // of a tip [N]
  T coverage;        // theta: mass around the point / mass of full tissue; written by embed_points
  T along;           // thread: where on its segment, in [0, 1]
  int segment;       // thread: from bead `segment` to the next; -1: a point of the needle
  Contact contact;
};

// Coverage from which tissue holds a member at all, and from which it holds it fully. Half is the surface of a
// half space, a quarter is half a cell above it.
struct Grip {
  static constexpr double at_all = 0.25, fully = 0.5;
};
// How firmly a point is held, in (0, 1]: the contact is compliant in between, so that none takes hold or lets go
// with a jerk (decision 8).
template <class T> MPMPBD_HD T firmness(ContactPoint<T> const& p) {
  if (p.contact != Contact::member) return T(1);
  T const share = (p.coverage - T(Grip::at_all)) / T(Grip::fully - Grip::at_all);
  return clamp(share, T(0.01), T(1));
}

template <class T> MPMPBD_HD constexpr bool is_one_sided(ContactPoint<T> const& p) {
  return p.contact == Contact::surface || p.contact == Contact::tip;
}

enum class Hold : int {
  stick,  // B = I/D (a tip: along its axis only)
  slide,  // sideways as stick, along the body a given friction, and drag
  open,   // no impulse: a one-sided point that would pull
  full,   // a tip at its cap
};

// Which holds of the last substep are tried first in the next: a limit of which the impulse is so large a share, friction
// that opposes the slip so nearly (cosine). A trial judges them like any other; these numbers cost trials, not physics.
struct Resumption {
  static constexpr double share_of_limit = 0.75, alignment = 0.9;
};

template <class T> struct Response {
  T isotropic, axial;
  Vec3<T> offset;
};

// The laws of all points of a scene; friction and drag cost nothing where the scene names neither.
template <class T, class FrictionLaw, class DragLaw> struct ContactLaw {
  T dt;
  parameters_t<FrictionLaw, T> friction;
  parameters_t<DragLaw, T> drag;

  static constexpr bool grips = FrictionLaw::grips;
  static constexpr bool drags = DragLaw::drags;
  static constexpr Hold first_hold = grips ? Hold::stick : Hold::slide;

  MPMPBD_HD static Vec3<T> sideways(ContactPoint<T> const& p, Vec3<T> const& a) {
    return add_product(a, -dot(p.axis, a), p.axis);
  }

  // Whether the impulse is a given one, which is not what hinders the slip best.
  MPMPBD_HD static constexpr bool is_limit(Hold hold) {
    return hold == Hold::full || (grips && hold == Hold::slide);
  }

  // What of last substep's impulse may be offered again, now that axes have turned.
  MPMPBD_HD Vec3<T> carried(ContactPoint<T> const& p, Vec3<T> const& impulse) const {
    T const along = dot(p.axis, impulse);
    if (p.contact == Contact::member) return grips || drags ? impulse : sideways(p, impulse);
    if (p.contact == Contact::surface)
      return along > T(0) ? (grips || drags ? impulse : along * p.axis) : Vec3<T>{};
    if (p.contact == Contact::tip) return clamp(along, T(0), p.force_cap * dt) * p.axis;
    return p.contact == Contact::tied ? impulse : Vec3<T>{};
  }

  // Largest friction impulse while the point carries `total`.
  MPMPBD_HD T friction_cap(ContactPoint<T> const& p, Vec3<T> const& total) const {
    if constexpr (grips) {
      if (p.contact == Contact::surface)
        return friction.coefficient * max(dot(p.axis, total), T(0));
      T const pressure = max(friction.clamp_pressure + p.pressure, T(0));
      return friction.coefficient *
             (norm(sideways(p, total)) + pressure * 2 * pi<T> * p.radius * p.length * dt);
    } else {
      return T(0);
    }
  }

  // G D / (1 + G D), G = c ds dt: the share of the slip that implicit drag removes.
  MPMPBD_HD T drag_share(ContactPoint<T> const& p, T D) const {
    if constexpr (drags) {
      T const g = drag.coefficient * p.length * dt * D;
      return g / (1 + g);
    } else {
      return T(0);
    }
  }

  // The response of a point with this hold. `slip_impulse` is the friction it slides with, `J` what it
  // carries already.
  MPMPBD_HD Response<T> response(ContactPoint<T> const& p, Hold hold, Vec3<T> const& J, T D,
                                 Vec3<T> const& slip_impulse) const {
    T const share = drag_share(p, D);
    if (p.contact == Contact::surface && hold != Hold::stick) {
      // Whether it is pressed or not, what touches the tissue is dragged.
      if (hold == Hold::open)
        return {share, -share, (share - 1) * sideways(p, J) - dot(p.axis, J) * p.axis};
      return {share, 1 - share, (1 - share) * (slip_impulse - sideways(p, J))};
    }
    if (hold == Hold::open) return {T(0), T(0), -J};
    if (p.contact == Contact::tip) {
      if (hold == Hold::full) return {T(0), T(0), (p.force_cap * dt) * p.axis - J};
      return {T(0), T(1), {}};
    }
    if (hold == Hold::stick || p.contact == Contact::tied) return {T(1), T(0), {}};
    return {T(1), share - 1, (1 - share) * (slip_impulse - dot(p.axis, J) * p.axis)};
  }

  // The part of an impulse or velocity along which the point can slide.
  MPMPBD_HD static Vec3<T> slip_part(ContactPoint<T> const& p, Vec3<T> const& a) {
    return p.contact == Contact::surface ? sideways(p, a) : dot(p.axis, a) * p.axis;
  }

  // The hold to try first in a substep, and the friction if it is to slide on: as the last substep left it,
  // as far as what the point carries of its impulse and the slip u - N V that follows from it tell. Where it
  // slid, and slides on much the same way, friction turns with the slip.
  MPMPBD_HD Hold begins(ContactPoint<T> const& p, Vec3<T> const& carried, Vec3<T> const& slip,
                        Vec3<T>& slip_impulse) const {
    slip_impulse = {};
    T const at_limit = T(Resumption::share_of_limit), same_way = T(Resumption::alignment);
    if (is_one_sided(p)) {
      T const push = dot(p.axis, carried);
      if (!(push > T(0))) return Hold::open;
      if (p.contact == Contact::tip)
        return push > at_limit * p.force_cap * dt ? Hold::full : first_hold;
    }
    if constexpr (grips) {
      if (p.contact == Contact::tied) return first_hold;
      Vec3<T> const friction_before = slip_part(p, carried), slides = slip_part(p, slip);
      T const cap = friction_cap(p, carried), size = norm(friction_before), speed = norm(slides);
      if (size > at_limit * cap && -dot(friction_before, slides) > same_way * size * speed) {
        slip_impulse = -cap / speed * slides;
        return Hold::slide;
      }
    }
    return first_hold;
  }

  // The hold to try after a sweep that ended with `hold`, and the friction if it is to slide on: that of
  // the impulse which the point carries by now. A one-sided point that carries none starts open.
  MPMPBD_HD Hold resumes(ContactPoint<T> const& p, Hold hold, Vec3<T> const& carried,
                         Vec3<T>& slip_impulse) const {
    slip_impulse = {};
    if (is_one_sided(p) && !(dot(p.axis, carried) > T(0))) return Hold::open;
    if (hold == Hold::full) return hold;
    if constexpr (grips) {
      Vec3<T> const along = slip_part(p, carried);
      T const size = norm(along);
      // What rounding leaves of a push without friction has no direction.
      if (hold == Hold::slide && size > 100 * epsilon<T> * norm(carried)) {
        slip_impulse = friction_cap(p, carried) / size * along;
        return Hold::slide;
      }
    }
    return first_hold;
  }

  // After a trial that would leave the point with `total`: does it let go? Returns its new hold and, if
  // it slides, its friction.
  MPMPBD_HD Hold yields(ContactPoint<T> const& p, Hold hold, Vec3<T> const& total,
                        Vec3<T>& slip_impulse) const {
    if (is_one_sided(p)) {
      T const push = dot(p.axis, total);
      if (push < T(0)) return Hold::open;
      if (p.contact == Contact::tip) return push > p.force_cap * dt ? Hold::full : hold;
    }
    if constexpr (grips) {
      if (hold != Hold::stick || p.contact == Contact::tied || p.contact == Contact::off)
        return hold;
      Vec3<T> const along = slip_part(p, total);
      T const cap = friction_cap(p, total), size = norm(along);
      if (size > cap) {
        slip_impulse = cap / size * along;
        return Hold::slide;
      }
    }
    return hold;
  }

  // After a trial with slip u' left: a limit that would do work on the tissue instead of resisting the
  // slip was chosen wrongly, and the point holds again. Without this some states gain energy.
  MPMPBD_HD Hold returns(ContactPoint<T> const& p, Hold hold, Vec3<T> const& total,
                         Vec3<T> const& slip) const {
    T const apart = dot(p.axis, slip);  // > 0: the tissue runs ahead of a pushing point
    if (hold == Hold::open && apart < T(0)) return first_hold;
    if (hold == Hold::full && apart > T(0)) return first_hold;
    if constexpr (grips)
      if (hold == Hold::slide && dot(slip_part(p, total), slip) > T(0)) return Hold::stick;
    return hold;
  }
};

}  // namespace mpmpbd
