// A thread where it goes through the mouth of a channel: between its beads, too.
//
// Every bead stands for two places, one on either side of it; which of them are in a channel is remembered
// (channel::Member). See docs/decisions/0007.
#pragma once

#include <mpmpbd/coupling/exchange_view.hpp>
#include <mpmpbd/surface/channel.hpp>

namespace mpmpbd::detail {

// How far the places are from their bead [segments]: where a Gauss point would be.
inline constexpr double place_aside = 0.21132486540518712;

// Puts a point so many segments along its thread from bead k, at most one.
template <class X, class T>
MPMPBD_HD void place_beside_bead(X const& x, ContactPoint<T>& p, int k, T segments) {
  bool const back = segments < T(0);
  place_on_thread(x, p, back ? k - 1 : k, back ? 1 + segments : segments);
}

// The places on either side of bead k.
template <class T> MPMPBD_HD ThreadPlace<T>& thread_place(ThreadPlace<T>* places, int k, int side) {
  return places[2 * k + (side == side_after ? 1 : 0)];
}
// Where one of them is, and the coverage there.
template <class T, class Form, class Grid>
MPMPBD_HD ThreadPlace<T> look_aside(ExchangeView<T, Form> const& x, Grid const& grid, int k,
                                    int side) {
  if (!is_segment(x.thread, side == side_after ? k : k - 1)) return {Vec3<T>{}, T(-1)};
  ContactPoint<T> p;
  place_beside_bead(x, p, k, side == side_after ? T(place_aside) : T(-place_aside));
  T const mass = mass_around<typename Form::Shape>(x.lattice, p.position, grid);
  return {p.position, mass / full_mass(x)};
}

// Where the thread comes out of the tissue at a mouth it is held, wherever its beads are: the point of the first
// bead that is not wholly inside stands there. It moves along the thread as that is drawn through, from bead
// to bead, so that nothing jumps. `out` = 1: the thread comes out towards later beads, -1: towards earlier ones.
// Returns whether bead k is that one.
template <class X, class T, class Members>
MPMPBD_HD bool hold_at_mouth(X const& x, ThreadPlace<T>* places, Members const& member, int k,
                             int out) {
  int const outer = out > 0 ? side_after : side_before, inner = side_before + side_after - outer;
  int const next = k - out;  // further inside
  bool const is_half = member(k) == inner;
  bool const is_next = member(k) == 0 && is_segment(x.thread, min(k, next)) &&
                       (static_cast<int>(member(next)) & outer) != 0;
  if (!is_half && !is_next) return false;
  // The last place inside and the first outside: in segments from bead k, outwards.
  T const last = is_half ? T(-place_aside) : T(place_aside) - 1,
          first = is_half ? T(place_aside) : T(-place_aside);
  T const in = thread_place(places, is_half ? k : next, is_half ? inner : outer).coverage,
          beyond = thread_place(places, k, is_half ? outer : inner).coverage;
  bool const ends = is_half && !is_segment(x.thread, out > 0 ? k : k - 1);
  T at = last;
  if (!ends && beyond < T(ChannelLimits::coverage))
    at = clamp(last + (in - T(ChannelLimits::lip)) / (in - beyond) * (first - last), T(-1), first);
  ContactPoint<T>& p = x.points[k];
  place_beside_bead(x, p, k, T(out) * at);
  p.length = clamp(T(0.5) + at, T(0), T(1)) * x.thread.rest_length[p.segment];
  p.contact = Contact::member;
  return true;
}

// A point that has left the tissue leaves its impulse to the next inside, the earlier one where both are: at a
// mouth it was often the most loaded of its thread, and they stand at one place by then. Every point inside
// takes what is left to it, then those outside let go.
template <class Team_, class X, class Members>
MPMPBD_HD void hand_over_impulses(Team_ const& team, X const& x, Members const& member) {
  int const n = x.thread_points();
  auto leaves = [&](int k) { return k >= 0 && k < n && x.points[k].contact == Contact::off; };
  auto is_inside = [&](int k) { return k >= 0 && k < n && member(k) != 0; };
  team.each(n, [&](int k) {
    if (!is_inside(k)) return;
    auto& impulse = x.points[k].impulse;
    if (leaves(k - 1) && !is_inside(k - 2)) impulse += x.points[k - 1].impulse;
    if (leaves(k + 1)) impulse += x.points[k + 1].impulse;
  });
  team.sync();
  team.each(n, [&](int k) {
    if (leaves(k) && (is_inside(k - 1) || is_inside(k + 1))) x.points[k].impulse = {};
  });
}

}  // namespace mpmpbd::detail
