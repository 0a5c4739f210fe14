// Channels: opened by a puncture, laid by the tip, closed by an exit; who is a member and who lies
// on top.
#include "catch.hpp"

#include "held_sheet.hpp"

#include <mpmpbd/needle/contact_points.hpp>
#include <mpmpbd/needle/suture_path.hpp>
#include <mpmpbd/surface/needle_surface.hpp>

using namespace mpmpbd;

namespace {

struct WirePoints {
  static constexpr FixedString name = "wire point";
};
using MemberField = channel::Member<WirePoints>;

template <class T> constexpr T cell = T(0.002);
template <class T> constexpr T top = T(0.024);

// Sheet, channels, events and flags of environment 1 of 2.
template <class T> struct Scene {
  static constexpr std::int64_t env = 1;
  Held<T> held = held_block<T>();
  Table<T, Channels, channel::State> channels;
  Table<T, ChannelPoints, channel::PointState> track;
  Table<T, Needles, union_t<needle::State, tip::Memory>> needles{2, 1};
  Table<T, Events, event::State> events{2, 8};
  Table<T, Environments, Fields<event::Count>> environments{2, 1};
  Table<T, WirePoints, Fields<MemberField>> flags{2, 64};
  ContactPoint<T> points[64]{};
  std::uint32_t faults = 0;

  explicit Scene(std::int64_t channel_capacity = 3, std::int64_t per_channel = 40)
      : channels(2, channel_capacity), track(2, channel_capacity * per_channel) {
    flags.set_live(env, 64);
  }

  auto set() { return channel_set(channels.view(), track.view(), env); }
  auto log() { return event_log(events.view(), environments.view(), env); }
  auto members() {
    auto const v = flags.view();
    return Row<decltype(v), MemberField>{v, env * v.capacity};
  }
  // How full of tissue the cells around x are: 1 inside, falling to 0 over a cell.
  T coverage(Vec3<T> const& x) const {
    return clamp(T(0.5) - block<T>().distance(x) / cell<T>, T(0), T(1));
  }
  void settle(int beads, int needle_points, bool swaged, Tip<T> const& tip) {
    for (int q = 0; q < beads + needle_points; ++q)
      points[q].coverage = coverage(points[q].position);
    auto const at_bead = [this](int k, int) {
      return ThreadPlace<T>{points[k].position, points[k].coverage};
    };
    Following places[128];
    update_members(Solo{}, points, beads, needle_points, swaged, at_bead, members(), tip, set(), 0,
                   held.sheet(), cell<T>, places);
    for (int q = 0; q < beads + needle_points; ++q)
      faults |= settle_point(Solo{}, points, q, beads, set(), std::int64_t{0}, held.sheet(),
                             held.columns(), cell<T>);
  }
  Tip<T> tip() { return Tip<T>::load(needles.view(), env); }
  // A straight channel down from the top at (x, y).
  void cut(T x, T y, T depth) {
    auto const start = vec<T>(x, y, top<T>);
    REQUIRE(set().open(0, mark_at(held.sheet(), start), start) == 0);
    for (int i = 1; T(i) * T(0.0011) <= depth; ++i)
      REQUIRE(set().extend(0, start - vec<T>(0, 0, T(i) * T(0.0011)), cell<T>) == 0);
  }
};

}  // namespace

