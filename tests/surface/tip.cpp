// The tip against the surface: touch, puncture, exit; hysteresis, hard cases, faults (A4.6, B32).
#include "catch.hpp"

#include "held_sheet.hpp"

#include <mpmpbd/surface/tip.hpp>

using namespace mpmpbd;

namespace {

template <class T> constexpr T cell = T(0.002);
template <class T> constexpr T dt = T(9.3e-5);
template <class T> TipForces<T> forces() { return {T(0.15), T(0.05)}; }

// Tip and sheet with everything that a substep needs.
template <class T> struct Trial {
  Held<T> held = held_block<T>();
  Tip<T> tip;
  int entries = 0, exits = 0;
  std::uint32_t faults = 0;
  TipChange<T> last{};

  explicit Trial(Vec3<T> const& start) : tip(Tip<T>::at(start)) {}

  TipChange<T> step(Vec3<T> const& to, T force) {
    auto const change = advance_tip(tip, to, force * dt<T>, dt<T>, held.sheet(), held.columns(),
                                    cell<T>, forces<T>());
    entries += change.kind == EventKind::entry;
    exits += change.kind == EventKind::exit;
    faults |= change.faults;
    if (change.kind != EventKind::none) last = change;
    return change;
  }
  // Pushes the surface in around (x, y): the dimple follows the tip.
  void dimple(Vec3<T> const& at, T depth) {
    auto s = held.sheet();
    auto const rest = box_sheet(block<T>(), Vec3<int>{{20, 10, 10}});
    for (std::int64_t i = 0; i < s.vertices; ++i) {
      auto x = rest.positions[static_cast<std::size_t>(i)];
      T const r2 = (square(x[0] - at[0]) + square(x[1] - at[1])) / square(T(1.5) * cell<T>);
      if (x[2] == block<T>().high[2]) x[2] -= depth * exp(-r2);
      s.vertex.set(i, x);
    }
    faults |= held.columns().build(held.sheet());
  }
};

template <class T> constexpr T top = T(0.024);
template <class T> Vec3<T> above(T height) { return vec<T>(T(0.0203), T(0.0161), top<T> + height); }

}  // namespace

TEMPLATE_TEST_CASE("the way of a tip: outside, touch, puncture, exit on the other side",
                   "[surface][tip]", float, double) {
  using T = TestType;
  Trial<T> t(above(T(0.003)));
  T const h = T(0.00005);
  // Down to the surface: nothing before touch.
  for (int i = 0; i < 59; ++i) t.step(above(T(0.003) - T(i) * h), T(0));
  REQUIRE(t.tip.state == TipState::outside);
  REQUIRE(t.tip.cap == T(0));
  t.step(above(T(-0.00001)), T(0));
  REQUIRE(t.tip.state == TipState::touch);
  REQUIRE(t.tip.cap == forces<T>().puncture);
  REQUIRE(t.tip.touch_point[2] == Approx(top<T>).epsilon(1e-6));
  REQUIRE(t.tip.touch_normal[2] == Approx(1));
  REQUIRE(t.entries == 0);
  // At the cap for one substep: through, exactly once.
  auto const change = t.step(above(T(-0.00006)), t.tip.cap);
  REQUIRE(change.kind == EventKind::entry);
  REQUIRE(change.force == Approx(0.15));
  REQUIRE(norm(change.position - above(T(0))) < T(1e-7));
  REQUIRE(t.tip.state == TipState::inside);
  REQUIRE(t.tip.cap == forces<T>().cutting);
  // Through the block along x and out of its side at x = 46 mm. At the cutting force nothing
  // happens.
  Vec3<T> x = above(T(-0.008));
  for (int i = 0; i < 1000; ++i)
    t.step(above(T(-0.00006) - T(0.008) * T(i) / T(1000)), forces<T>().cutting);
  REQUIRE(t.entries == 1);
  while (x[0] < T(0.0465)) {
    x[0] += h;
    t.step(x, forces<T>().cutting);
    if (x[0] < T(0.046) + T(0.1) * cell<T> - h) REQUIRE(t.exits == 0);
  }
  REQUIRE(t.exits == 1);
  REQUIRE(t.last.position[0] == Approx(0.046).epsilon(1e-6));
  REQUIRE(norm(t.last.position - vec<T>(T(0.046), x[1], x[2])) < T(1e-6));
  REQUIRE(t.tip.state == TipState::outside);
  REQUIRE(t.tip.cap == T(0));
  REQUIRE(t.faults == 0);
}

