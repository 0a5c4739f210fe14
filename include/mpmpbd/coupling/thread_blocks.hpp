// The equations of a thread for one substep: inertia, tension, stretch and bending as rows of the
// chain solve, each from the shape of the thread at the start of the substep.
#pragma once

#include <mpmpbd/coupling/chain_solve.hpp>
#include <mpmpbd/coupling/team.hpp>

namespace mpmpbd {

// A thread (or several, one after another) as the coupling sees it; SI units.
// The state of a segment belongs to the bead at its start. A segment of rest length 0 is a gap.
template <class T> struct ThreadState {
  int beads;
  Vec3<T>* position;
  Vec3<T>* velocity;
  T const* mass;
  bool const* known;  // this bead's velocity is given (pin, kinematic needle); it leaves the system
  T const* rest_length;  // beads - 1
  T const*
      rest_angle;  // turning angle at bead k, 0 = straight; null: straight; read where it bends
  T* impulse;      // lambda of segment k [N s], tension * dt; carried over
  T stretch_compliance;  // 1/EA [1/N]; 0: inextensible
  T bending_stiffness;   // EI [N m^2]
  int held = -1;  // bead whose tangent is given: a swaged one, which goes on as the needle does
  Vec3<T> held_tangent{};  // unit, towards the next bead
};

// A joint in its present shape: how its turning angle changes with the three beads around it.
template <class T> struct Joint {
  Vec3<T> in_plane[3];  // d(angle)/dx of beads k-1, k, k+1
  Vec3<T> across[3];    // the same out of the plane of the joint
  T stiffness;          // EI / l [N m]; 0: no joint here
  T excess;             // angle - rest angle
  T across_share;       // of the stiffness that resists leaving the plane, in [0, 1]
};
template <class T, bool bends> struct JointStore {};
template <class T> struct JointStore<T, true> { Joint<T>* joints; };

// Work arrays of the chain; one entry per bead each, where nothing else is said.
template <class T, bool bends> struct ThreadWork : JointStore<T, bends> {
  BeadRows<T, bends>* base;  // inertia, tension, bending: kept during the substep
  BeadRows<T, bends>* rows;  // base + contact of one pass
  Link<T>* links;
  T* length;         // of segment k
  Vec3<T>* tangent;  // at bead k
  T* gap_speed;      // g of segment k
  Vec3<T>* inertia;  // m v + bending, the right-hand side without contact
  // Right-hand sides, then velocities [m/s] and link impulses [N s], (bead): those without tissue, and after them those of the present
  // trial. Two solutions of one elimination are found as one.
  Column<T>* alone;
  Column<T>* trial;
  ChainWork<T, bends> chain;
  ChainHead<T, bends>* head;  // beads before the first that meets tissue
};

namespace detail {

template <class T> MPMPBD_HD bool is_segment(ThreadState<T> const& s, int k) {
  return k >= 0 && k + 1 < s.beads && s.rest_length[k] > T(0);
}

// Two beads at one place have no direction: the segment takes that of the one before, or the x axis, so
// that it opens the same way every time.
template <class T> MPMPBD_HD Vec3<T> chord_direction(ThreadState<T> const& s, int k) {
  for (int i = k; is_segment(s, i); --i) {
    Vec3<T> const d = direction(s.position[i + 1] - s.position[i]);
    if (dot(d, d) > T(0)) return d;
  }
  return vec(T(1), T(0), T(0));
}

// Tension stiffens a segment across its direction; compression would soften it and is left out.
template <class T>
MPMPBD_HD Mat3<T> tension_block(ThreadState<T> const& s, Vec3<T> const& n, T length, int k, T dt) {
  T const pull = max(s.impulse[k], T(0));
  return dt * pull / max(length, s.rest_length[k]) * (Mat3<T>::identity() - outer(n, n));
}

// Turning angle by atan2: accurate for straight and folded joints alike, unlike arccos.
template <class T>
MPMPBD_HD Joint<T> bend_joint(ThreadState<T> const& s, Link<T> const* links, T const* length,
                              int k) {
  Joint<T> j{};
  if (!is_segment(s, k - 1) || !is_segment(s, k) || !(s.bending_stiffness > T(0))) return j;
  Vec3<T> const n1 = links[k - 1].direction, n2 = links[k].direction;
  Vec3<T> const turn = cross(n1, n2);
  T const sine = norm(turn);
  T const angle = atan2(sine, dot(n1, n2));
  T const rest = s.rest_angle != nullptr ? s.rest_angle[k] : T(0);
  Vec3<T> const axis = sine > T(0) ? T(1) / sine * turn : any_across(n1);
  T const a1 = T(1) / max(length[k - 1], T(0.1) * s.rest_length[k - 1]);
  T const a2 = T(1) / max(length[k], T(0.1) * s.rest_length[k]);
  Vec3<T> const u1 = a1 * cross(axis, n1), u2 = a2 * cross(axis, n2);
  j.in_plane[0] = u1;
  j.in_plane[1] = -(u1 + u2);
  j.in_plane[2] = u2;
  j.across[0] = a1 * axis;
  j.across[1] = -(a1 + a2) * axis;
  j.across[2] = a2 * axis;
  j.stiffness = 2 * s.bending_stiffness / (s.rest_length[k - 1] + s.rest_length[k]);
  j.excess = angle - rest;
  // Of a joint that is straight at rest all of it, also where it is exactly straight and its plane is any.
  j.across_share = rest > T(0) ? max(T(0), 1 - rest / max(angle, rest)) : T(1);
  return j;
}

template <class T> MPMPBD_HD Mat3<T> joint_block(Joint<T> const& j, int a, int b, T dt) {
  return square(dt) * j.stiffness *
         add_product(outer(j.in_plane[a], j.in_plane[b]), j.across_share,
                     outer(j.across[a], j.across[b]));
}

template <class T, bool bends>
MPMPBD_HD void add_bending(ThreadState<T> const& s, ThreadWork<T, bends> const& w, T dt, int k) {
  if constexpr (bends) {
    for (int a = 0; a < 3; ++a) {  // bead k is the a-th bead of joint k + 1 - a
      int const joint = k + 1 - a;
      if (joint < 1 || joint + 1 >= s.beads) continue;
      Joint<T> const& j = w.joints[joint];
      w.base[k].add_to_A(joint_block(j, a, a, dt));
      w.inertia[k] -= dt * j.stiffness * j.excess * j.in_plane[a];
      if (a < 2) w.base[k].add_to_U(joint_block(j, a, a + 1, dt));
      if (a == 0) w.base[k].add_to_W(joint_block(j, 0, 2, dt));
    }
  }
}

}  // namespace detail

// Directions, lengths and stretch of all segments.
template <class T, bool bends, class Team_>
MPMPBD_HD void measure_segments(Team_ const& team, ThreadState<T> const& s,
                                ThreadWork<T, bends> const& w, T dt) {
  team.each(s.beads, [&](int k) {
    bool const there = detail::is_segment(s, k);
    w.links[k] = {Vec3<T>{}, T(1)};
    w.length[k] = T(0);
    w.gap_speed[k] = T(0);
    if (!there) return;
    w.length[k] = norm(s.position[k + 1] - s.position[k]);
    w.links[k].direction = detail::chord_direction(s, k);
    w.links[k].compliance = s.stretch_compliance * s.rest_length[k] / square(dt);
    w.gap_speed[k] = -(w.length[k] - s.rest_length[k]) / dt;
  });
  team.sync();
}

// Tangents at the beads: between the chords. The chord itself, taken as the tangent of its points, locks
// a thread that is pulled round a bend. At a swage it is the needle's: with the chord's, which cuts the
// corner of the needle's arc, needle and thread would hold the same tissue in different directions.
template <class T, bool bends, class Team_>
MPMPBD_HD void bead_tangents(Team_ const& team, ThreadState<T> const& s,
                             ThreadWork<T, bends> const& w) {
  team.each(s.beads, [&](int k) {
    Vec3<T> const before = k > 0 ? w.links[k - 1].direction : Vec3<T>{};
    Vec3<T> const after = w.links[k].direction;
    Vec3<T> const mean = direction(before + after);
    w.tangent[k] = k == s.held ? s.held_tangent : (dot(mean, mean) > T(0) ? mean : after);
  });
  team.sync();
}

// Inertia, tension and bending: `base` and `inertia` of every bead. External forces and everything else
// that changes velocities must have acted on s.velocity before.
template <class T, bool bends, class Team_>
MPMPBD_HD void assemble_thread(Team_ const& team, ThreadState<T> const& s,
                               ThreadWork<T, bends> const& w, T dt) {
  if constexpr (bends) {
    team.each(s.beads, [&](int k) { w.joints[k] = detail::bend_joint(s, w.links, w.length, k); });
    team.sync();
  }
  team.each(s.beads, [&](int k) {
    BeadRows<T, bends>& b = w.base[k];
    b = BeadRows<T, bends>::between(k > 0 ? w.links[k - 1] : BeadRows<T, bends>::no_link(),
                                    w.links[k]);
    b.add_to_A(s.mass[k] * Mat3<T>::identity());
    w.inertia[k] = s.mass[k] * s.velocity[k];
    if (detail::is_segment(s, k - 1))
      b.add_to_A(detail::tension_block(s, w.links[k - 1].direction, w.length[k - 1], k - 1, dt));
    if (detail::is_segment(s, k)) {
      Mat3<T> const across = detail::tension_block(s, w.links[k].direction, w.length[k], k, dt);
      b.add_to_A(across);
      b.add_to_U(-across);
    }
    detail::add_bending(s, w, dt, k);
    if (s.known[k]) w.inertia[k] = s.velocity[k];
  });
  team.sync();
}

}  // namespace mpmpbd