TEMPLATE_TEST_CASE(
    "an arc needle goes through: one entry, one exit, a track along the arc, members behind the tip",
    "[channel][needle]", float, double) {
  using T = TestType;
  Scene<T> s;
  // Phantom: markers 12 mm apart on the top, needle of 6.4 mm; positions off the vertices.
  Vec3<double> const entry{{0.0201, 0.0161, 0.024}}, exit{{0.0321, 0.0161, 0.024}};
  Arc<double> const arc{0.0064, 3.141592653589793, 0.0004, 0.002};
  auto const path = SuturePath::between(entry, exit, vec(0.0, 0.0, 1.0), arc.radius);
  auto const script = suture_script(path, arc);
  Arc<T> const wire{T(arc.radius), T(arc.angle), T(arc.wire_radius), T(arc.taper)};
  auto const spacing = ArcPoints<T>::over(wire, cell<T>);
  int const n = contact_points(spacing);
  auto const view = s.needles.view();
  auto const first = cast_pose<T>(script.start);
  Tip<T>::at(to_world(first, wire.point(T(0)))).store(view, 1);
  TipForces<T> const forces{T(0.15), T(0.05)};
  double const dt = 1e-3;
  int members_before_entry = 0, most_members = 0, last_members = -1;
  bool order = true;
  for (int i = 0; i < 10000; ++i) {
    auto const pose = cast_pose<T>(script.pose(i * dt));
    for (int k = 0; k < n; ++k) place_contact_point(s.points[k], k, wire, spacing, pose);
    s.settle(0, n, false, s.tip());
    int members = 0;
    for (int k = 1; k < n; ++k) members += s.points[k].contact == Contact::member;
    if (s.log().count() == 0) members_before_entry += members;
    most_members = max(most_members, members);
    last_members = members;
    // Members form one piece: a point is one only next to another one or at a mouth.
    int changes = 0;
    for (int k = 2; k < n; ++k)
      changes +=
          (s.points[k].contact == Contact::member) != (s.points[k - 1].contact == Contact::member);
    order = order && changes <= 2;
    auto const tip_now = to_world(cast_pose<T>(script.pose((i + 1) * dt)), wire.point(T(0)));
    // The tissue is rigid here: it resists with whatever the tip can bear.
    T const impulse = s.points[0].contact == Contact::tip ? s.points[0].force_cap * T(dt) : T(0);
    s.faults |=
        update_needle_surface(Solo{}, view, std::int64_t{1}, std::int64_t{0}, tip_now, impulse,
                              Tick<T>{T(dt), T(dt), i}, T(i * dt), s.held.sheet(), s.held.columns(),
                              cell<T>, forces, cast<T>(entry), cast<T>(exit), s.set(), s.log());
  }
  REQUIRE(s.faults == 0);
  REQUIRE(s.log().count() == 2);
  auto const in = s.log()(0), out = s.log()(1);
  REQUIRE(in.kind == EventKind::entry);
  REQUIRE(out.kind == EventKind::exit);
  REQUIRE(in.miss < T(2e-5));
  REQUIRE(out.miss < T(2e-5));
  REQUIRE(in.force == Approx(0.15));
  REQUIRE(out.time > in.time + T(2));
  REQUIRE(out.time < T(6));
  REQUIRE(members_before_entry == 0);
  REQUIRE(most_members >= 7);  // 139 of 180 degrees of 15 points
  REQUIRE(last_members == 0);  // the needle is out
  REQUIRE(order);
  auto const set = s.set();
  REQUIRE(set.in_use(0));
  REQUIRE_FALSE(set.in_use(1));
  REQUIRE(set.mouths(0) == 2);
  REQUIRE(norm(position(s.held.sheet(), set.mouth(0, 0)) - cast<T>(entry)) < T(2e-5));
  REQUIRE(norm(position(s.held.sheet(), set.mouth(0, 1)) - cast<T>(exit)) < T(2e-5));
  // Every point of the track is on the arc, spaced half a cell.
  for (std::int64_t i = 0; i < set.track_points(0); ++i) {
    auto const r = set.track(0, i) - cast<T>(path.centre);
    REQUIRE(norm(r) == Approx(arc.radius).epsilon(1e-3));
    if (i + 1 < set.track_points(0))
      REQUIRE(norm(set.track(0, i + 1) - set.track(0, i)) < T(0.6) * cell<T>);
  }
  REQUIRE(set.track_points(0) == Approx(path.angle * arc.radius / 0.001).margin(3));
  // Environment 0 has seen nothing.
  REQUIRE(s.environments.template get<event::Count>(0, 0) == 0);
  REQUIRE(s.channels.template get<channel::Needle>(0, 0) == 0);
}

TEMPLATE_TEST_CASE("a thread that follows through a mouth becomes a member, point by point",
                   "[channel]", float, double) {
  using T = TestType;
  Scene<T> s;
  s.cut(T(0.0203), T(0.0161), T(0.012));
  auto const outside = Tip<T>::at(vec<T>(0, 0, T(0.03)));
  int const n = 16;
  // Straight above the channel, drawn down by a twentieth of a cell per step; point n - 1 leads.
  for (int step = 0; step <= 180; ++step) {
    for (int q = 0; q < n; ++q) {
      s.points[q].position = vec<T>(
          T(0.0203), T(0.0161), top<T> + T(0.002) + T(n - 1 - q) * T(0.001) - T(step) * T(0.0001));
      s.points[q].axis = vec<T>(0, 0, T(-1));
    }
    s.settle(n, 0, false, outside);
    for (int q = 0; q < n; ++q) {
      T const depth = top<T> - s.points[q].position[2];
      if (abs(depth + T(0.0005)) >
          T(2e-5)) {  // coverage 0.25 is a quarter of a cell above the surface
        CAPTURE(step, q);
        REQUIRE((s.points[q].contact == Contact::member) == (depth > T(-0.0005)));
      }
      if (s.points[q].contact == Contact::member) REQUIRE(s.points[q].axis == vec<T>(0, 0, T(-1)));
    }
  }
  REQUIRE(s.faults == 0);
}