TEMPLATE_TEST_CASE("just below the threshold there is no event, just above exactly one",
                   "[surface][tip][A4.6]", float, double) {
  using T = TestType;
  // A spring under the tip, pushed with a given force for 10,000 substeps: depth = F / k, about
  // half a cell.
  T const stiffness = forces<T>().puncture / (T(0.5) * cell<T>);
  for (double share : {0.98, 1.02}) {
    Trial<T> t(above(T(0.0002)));
    T const push = T(share) * forces<T>().puncture;
    T depth = T(0);
    T before = T(0), after = T(0);
    int punctured_at = -1;
    for (int i = 0; i < 10000 && punctured_at < 0; ++i) {
      // The force grows slowly, then chatters by 1 % around its value.
      T const wanted = min(T(1), T(i) / T(2000)) * push * (i > 2000 && i % 2 ? T(0.99) : T(1));
      T const force = t.tip.state == TipState::outside ? T(0) : min(wanted, t.tip.cap);
      depth = force / stiffness;
      if (i % 25 == 0 && depth > T(0)) t.dimple(above(T(0)), depth);
      t.step(above(i < 2 ? T(0.0001) : -depth - T(1e-6)), force);
      if (t.entries && punctured_at < 0) {
        punctured_at = i;
        before = force;
        after = t.tip.cap;
      }
    }
    CAPTURE(share, punctured_at);
    REQUIRE(t.faults == 0);
    if (share < 1) {
      REQUIRE(t.entries == 0);
      REQUIRE(t.tip.state == TipState::touch);
    } else {
      REQUIRE(t.entries == 1);
      REQUIRE(punctured_at < 2010);
      REQUIRE(before == Approx(0.15).epsilon(1e-5));
      REQUIRE(after == forces<T>().cutting);  // the force drops at once
      // Pushed on with the same chatter: still one.
      for (int i = 0; i < 1000; ++i)
        t.step(above(-depth - T(1e-6) - T(i % 7) * T(1e-6)), forces<T>().cutting);
      REQUIRE(t.entries == 1);
      REQUIRE(t.exits == 0);
    }
  }
}

TEMPLATE_TEST_CASE("impulse at the threshold makes one event, whatever the dt", "[surface][tip]",
                   float, double) {
  using T = TestType;
  for (double length : {1e-6, 1.2e-4, 3.0e-3})
    for (double share : {0.98, 1.0, 1.02}) {
      Trial<T> t(above(T(0.0001)));
      t.step(above(T(-0.00001)), T(0));
      T const step = T(length), force = min(T(share) * forces<T>().puncture, t.tip.cap);
      auto const change = advance_tip(t.tip, above(T(-0.00002)), force * step, step, t.held.sheet(),
                                      t.held.columns(), cell<T>, forces<T>());
      REQUIRE((change.kind == EventKind::entry) == (share >= 1));
    }
}

TEMPLATE_TEST_CASE("exactly on the surface, sliding along it, and chattering through it: no event",
                   "[surface][tip]", float, double) {
  using T = TestType;
  Trial<T> t(above(T(0)));
  for (int i = 0; i < 300; ++i) {
    t.step(above(T(0)) + vec<T>(T(i) * T(0.00007), T(0), T(0)),
           T(0.02));  // through vertices, edges, diagonals
    REQUIRE(t.tip.state == TipState::touch);
  }
  t.tip.position = above(T(0));
  for (int i = 0; i < 300; ++i) t.step(above(i % 2 ? T(1e-5) : T(-1e-5)), i % 2 ? T(0) : T(0.1));
  REQUIRE(t.tip.state == TipState::touch);
  REQUIRE(t.entries == 0);
  REQUIRE(t.exits == 0);
  REQUIRE(t.faults == 0);
  // Only 0.1 cell of clearance ends the touch; then it can begin anew.
  t.step(above(T(0.099) * cell<T>), T(0));
  REQUIRE(t.tip.state == TipState::touch);
  t.step(above(T(0.101) * cell<T>), T(0));
  REQUIRE(t.tip.state == TipState::outside);
  REQUIRE(t.tip.cap == T(0));
  t.step(above(T(-0.01) * cell<T>), T(0));
  REQUIRE(t.tip.state == TipState::touch);
  REQUIRE(t.entries == 0);
}

