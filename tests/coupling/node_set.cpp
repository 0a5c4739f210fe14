// The set of touched nodes: its members are numbered in the order of the lattice, and it remembers nothing.
#include "catch.hpp"

#include <random>
#include <set>
#include <vector>

#include <mpmpbd/coupling/node_set.hpp>

using mpmpbd::NodeSet;
using mpmpbd::Solo;

namespace {

struct Nodes {
  std::vector<unsigned> bits;
  std::vector<int> before;
  NodeSet::Range range{9, 9, 9};
  explicit Nodes(int lattice_nodes)
      : bits(static_cast<std::size_t>(NodeSet::words_of(lattice_nodes)), 0xa5a5a5a5u),
        before(bits.size(), 12345) {}
  NodeSet set() { return {bits.data(), before.data(), &range}; }
};

void fill(NodeSet const& set, std::set<int> const& nodes, int low, int high) {
  set.cover(low, high);
  set.clear(Solo{});
  for (int node : nodes) {
    set.insert(Solo{}, node);
    set.insert(Solo{}, node);
  }
  set.number(Solo{});
}
void check(NodeSet const& set, std::set<int> const& nodes, int low, int high) {
  REQUIRE(set.members() == static_cast<int>(nodes.size()));
  int rank = 0;
  for (int node : nodes) REQUIRE(set.slot(node) == rank++);
  for (int node = low; node <= high; ++node) REQUIRE(set.contains(node) == nodes.contains(node));
  auto next = nodes.begin();
  rank = 0;
  set.each_member(Solo{}, [&](int slot, int node) {
    REQUIRE(slot == rank++);
    REQUIRE(node == *next++);
  });
  REQUIRE(next == nodes.end());
}

}  // namespace

TEST_CASE("touched nodes are numbered in the order of the lattice", "[coupling][node_set]") {
  std::mt19937 random(3);
  for (int lattice_nodes : {1, 31, 32, 33, 1000, 6656}) {
    Nodes memory(lattice_nodes);
    for (int turn = 0; turn < 20; ++turn) {  // over what the turn before has left
      int const low = static_cast<int>(random() % static_cast<unsigned>(lattice_nodes));
      int const size = lattice_nodes - low,
                high = low + static_cast<int>(random() % static_cast<unsigned>(size));
      std::set<int> nodes{low, high};
      for (int i = 0; i < turn * 20; ++i)
        nodes.insert(low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1)));
      fill(memory.set(), nodes, low, high);
      check(memory.set(), nodes, low, high);
    }
  }
}

TEST_CASE("where no point touches tissue there are no nodes, and no words to look at",
          "[coupling][node_set]") {
  Nodes memory(500);
  fill(memory.set(), {}, 1 << 30, -1);
  CHECK(memory.range.words == 0);
  CHECK(memory.set().members() == 0);
  memory.set().each_member(Solo{}, [&](int, int) { FAIL("a member of an empty set"); });
}
