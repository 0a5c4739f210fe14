// Channels: the cuts that needle tips have left in tissue, and which points are in them.
//
// A point of needle or thread is coupled to tissue (a member) only if it followed the tip through a
// mouth of a channel. Any other point that meets the surface lies on it. So a thread on the skin is
// not glued to it, and nothing sinks in without a puncture. Channels are state: saved, reset and
// cloned.
#pragma once

#include <mpmpbd/coupling/contact_law.hpp>
#include <mpmpbd/geometry/polyline.hpp>
#include <mpmpbd/surface/tip.hpp>

namespace mpmpbd {

struct Channels {
  static constexpr FixedString name = "channel";
  static constexpr std::int64_t fewest_slots = 1;
};
struct ChannelPoints {
  static constexpr FixedString name = "channel point";
};

namespace channel {
struct Needle : Field<"needle", "1", Integer, Channels> {
};  // number of the needle + 1; 0: not in use
struct Mouths : Field<"mouths", "1", Integer, Channels> {};  // 1: entry; 2: entry and exit
struct MouthTriangles : Field<"triangles", "1", Integers<2>, Channels> {};
struct MouthWeights : Field<"weights", "1", Numbers<4>, Channels> {};
struct Points : Field<"points", "1", Integer, Channels> {};  // of the track
struct Position : Field<"x", "m", Vector, ChannelPoints> {
};  // the track: where the tip went, as tracers

// Whether a point (of any domain) is in a channel. State: it is how a point "followed".
template <class Domain> struct Member : Field<"member", "1", Integer, Domain> {};

using State = Fields<Needle, Mouths, MouthTriangles, MouthWeights, Points>;
using PointState = Fields<Position>;
}  // namespace channel

struct ChannelLimits {
  static constexpr double coverage = Grip::at_all;  // theta below which a point is not in tissue
  static constexpr double lip =
      Grip::fully;                      // theta where a thread is held as it comes out of a mouth
  static constexpr double mouth = 0.5;  // how close to a mouth a point passes through it [cells]
  static constexpr double track =
      0.5;  // how close to the track a point follows its neighbour [cells]
  static constexpr double spacing = 0.5;      // of track points [cells]
  static constexpr double penetration = 0.5;  // of a point that is not a member [cells]
};

// One environment's channels; the track of channel c has slots c * per_channel ... of its points.
template <class View, class PointView> struct ChannelSet {
  using T = typename View::Scalar;
  View view;
  PointView points;
  std::int64_t env;

  MPMPBD_HD std::int64_t capacity() const { return view.capacity; }
  MPMPBD_HD std::int64_t per_channel() const { return points.capacity / view.capacity; }
  MPMPBD_HD std::int64_t item(std::int64_t c) const { return env * view.capacity + c; }
  MPMPBD_HD std::int64_t point_item(std::int64_t c, std::int64_t i) const {
    return env * points.capacity + c * per_channel() + i;
  }

  MPMPBD_HD bool in_use(std::int64_t c) const {
    return view.template get<channel::Needle>(item(c)) != 0;
  }
  MPMPBD_HD bool belongs_to(std::int64_t c, std::int64_t needle) const {
    return view.template get<channel::Needle>(item(c)) == needle + 1;
  }
  MPMPBD_HD std::int64_t mouths(std::int64_t c) const {
    return view.template get<channel::Mouths>(item(c));
  }
  MPMPBD_HD std::int64_t track_points(std::int64_t c) const {
    return view.template get<channel::Points>(item(c));
  }
  MPMPBD_HD Vec3<T> track(std::int64_t c, std::int64_t i) const {
    return points.template get<channel::Position>(point_item(c, i));
  }

  MPMPBD_HD SurfaceMark<T> mouth(std::int64_t c, int m) const {
    auto const w = view.template get<channel::MouthWeights>(item(c));
    return {view.template get<channel::MouthTriangles>(item(c))[m], {{w[2 * m], w[2 * m + 1]}}};
  }
  MPMPBD_HD void set_mouth(std::int64_t c, int m, SurfaceMark<T> const& mark) const {
    auto t = view.template get<channel::MouthTriangles>(item(c));
    auto w = view.template get<channel::MouthWeights>(item(c));
    t[m] = mark.triangle;
    w[2 * m] = mark.weights[0];
    w[2 * m + 1] = mark.weights[1];
    view.template set<channel::MouthTriangles>(item(c), t);
    view.template set<channel::MouthWeights>(item(c), w);
    view.template set<channel::Mouths>(item(c), m + 1);
  }

  // The channel that a needle opened last, or -1.
  MPMPBD_HD std::int64_t latest(std::int64_t needle) const {
    for (std::int64_t c = capacity() - 1; c >= 0; --c)
      if (belongs_to(c, needle)) return c;
    return -1;
  }

  MPMPBD_HD void clear() const {
    for (std::int64_t c = 0; c < capacity(); ++c) {
      view.template set<channel::Needle>(item(c), 0);
      view.template set<channel::Mouths>(item(c), 0);
      view.template set<channel::MouthTriangles>(item(c), {});
      view.template set<channel::MouthWeights>(item(c), {});
      view.template set<channel::Points>(item(c), 0);
      for (std::int64_t i = 0; i < per_channel(); ++i)
        points.template set<channel::Position>(point_item(c, i), {});
    }
  }

  // Appends a point to the track; Fault::overflow when it is full.
  MPMPBD_HD std::uint32_t append(std::int64_t c, Vec3<T> const& x) const {
    std::int64_t const n = track_points(c);
    if (n >= per_channel()) return static_cast<std::uint32_t>(Fault::overflow);
    points.template set<channel::Position>(point_item(c, n), x);
    view.template set<channel::Points>(item(c), n + 1);
    return 0u;
  }

  // The tip has punctured the surface at `mark`, which is at x now. Slots are given out in order.
  MPMPBD_HD std::uint32_t open(std::int64_t needle, SurfaceMark<T> const& mark,
                               Vec3<T> const& x) const {
    std::int64_t c = 0;
    while (c < capacity() && in_use(c)) ++c;
    if (c == capacity()) return static_cast<std::uint32_t>(Fault::overflow);
    view.template set<channel::Needle>(item(c), needle + 1);
    view.template set<channel::Points>(item(c), 0);
    set_mouth(c, 0, mark);
    return append(c, x);
  }
  // The tip is in tissue at x: the track goes on when the tip is in new tissue, not when it draws
  // back.
  template <class Group_>
  MPMPBD_HD std::uint32_t extend(Group_ const& group, std::int64_t needle, Vec3<T> const& x,
                                 T dx) const {
    std::int64_t const c = latest(needle);
    if (c < 0 || mouths(c) > 1 || distance_to_track(group, c, x) < T(ChannelLimits::spacing) * dx)
      return 0u;
    std::uint32_t faults = 0;
    group.one([&] { faults = append(c, x); });
    return faults;
  }
  MPMPBD_HD std::uint32_t extend(std::int64_t needle, Vec3<T> const& x, T dx) const {
    return extend(Solo{}, needle, x, dx);
  }
  // The tip has left the tissue at `mark`. Through the mouth by which it came in, it only drew
  // back.
  MPMPBD_HD std::uint32_t close(std::int64_t needle, SurfaceMark<T> const& mark, Vec3<T> const& x,
                                Vec3<T> const& entry, T dx) const {
    std::int64_t const c = latest(needle);
    if (c < 0 || mouths(c) > 1 || norm(x - entry) < T(ChannelLimits::mouth) * dx) return 0u;
    set_mouth(c, 1, mark);
    return append(c, x);
  }

  // The lanes of a group share the pieces of the track.
  template <class Group_>
  MPMPBD_HD T distance_to_track(Group_ const& group, std::int64_t c, Vec3<T> const& x) const {
    auto const n = static_cast<int>(track_points(c));
    if (n == 0) return infinity<T>;
    std::int64_t const first = point_item(c, 0);
    auto at = [&](int i) { return points.template get<channel::Position>(first + i); };
    T distance = norm(x - at(0));
    group.each(n - 1,
               [&](int i) { distance = min(distance, distance_to_segment(at(i), at(i + 1), x)); });
    return group.min(distance);
  }
  MPMPBD_HD T distance_to_track(std::int64_t c, Vec3<T> const& x) const {
    return distance_to_track(Solo{}, c, x);
  }
  template <class Group_>
  MPMPBD_HD bool near_track(Group_ const& group, std::int64_t needle, Vec3<T> const& x,
                            T reach) const {
    for (std::int64_t c = 0; c < capacity(); ++c)
      if (belongs_to(c, needle) && distance_to_track(group, c, x) <= reach) return true;
    return false;
  }
  MPMPBD_HD bool near_track(std::int64_t needle, Vec3<T> const& x, T reach) const {
    return near_track(Solo{}, needle, x, reach);
  }
  template <class S>
  MPMPBD_HD bool near_mouth(std::int64_t needle, S const& sheet, Vec3<T> const& x, T reach) const {
    for (std::int64_t c = 0; c < capacity(); ++c)
      for (int m = 0; belongs_to(c, needle) && m < static_cast<int>(mouths(c)); ++m)
        if (norm(x - position(sheet, mouth(c, m))) <= reach) return true;
    return false;
  }

  // Track points are tracers, one in each of track_slots() or none: `velocity(x)` interpolates the grid.
  MPMPBD_HD int track_slots() const {
    return static_cast<int>(capacity()) * static_cast<int>(per_channel());
  }
  template <class Velocity>
  MPMPBD_HD void advect_track(int slot, Velocity const& velocity, T dt) const {
    auto const length = static_cast<int>(per_channel());
    int const c = slot / length;
    if (!in_use(c) || slot - c * length >= track_points(c)) return;
    std::int64_t const item = point_item(0, 0) + slot;
    auto const x = points.template get<channel::Position>(item);
    points.template set<channel::Position>(item, x + dt * velocity(x));
  }
};
template <class View, class PointView>
MPMPBD_HD ChannelSet<View, PointView> channel_set(View const& view, PointView const& points,
                                                  std::int64_t env) {
  return {view, points, env};
}

// What an event of the tip does to the channels; call it after advance_tip with the sheet as it is
// then.
template <class Group_, class Set, class S, class T>
MPMPBD_HD std::uint32_t advance_channel(Group_ const& group, Set const& set, std::int64_t needle,
                                        Tip<T> const& tip, TipChange<T> const& change,
                                        S const& sheet, T dx) {
  // While it looks out of the tissue (its mark is set) there is no track to lay.
  bool const in_tissue = tip.state == TipState::inside && tip.mark.triangle < 0;
  if (change.kind == EventKind::none)
    return in_tissue ? set.extend(group, needle, tip.position, dx) : 0u;
  std::uint32_t faults = 0;
  group.one([&] {
    if (change.kind == EventKind::entry)
      faults = set.open(needle, change.mark, change.position);
    else if (std::int64_t const c = set.latest(needle); c >= 0)
      faults =
          set.close(needle, change.mark, change.position, position(sheet, set.mouth(c, 0)), dx);
  });
  return faults;
}

// Whether a place is in a channel, as far as it knows by itself.
//
// A neighbour is followed only along the track: otherwise a thread that lies on the surface beside
// a mouth would become a member point by point.
enum class Following : int {
  no,
  yes,
  neighbour,  // if its neighbour towards the needle's tip is
  absent,     // there is no such place; what comes next has the neighbour that it would have had
};
template <class Set, class S, class T>
MPMPBD_HD Following following(Set const& set, std::int64_t needle, S const& sheet, Vec3<T> const& x,
                              T coverage, bool was_member, T dx) {
  if (!(coverage >= T(ChannelLimits::coverage))) return Following::no;
  if (was_member || set.near_mouth(needle, sheet, x, T(ChannelLimits::mouth) * dx))
    return Following::yes;
  return set.near_track(needle, x, T(ChannelLimits::track) * dx) ? Following::neighbour
                                                                 : Following::no;
}
// Whether place i is in a channel: as the next place that knows, towards the tip, down to `first`.
MPMPBD_HD inline bool is_member(Following const* places, int i, int first) {
  if (places[i] == Following::absent) return false;
  while (i >= first && (places[i] == Following::neighbour || places[i] == Following::absent)) --i;
  return i >= first && places[i] == Following::yes;
}

// What a point that is not a member does: nothing, or it lies on the surface. Sets `contact` and,
// on the surface, `axis` (the inward normal). Returns Fault::penetration when it is too deep.
template <class Group_, class Set, class S, class C, class T>
MPMPBD_HD std::uint32_t meet_surface(Group_ const& group, ContactPoint<T>& point, Set const& set,
                                     std::int64_t needle, S const& sheet, C const& columns, T dx) {
  Vec3<T> const x = point.position;
  // In the cut there is no surface to lie on.
  bool const meets = point.coverage > T(0) && is_inside(group, sheet, columns, x) &&
                     !set.near_track(group, needle, x, T(ChannelLimits::track) * dx);
  SurfacePoint<T> surface{};
  if (meets) surface = nearest_on_sheet(group, sheet, columns, x, dx, true);
  group.sync();  // all have read the point
  group.one([&] {
    point.contact = surface.found ? Contact::surface : Contact::off;
    if (surface.found) point.axis = -surface.normal;
  });
  bool const deep = surface.distance < -T(ChannelLimits::penetration) * dx;
  return deep ? static_cast<std::uint32_t>(Fault::penetration) : 0u;
}

// A thread goes through a mouth between its beads, too. So a bead stands for two places, one on either side of it; what
// is stored of it is which of them are in a channel.
enum ThreadSide : int { side_before = 1, side_after = 2 };
template <class T> struct ThreadPlace {
  Vec3<T> position;  // [m]
  T coverage;        // theta; negative: the thread has no such side
};

// A line of points in the order of the exchange: one per bead of the thread (its last bead is at the needle),
// then of the needle the tip's axial point and the points along the wire from tip to blunt end. Position, axis
// (tangent) and coverage are set; contact, and the axis of surface points, are set here. `member(q)` is the stored
// flag of point q, for a bead the sum of its sides in tissue; place(k, side) is where bead k's side is.
// `swaged`: the thread follows this needle.
//
// As a channel takes them, their places are numbered from the tip to the thread's far end: those along the wire,
// then of every bead the one after and the one before it.
struct ChannelOrder {
  int beads, needle_points;