TEMPLATE_TEST_CASE("a thread on the surface is not glued to it, beside a mouth neither",
                   "[channel]", float, double) {
  using T = TestType;
  Scene<T> s;
  bool const with_channel = GENERATE(false, true);
  if (with_channel) s.cut(T(0.0203), T(0.0161), T(0.012));
  auto const outside = Tip<T>::at(vec<T>(0, 0, T(0.03)));
  int const down = with_channel ? 8 : 0, n = 24 + down;
  for (int q = 24; q < n; ++q)
    s.members().set(q, side_before + side_after);  // these have come through the mouth
  for (int step = 0; step < 200; ++step) {
    // The end comes up through the channel; the rest lies on the surface, pressed in by a fifth of
    // a cell.
    for (int q = 0; q < n; ++q) {
      T const along = T(n - 1 - q) * T(0.001) - T(down) * T(0.001);
      s.points[q].position =
          along < T(0) ? vec<T>(T(0.0203), T(0.0161), top<T> + along)
                       : vec<T>(T(0.0203) + along * T(0.8), T(0.0161), top<T> - T(0.2) * cell<T>);
    }
    s.settle(n, 0, false, outside);
  }
  REQUIRE(s.faults == 0);
  int on_surface = 0;
  for (int q = 0; q < n; ++q) {
    T const r = s.points[q].position[0] - T(0.0203);
    bool const in_cut = with_channel && r <= T(0.5) * cell<T>;
    CAPTURE(q, with_channel);
    REQUIRE((s.points[q].contact == Contact::member) == in_cut);
    if (!in_cut) {
      REQUIRE(s.points[q].contact == Contact::surface);
      REQUIRE(norm(s.points[q].axis - vec<T>(0, 0, T(-1))) < T(1e-6));
      ++on_surface;
    }
  }
  REQUIRE(on_surface >= 20);
}

TEMPLATE_TEST_CASE("off the tissue nothing is felt; too deep without a puncture sets the bit",
                   "[channel]", float, double) {
  using T = TestType;
  Scene<T> s;
  auto const outside = Tip<T>::at(vec<T>(0, 0, T(0.03)));
  auto one = [&](Vec3<T> const& x) {
    s.faults = 0;
    s.points[0].position = x;
    s.settle(1, 0, false, outside);
    return s.points[0].contact;
  };
  REQUIRE(one(vec<T>(T(0.02), T(0.016), T(0.0245))) == Contact::off);
  REQUIRE(one(vec<T>(T(0.02), T(0.016), T(0.0285))) == Contact::off);
  REQUIRE(one(vec<T>(T(0.02), T(0.016), T(0.0239))) == Contact::surface);
  REQUIRE(s.faults == 0);
  REQUIRE(one(vec<T>(T(0.02), T(0.016), T(0.02301))) == Contact::surface);
  REQUIRE(s.faults == 0);
  REQUIRE(one(vec<T>(T(0.02), T(0.016), T(0.02299))) == Contact::surface);
  REQUIRE(has(s.faults, Fault::penetration));
  // So deep that the surface is out of reach: reported, and not pushed in some direction.
  REQUIRE(one(vec<T>(T(0.02), T(0.016), T(0.014))) == Contact::off);
  REQUIRE(has(s.faults, Fault::penetration));
  // On a side face the axis points inwards there.
  REQUIRE(one(vec<T>(T(0.0459), T(0.016), T(0.014))) == Contact::surface);
  REQUIRE(norm(s.points[0].axis - vec<T>(T(-1), 0, 0)) < T(1e-4));
}

