// Who carries out the coupling of one environment: one lane on a CPU, the threads of one block on a GPU.
//
// The coupling is written once, against this concept. Floating-point sums never run over lanes: each
// sum belongs to one lane and has a fixed order, so the number of lanes does not change a bit.
#pragma once

#include <concepts>

#include <mpmpbd/core/config.hpp>

namespace mpmpbd {

namespace detail {
struct TeamProbe {
  MPMPBD_HD void operator()(int) const {}
  MPMPBD_HD void operator()() const {}
};
}  // namespace detail

// each(n, f): f(0) ... f(n-1), spread over the lanes, in no order. one(f): f() on one lane.
// sync(): what any lane wrote before is seen by all lanes after. Neither each nor one waits by itself.
// add(counter, n): adds n, returns the value before. claim(mark, from, to): sets mark to `to` for the
// one caller that found `from` there, and tells that caller.
template <class Team_>
concept Team = requires(Team_ const& team, detail::TeamProbe f, int& counter) {
  team.each(1, f);
  team.one(f);
  team.sync();
  { team.add(counter, 1) } -> std::same_as<int>;
  { team.claim(counter, 0, 1) } -> std::same_as<bool>;
};

// One lane.
struct Solo {
  template <class F> MPMPBD_HD void each(int n, F const& f) const {
    for (int i = 0; i < n; ++i) f(i);
  }
  template <class F> MPMPBD_HD void one(F const& f) const { f(); }
  MPMPBD_HD void sync() const {}
  MPMPBD_HD int add(int& counter, int amount) const {
    int const before = counter;
    counter += amount;
    return before;
  }
  MPMPBD_HD bool claim(int& mark, int from, int to) const {
    bool const mine = mark == from;
    if (mine) mark = to;
    return mine;
  }
};

static_assert(Team<Solo>);

}  // namespace mpmpbd