TEMPLATE_TEST_CASE("a tip that looks out and comes back makes no event", "[surface][tip]", float,
                   double) {
  using T = TestType;
  Trial<T> t(above(T(0.0001)));
  t.step(above(T(-0.00001)), T(0));
  t.step(above(T(-0.00002)), t.tip.cap);
  REQUIRE(t.tip.state == TipState::inside);
  // Out of the side face and back, 100 times, never by 0.1 cell.
  T const side = T(0.046);
  Vec3<T> x = above(T(-0.005));
  x[0] = side - T(0.0001);
  t.tip.position = x;
  for (int i = 0; i < 100; ++i) {
    t.step(vec<T>(side + T(0.08) * cell<T>, x[1], x[2]), T(0.05));
    REQUIRE(t.tip.mark.triangle >= 0);
    t.step(x, T(0.05));
    REQUIRE(t.tip.mark.triangle == -1);
  }
  REQUIRE(t.exits == 0);
  REQUIRE(t.tip.state == TipState::inside);
  // Then out for good, obliquely: the exit is where it crossed, not the nearest point at the end.
  t.step(vec<T>(side + T(0.05) * cell<T>, x[1], x[2]), T(0.05));
  t.step(vec<T>(side + T(0.3) * cell<T>, x[1] + T(0.0004), x[2]), T(0.05));
  REQUIRE(t.exits == 1);
  REQUIRE(t.last.position[1] == Approx(static_cast<double>(x[1])).epsilon(1e-5));
}

TEMPLATE_TEST_CASE("the sheet may come to the tip, and through it", "[surface][tip]", float,
                   double) {
  using T = TestType;
  Trial<T> t(above(T(0.00003)));
  t.step(above(T(0.00003)), T(0));
  REQUIRE(t.tip.state == TipState::outside);
  auto s = t.held.sheet();
  for (std::int64_t i = 0; i < s.vertices; ++i)
    s.vertex.set(i, s.vertex(i) + vec<T>(T(0), T(0), T(0.00005)));
  t.step(above(T(0.00003)), T(0));
  REQUIRE(t.tip.state == TipState::touch);
  REQUIRE(t.tip.touch_point[2] == Approx(static_cast<double>(top<T>) + 0.00005).epsilon(1e-6));
  // And away again.
  for (std::int64_t i = 0; i < s.vertices; ++i)
    s.vertex.set(i, s.vertex(i) - vec<T>(T(0), T(0), T(0.0004)));
  t.step(above(T(0.00003)), T(0));
  REQUIRE(t.tip.state == TipState::outside);
}

TEMPLATE_TEST_CASE("a dimple deeper than 1.5 cells sets its bit, before that nothing does",
                   "[surface][tip]", float, double) {
  using T = TestType;
  Trial<T> t(above(T(0.00003)));
  t.step(above(T(-1e-6)), T(0));
  for (int i = 1; i <= 160; ++i) {
    T const depth = T(i) * T(0.01) * cell<T>;
    t.dimple(above(T(0)), depth * T(1.02));
    t.step(above(-depth), T(0.1));
    CAPTURE(i);
    if (i != 150) REQUIRE(has(t.faults, Fault::dimple) == (i > 150));
    REQUIRE_FALSE(has(t.faults, Fault::penetration));
  }
  REQUIRE(t.entries == 0);
}

TEMPLATE_TEST_CASE("a tip that sinks in without puncture, or jumps through the body, is reported",
                   "[surface][tip]", float, double) {
  using T = TestType;
  {
    Trial<T> t(above(T(0.00003)));
    t.step(above(T(-0.0001)), T(0));
    for (int i = 1; i < 12; ++i) {
      t.step(above(-T(i) * T(0.1) * cell<T>), T(0.1));
      if (i != 5) REQUIRE(has(t.faults, Fault::penetration) == (i > 5));
    }
  }
  {  // Three cells in one substep, into the body.
    Trial<T> t(above(T(0.0001)));
    t.step(above(T(-0.0059)), T(0));
    REQUIRE(has(t.faults, Fault::speed));
    REQUIRE(has(t.faults, Fault::penetration));
    REQUIRE(t.tip.state == TipState::touch);
    REQUIRE(t.entries == 0);
    REQUIRE(norm(t.tip.touch_point - above(T(0))) < T(1e-7));  // where it went through
  }
  {  // Through the whole body: 11 cells.
    Trial<T> t(above(T(0.0001)));
    t.step(above(T(-0.022)), T(0));
    REQUIRE(has(t.faults, Fault::penetration));
    REQUIRE(t.tip.state == TipState::outside);
  }
  {  // Grazing a corner by less than half a cell is none of that.
    Trial<T> t(vec<T>(T(0.0455), T(0.0161), T(0.0242)));
    t.step(vec<T>(T(0.0462), T(0.0161), T(0.0237)), T(0));
    REQUIRE(t.faults == 0);
    REQUIRE(t.tip.state == TipState::outside);
  }
}