// A loop that hangs out of the cut, and comes back to it from the side.
TEMPLATE_TEST_CASE("what follows through the air does not follow", "[channel]", float, double) {
  using T = TestType;
  Scene<T> s;
  s.cut(T(0.0203), T(0.0161), T(0.012));
  auto const at = [&](int k, T z) { s.points[k].position = vec<T>(T(0.0203), T(0.0161), z); };
  at(2, T(0.0242));  // in the mouth
  at(1, T(0.0222));
  at(0, T(0.0180));
  s.settle(3, 0, false, Tip<T>::at(vec<T>(0, 0, T(0.03))));
  for (int k : {2, 1, 0}) REQUIRE(s.points[k].contact == Contact::member);
  for (int k : {2, 1, 0}) s.members().set(k, 0);
  at(1, T(0.0285));
  s.settle(3, 0, false, Tip<T>::at(vec<T>(0, 0, T(0.03))));
  REQUIRE(s.points[2].contact == Contact::member);
  REQUIRE(s.points[1].contact == Contact::off);
  REQUIRE(s.points[0].contact == Contact::off);
}

TEMPLATE_TEST_CASE("a member stays one wherever the track is, until it leaves the tissue",
                   "[channel]", float, double) {
  using T = TestType;
  Scene<T> s;
  s.cut(T(0.0203), T(0.0161), T(0.012));
  auto const outside = Tip<T>::at(vec<T>(0, 0, T(0.03)));
  auto one = [&](T x, T z) {
    s.points[0].position = vec<T>(x, T(0.0161), z);
    s.settle(1, 0, false, outside);
    return s.points[0].contact;
  };
  REQUIRE(one(T(0.0203), T(0.0242)) == Contact::member);  // through the mouth
  REQUIRE(one(T(0.0203), T(0.0200)) == Contact::member);
  REQUIRE(one(T(0.0263), T(0.0200)) ==
          Contact::member);  // three cells beside the track: it was a member
  REQUIRE(one(T(0.0263), T(0.0249)) == Contact::off);  // out
  REQUIRE(one(T(0.0263), T(0.0239)) ==
          Contact::surface);  // and it does not get back in but by a mouth
  REQUIRE(s.faults == 0);
  REQUIRE(one(T(0.0203), T(0.0242)) == Contact::member);
}

TEMPLATE_TEST_CASE("mouths and track go with the tissue", "[channel]", float, double) {
  using T = TestType;
  Scene<T> s;
  s.cut(T(0.0203), T(0.0161), T(0.006));
  T const dt = T(1e-3);
  auto velocity = [](Vec3<T> const& x) {
    return vec<T>(T(0.2) + T(5) * (x[2] - top<T>), T(0), T(0));
  };
  auto const before = s.set().track(0, 3);
  auto sheet = s.held.sheet();
  auto const mouth_before = position(sheet, s.set().mouth(0, 0));
  for (int i = 0; i < 10; ++i) {
    for (std::int64_t v = 0; v < sheet.vertices; ++v) advect(sheet.vertex, v, velocity, dt);
    for (int slot = 0; slot < s.set().track_slots(); ++slot)
      s.set().advect_track(slot, velocity, dt);
  }
  REQUIRE(norm(position(sheet, s.set().mouth(0, 0)) - mouth_before - vec<T>(T(0.002), 0, 0)) <
          T(1e-7));
  REQUIRE(norm(s.set().track(0, 3) - before - T(0.01) * velocity(before)) < T(1e-7));
}

TEMPLATE_TEST_CASE(
    "drawing back lays no track and makes no second mouth; a new puncture opens a new channel",
    "[channel]", float, double) {
  using T = TestType;
  Scene<T> s;
  s.cut(T(0.0203), T(0.0161), T(0.006));
  auto const set = s.set();
  auto const points = set.track_points(0);
  for (int i = 0; i < 60; ++i)
    REQUIRE(set.extend(0, vec<T>(T(0.0204), T(0.0161), top<T> - T(0.0055) + T(i) * T(0.00009)),
                       cell<T>) == 0);
  REQUIRE(set.track_points(0) == points);
  auto const mouth = position(s.held.sheet(), set.mouth(0, 0));
  REQUIRE(set.close(0, set.mouth(0, 0), mouth + vec<T>(T(0.0002), 0, 0), mouth, cell<T>) == 0);
  REQUIRE(set.mouths(0) == 1);
  s.cut(T(0.0303), T(0.0161), T(0.004));
  REQUIRE(set.latest(0) == 1);
  REQUIRE(set.track_points(0) == points);
  // The other needle's channels are not this one's.
  REQUIRE(set.latest(1) == -1);
  REQUIRE(set.near_mouth(0, s.held.sheet(), mouth, T(0.001)));
  REQUIRE_FALSE(set.near_mouth(1, s.held.sheet(), mouth, T(0.001)));
  // After reset nothing is left, in fields or elsewhere.
  set.clear();
  Scene<T> fresh;
  REQUIRE(s.channels.template planes<channel::Points>() ==
          fresh.channels.template planes<channel::Points>());
  REQUIRE(s.channels.template planes<channel::MouthWeights>() ==
          fresh.channels.template planes<channel::MouthWeights>());
  REQUIRE(s.track.template planes<channel::Position>() ==
          fresh.track.template planes<channel::Position>());
}

