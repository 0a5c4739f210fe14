// Who carries out the coupling of one environment: one lane on a CPU, the threads of one block on a GPU.
//
// The coupling is written once, against this concept. Floating-point sums never run over lanes: each
// sum belongs to one lane and has a fixed order, so the number of lanes does not change a bit.
#pragma once

#include <concepts>
#include <cstdint>

#include <mpmpbd/core/config.hpp>
#include <mpmpbd/core/math.hpp>

namespace mpmpbd {

namespace detail {
struct TeamProbe {
  MPMPBD_HD void operator()(int) const {}
  MPMPBD_HD void operator()() const {}
  template <class Group_> MPMPBD_HD void operator()(Group_ const&, int) const {}
};
}  // namespace detail

// Numbers first ... end - 1.
struct Piece {
  int first, end;
};

// Lanes that look into one matter together: all of them run the same text, each with variables of its own.
//
// each, one and sync are as of a team. min(a), sum(n): over what the lanes bring, known to all of them. Neither
// depends on how many lanes there are; a NaN loses against any number. part(n): the numbers 0 ... n-1 in as many pieces as
// there are lanes, in their order, and sum_before(n): over the lanes before this one.
template <class Group_> concept Group = requires(Group_ const& group, detail::TeamProbe f) {
  group.each(1, f);
  group.one(f);
  group.sync();
  { group.min(1.0f) } -> std::same_as<float>;
  { group.min(std::int64_t{1}) } -> std::same_as<std::int64_t>;
  { group.sum(1) } -> std::same_as<int>;
  { group.sum_before(1) } -> std::same_as<int>;
  { group.part(1) } -> std::same_as<Piece>;
};

// each(n, f): f(0) ... f(n-1), spread over the lanes, in no order. one(f): f() on one lane, always the same.
// groups(n, f): f(group, 0) ... f(group, n-1), each by all lanes of one group, in no order.
// sync(): what any lane wrote before is seen by all lanes after. Nothing else waits for the team.
// add(counter, n): adds n, returns the value before. raise(word, bits): sets these bits, and no lane's are lost.
template <class Team_>
concept Team = requires(Team_ const& team, detail::TeamProbe f, int& counter, unsigned& word) {
  team.each(1, f);
  team.one(f);
  team.groups(1, f);
  team.sync();
  { team.add(counter, 1) } -> std::same_as<int>;
  team.raise(word, 1u);
};

// One lane: a team, and its only group.
struct Solo {
  template <class F> MPMPBD_HD void each(int n, F const& f) const {
    for (int i = 0; i < n; ++i) f(i);
  }
  template <class F> MPMPBD_HD void one(F const& f) const { f(); }
  template <class F> MPMPBD_HD void groups(int n, F const& f) const {
    for (int i = 0; i < n; ++i) f(*this, i);
  }
  MPMPBD_HD void sync() const {}
  template <class T> MPMPBD_HD T min(T a) const { return a; }
  MPMPBD_HD int sum(int a) const { return a; }
  MPMPBD_HD int sum_before(int) const { return 0; }
  MPMPBD_HD Piece part(int n) const { return {0, n}; }
  MPMPBD_HD int add(int& counter, int amount) const {
    int const before = counter;
    counter += amount;
    return before;
  }
  MPMPBD_HD void raise(unsigned& word, unsigned bits) const { word |= bits; }
};

static_assert(Team<Solo> && Group<Solo>);

// use(i, load(i)) of 0 ... n-1, spread over the lanes, in no order. A lane loads for several before it uses one: what comes from
// the memory of a device is on its way together.
template <int at_once, class Team_, class Load, class Use>
MPMPBD_HD void each_loaded(Team_ const& team, int n, Load const& load, Use const& use) {
  int const share = (n + at_once - 1) / at_once;
  team.each(share, [&](int first) {
    decltype(load(0)) loaded[at_once];
    for (int k = 0; k < at_once; ++k) loaded[k] = load(min(first + k * share, n - 1));
    for (int k = 0; k < at_once; ++k) {
      int const i = first + k * share;
      if (i >= n) break;
      use(i, loaded[k]);
    }
  });
}

}  // namespace mpmpbd