  MPMPBD_HD int on_wire() const { return max(needle_points - 1, 0); }
  MPMPBD_HD int count() const { return on_wire() + 2 * beads; }
  MPMPBD_HD int of_bead(int k, int side) const {
    return on_wire() + 2 * (beads - 1 - k) + (side == side_after ? 0 : 1);
  }
  MPMPBD_HD int bead(int place) const { return beads - 1 - (place - on_wire()) / 2; }
  MPMPBD_HD int side(int place) const {
    return (place - on_wire()) % 2 == 0 ? side_after : side_before;
  }
};

// First the flags: every place by itself, as much as it knows (`places`, scratch for count() of them), then with
// what the places before it have found. By a team; wait before the points are read.
template <class Team_, class Places, class Members, class Set, class S, class T>
MPMPBD_HD void update_members(Team_ const& team, ContactPoint<T>* points, int beads,
                              int needle_points, bool swaged, Places const& place,
                              Members const& member, Tip<T> const& tip, Set const& set,
                              std::int64_t needle, S const& sheet, T dx, Following* places) {
  ChannelOrder const order{beads, needle_points};
  team.each(order.count(), [&](int i) {
    if (i < order.on_wire()) {
      int const q = beads + 1 + i;
      ContactPoint<T> const& p = points[q];
      // The tip is in tissue when its state says so.
      bool const inside = i == 0 && tip.state == TipState::inside,
                 touches = i == 0 && tip.state == TipState::touch;
      places[i] = touches ? Following::no
                          : following(set, needle, sheet, p.position, p.coverage,
                                      inside || member(q) != 0, dx);
    } else {
      int const k = order.bead(i), side = order.side(i);
      ThreadPlace<T> const p = place(k, side);
      places[i] = p.coverage < T(0) ? Following::absent
                                    : following(set, needle, sheet, p.position, p.coverage,
                                                (member(k) & side) != 0, dx);
    }
  });
  team.sync();
  team.each(beads + needle_points, [&](int q) {
    std::int64_t is = 0;
    int const first = swaged ? 0 : order.on_wire();
    if (q > beads) {
      is = is_member(places, q - beads - 1, 0) ? 1 : 0;
    } else if (q < beads) {
      for (int side = side_before; side <= side_after; ++side)
        if (is_member(places, order.of_bead(q, side), first)) is += side;
    }
    points[q].contact = is != 0 ? Contact::member : Contact::off;
    member.set(q, is);
    if (q == beads) {
      points[q].contact = tip.state == TipState::outside ? Contact::off : Contact::tip;
      points[q].force_cap = tip.cap;
    }
  });
}
// ... then every other point by itself (any order, in parallel). The tip's points belong to its
// state.
template <class Group_, class Set, class S, class C, class T>
MPMPBD_HD std::uint32_t settle_point(Group_ const& group, ContactPoint<T>* points, int q, int beads,
                                     Set const& set, std::int64_t needle, S const& sheet,
                                     C const& columns, T dx) {
  bool const of_tip = q == beads || q == beads + 1;
  if (of_tip || points[q].contact == Contact::member) return 0u;
  return meet_surface(group, points[q], set, needle, sheet, columns, dx);
}

}  // namespace mpmpbd