TEST_CASE("capacities that are too small set the overflow bit and lose nothing else", "[channel]") {
  Scene<double> s(1, 4);
  auto const set = s.set();
  auto const x = vec(0.0203, 0.0161, 0.024);
  auto const mark = mark_at(s.held.sheet(), x);
  REQUIRE(set.open(0, mark, x) == 0);
  for (int i = 1; i < 4; ++i) REQUIRE(set.extend(0, x - vec(0.0, 0.0, 0.0011 * i), 0.002) == 0);
  REQUIRE(set.extend(0, x - vec(0.0, 0.0, 0.0055), 0.002) ==
          static_cast<std::uint32_t>(Fault::overflow));
  REQUIRE(set.track_points(0) == 4);
  REQUIRE(set.open(0, mark, x) == static_cast<std::uint32_t>(Fault::overflow));
  REQUIRE(set.mouths(0) == 1);
  // A channel without room for a track is near nothing.
  Scene<double> bare(1, 0);
  REQUIRE(bare.set().open(0, mark, x) == static_cast<std::uint32_t>(Fault::overflow));
  REQUIRE_FALSE(bare.set().near_track(0, x, 0.002));
  // Of the list of events.
  for (int i = 0; i < 8; ++i)
    REQUIRE(s.log().append({EventKind::entry, 0, mark, x, i, 0.1 * i, 0.15, 0.0}) == 0);
  REQUIRE(s.log().append({EventKind::exit, 0, mark, x, 9, 0.9, 0.15, 0.0}) ==
          static_cast<std::uint32_t>(Fault::overflow));
  REQUIRE(s.log().count() == 8);
  REQUIRE(s.log()(7).step == 7);
  REQUIRE(s.events.get<event::Kind>(0, 0) == 0);
  s.log().clear();
  REQUIRE(s.log().count() == 0);
}

TEMPLATE_TEST_CASE("a whole thread behind the needle: members only behind members",
                   "[channel][needle]", float, double) {
  using T = TestType;
  Scene<T> s;
  s.cut(T(0.0203), T(0.0161), T(0.012));
  // Six needle points lead down the channel (the tip inside), twelve thread points follow; the last
  // bead is at the needle, so thread point 11 is next to it.
  auto tip = Tip<T>::at(vec<T>(T(0.0203), T(0.0161), T(0.016)));
  tip.state = TipState::inside;
  tip.cap = T(0.05);
  int const beads = 12, needle_points = 7;
  bool const swaged = GENERATE(false, true);
  for (int down = 0; down < 3; ++down) {
    T const z = T(0.016) - T(down) * T(0.002);
    s.points[beads].position = vec<T>(T(0.0203), T(0.0161), z);
    for (int k = 1; k < needle_points; ++k)
      s.points[beads + k].position = vec<T>(T(0.0203), T(0.0161), z + T(k - 1) * T(0.001));
    for (int q = 0; q < beads; ++q)
      s.points[q].position =
          vec<T>(T(0.0203), T(0.0161), z + T(0.006) + T(beads - 1 - q) * T(0.001));
    s.settle(beads, needle_points, swaged, tip);
  }
  REQUIRE(s.points[beads].contact == Contact::tip);
  REQUIRE(s.points[beads].force_cap == T(0.05));
  for (int k = 1; k < needle_points; ++k) REQUIRE(s.points[beads + k].contact == Contact::member);
  for (int q = 0; q < beads; ++q) {
    bool const in = s.points[q].position[2] < top<T> + T(0.0005);
    CAPTURE(q, swaged);
    if (!swaged && s.points[q].position[2] < top<T> - T(0.0011))
      continue;  // placed inside without a mouth
    REQUIRE((s.points[q].contact == Contact::member) == in);
  }
  if (swaged) REQUIRE(s.faults == 0);
}
