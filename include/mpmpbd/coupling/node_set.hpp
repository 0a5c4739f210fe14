// A set of nodes of a lattice whose members are numbered in the order of the nodes (a bit vector with rank): a bit for each
// node, and for every word of them how many members come before.
//
// A number per node would be looked up at once, but lies far away on a device; this fits into fast memory, and needs nothing
// of the exchange before.
#pragma once

#include <mpmpbd/core/math.hpp>
#include <mpmpbd/coupling/team.hpp>

namespace mpmpbd {

struct NodeSet {
  static constexpr int per_word = 32;
  // A larger lattice has its words elsewhere than in fast memory, whatever room there is.
  static constexpr int most_fast_words = 1024;
  struct Range {
    int first, words, members;
  };

  unsigned* bits;  // words_of(nodes of the lattice), of which range->words are in use
  int* before;     // as many: members in the words before
  Range* range;    // the first word in use is that of node range->first * per_word

  MPMPBD_HD static int words_of(int lattice_nodes) {
    return (lattice_nodes + per_word - 1) / per_word;
  }
  // A Cutter (workspace.hpp) says where everything lies.
  template <class Cutter> MPMPBD_HD void cut(Cutter& cutter, int lattice_nodes) {
    int const n = words_of(lattice_nodes);
    auto const words = [&]<class Word>(Word*& to) {
      to = n > most_fast_words ? cutter.template cut<Word>(n) : cutter.template cut_fast<Word>(n);
    };
    range = cutter.template cut_fast<Range>(1);
    words(bits);
    words(before);
  }

  // One lane: nodes lie between `low` and `high`; none with high < low. The team meets between this, clear, insert,
  // number and slot.
  MPMPBD_HD void cover(int low, int high) const {
    bool const any = low <= high;
    int const first = any ? low / per_word : 0;
    *range = {first, any ? high / per_word - first + 1 : 0, 0};
  }
  template <class Team_> MPMPBD_HD void clear(Team_ const& team) const {
    team.each(range->words, [&](int w) { bits[w] = 0; });
  }
  // Of nodes that are covered.
  template <class Team_> MPMPBD_HD void insert(Team_ const& team, int node) const {
    team.raise(bits[word(node)], bit(node));
  }
  MPMPBD_HD bool contains(int node) const { return (bits[word(node)] & bit(node)) != 0; }

  // Numbers the members: one group does.
  template <class Team_> MPMPBD_HD void number(Team_ const& team) const {
    team.groups(1, [&](auto const& group, int) {
      Piece const mine = group.part(range->words);
      int members = 0;
      for (int w = mine.first; w < mine.end; ++w) members += count_ones(bits[w]);
      int next = group.sum_before(members);
      for (int w = mine.first; w < mine.end; ++w) {
        before[w] = next;
        next += count_ones(bits[w]);
      }
      int const all = group.sum(members);
      group.one([&] { range->members = all; });
    });
  }
  MPMPBD_HD int members() const { return range->members; }
  // Of a member, 0 ... members - 1.
  MPMPBD_HD int slot(int node) const {
    int const w = word(node);
    return before[w] + count_ones(bits[w] & (bit(node) - 1));
  }
  // f(slot, node) for every member, spread over the lanes.
  template <class Team_, class F> MPMPBD_HD void each_member(Team_ const& team, F const& f) const {
    team.each(range->words, [&](int w) {
      int slot = before[w];
      for (unsigned rest = bits[w]; rest != 0; rest &= rest - 1)
        f(slot++, (range->first + w) * per_word + count_ones((rest & (~rest + 1)) - 1));
    });
  }

 private:
  MPMPBD_HD int word(int node) const { return node / per_word - range->first; }
  MPMPBD_HD static unsigned bit(int node) { return 1u << (node % per_word); }
};

}  // namespace mpmpbd
