// Solutions of the thread's equations in one exchange: without tissue, of the impulses on offer, and of every trial.
#pragma once

#include <mpmpbd/coupling/exchange_view.hpp>

namespace mpmpbd::detail {

// The beads before the first that meets tissue are the chain's head: no trial changes their rows. They are eliminated
// once, and their velocities are found in the end. One group of lanes solves; the others of the team wait.
template <class Team_, class T, class Form> struct ThreadSolve {
  static constexpr bool bends = Form::bends;

  Team_ const& team;
  ExchangeView<T, Form> const& x;

  MPMPBD_HD int head() const { return x.thread_work.head->beads; }
  MPMPBD_HD void find_head() const {
    team.groups(1, [&](auto const& group, int) {
      std::int64_t first = max(x.thread.beads - 1, 0);
      group.each(x.count(), [&](int q) {
        int const segment = x.points[q].segment;
        if (x.on[q] && segment >= 0 && segment < first) first = segment;
      });
      first = group.min(first);
      group.one([&] { x.thread_work.head->beads = static_cast<int>(first); });
    });
    team.sync();
  }

  // The whole chain without tissue: its motion, and beside it the response to what `trial` has as right-hand side.
  MPMPBD_HD void solve_alone(bool and_trial) const {
    by_group([&](auto const& group) {
      ChainSides<T> const both{and_trial ? 2 : 1, x.thread_work.alone, x.scratch->bodies};
      auto const c = system(x.thread_work.base);
      auto const& work = x.thread_work.chain;
      if (!eliminate_head(group, c, both, work, *x.thread_work.head) ||
          !eliminate_rest(group, c, both, work, *x.thread_work.head))
        return false;
      substitute_rest(group, c, both, work, 0);
      return true;
    });
  }
  // The beads after the head, with the contact of the present holds.
  MPMPBD_HD void solve_contact() const {
    by_group([&](auto const& group) {
      auto const c = system(x.thread_work.rows);
      auto const& work = x.thread_work.chain;
      if (!eliminate_rest(group, c, trial(), work, *x.thread_work.head)) return false;
      substitute_rest(group, c, trial(), work, head());
      return true;
    });
  }
  MPMPBD_HD void solve_head() const {
    by_group([&](auto const& group) {
      substitute(group, system(x.thread_work.base), trial(), x.thread_work.chain, 0, head());
      return true;
    });
  }

 private:
  MPMPBD_HD ChainSystem<T, bends> system(BeadRows<T, bends> const* rows) const {
    return {x.thread.beads, rows, x.thread.known, &x.scratch->end};
  }
  MPMPBD_HD ChainSides<T> trial() const { return {1, x.thread_work.trial, &x.scratch->body()}; }
  // Once a solution has failed there are no others.
  template <class F> MPMPBD_HD void by_group(F const& solve) const {
    team.groups(1, [&](auto const& group, int) {
      if (x.scratch->failed != 0) return;
      bool const solved = solve(group);
      group.sync();
      group.one([&] {
        if (!solved) x.scratch->failed = 1;
      });
    });
    team.sync();
  }
};

}  // namespace mpmpbd::detail