TEMPLATE_TEST_CASE("a tip that the surface does not resist goes in where it meets it",
                   "[surface][tip]", float, double) {
  using T = TestType;
  auto held = held_block<T>();
  Tip<T> tip = Tip<T>::at(above(T(0.0001)));
  auto const to = [&](T height) {
    return advance_tip(tip, above(height), T(0), dt<T>, held.sheet(), held.columns(), cell<T>,
                       TipForces<T>{T(0), T(0)});
  };
  CHECK(to(T(0.00005)).kind == EventKind::none);
  CHECK(to(T(-0.00005)).kind == EventKind::none);
  CHECK(tip.state == TipState::touch);
  auto const change = to(T(-0.0001));
  CHECK(change.kind == EventKind::entry);
  CHECK(change.faults == 0);
  CHECK(tip.state == TipState::inside);

  tip = Tip<T>::at(above(T(0.00005)));
  to(T(-0.00005));
  CHECK(tip.state == TipState::touch);
  CHECK(to(T(0.0003)).kind == EventKind::none);  // it is drawn back
  CHECK(tip.state == TipState::outside);
}

TEST_CASE("a tip whose sheet has gone is outside, and nothing has happened", "[surface][tip]") {
  Trial<double> t(above(0.00005));
  auto none = t.held.sheet();
  none.triangles = 0;
  for (TipState const state : {TipState::outside, TipState::touch, TipState::inside}) {
    t.tip.state = state;
    auto const change = advance_tip(t.tip, above(-0.0001), 1.0, dt<double>, none, t.held.columns(),
                                    cell<double>, forces<double>());
    CHECK(change.kind == EventKind::none);
    CHECK(change.faults == 0);
    CHECK(t.tip.state == TipState::outside);
  }
}

TEST_CASE("a NaN stops at the tip", "[surface][tip]") {
  Trial<double> t(above(0.001));
  auto const before = t.tip;
  auto const change = advance_tip(t.tip, vec(0.0, std::nan(""), 0.0), 0.0, 1e-4, t.held.sheet(),
                                  t.held.columns(), 0.002, forces<double>());
  REQUIRE(change.faults == static_cast<std::uint32_t>(Fault::not_finite));
  REQUIRE(change.kind == EventKind::none);
  REQUIRE(t.tip.position == before.position);
}

TEMPLATE_TEST_CASE("all of the tip's memory is in fields: restored, it goes on to the same bits",
                   "[surface][tip][state]", float, double) {
  using T = TestType;
  Table<T, Needles, tip::Memory> table(3, 1), saved(3, 1);
  Held<T> held = held_block<T>();
  std::int64_t const item = 2;
  auto way = [](int i) { return above(T(0.0004) - T(i) * T(0.00003)); };
  auto run = [&](int from, int to) {
    std::vector<Vec3<T>> seen;
    for (int i = from; i < to; ++i) {
      auto tip = Tip<T>::load(table.view(), item);
      auto const change = advance_tip(tip, way(i), i > 20 ? tip.cap * dt<T> : T(0), dt<T>,
                                      held.sheet(), held.columns(), cell<T>, forces<T>());
      tip.store(table.view(), item);
      seen.push_back(vec<T>(T(static_cast<int>(change.kind)), tip.cap, change.position[2]));
    }
    return seen;
  };
  Tip<T>::at(above(T(0.0004))).store(table.view(), item);
  run(0, 15);
  for (std::int64_t e = 0; e < 3; ++e) saved.copy_environment(e, table, e);
  auto const first = run(15, 40);
  for (std::int64_t e = 0; e < 3; ++e) table.copy_environment(e, saved, e);
  auto const second = run(15, 40);
  REQUIRE(first == second);
  int entries = 0;
  for (auto const& s : first) entries += s[0] == T(1);
  REQUIRE(entries == 1);
  REQUIRE(table.template get<tip::Cap>(0, 0) == T(0));
}
