// Teams of the threads of a block, on an emulated device: who does what, and what the lanes of a group agree on.
#include "catch.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include <mpmpbd/backend/cuda/team.cuh>
#include <mpmpbd/coupling/node_set.hpp>

using namespace mpmpbd;

static_assert(Team<BlockTeam> && Team<PartOfBlock> && Group<Warp>);

namespace {

template <class F> void run_block(int threads, F const& f) {
  blockDim = dim3(static_cast<unsigned>(threads));
  emulated::Block(static_cast<unsigned>(threads), f).run();
}

// How often each of n numbers was taken up by a lane.
std::vector<int> visits(int threads, int n) {
  std::vector<int> count(static_cast<std::size_t>(n));
  run_block(threads, [&] {
    BlockTeam const team;
    team.groups(n, [&](auto const& group, int i) {
      int sum = 0;
      group.each(100, [&](int k) { sum += k; });
      sum = group.sum(sum);
      if (sum == 4950) ++count[static_cast<std::size_t>(i)];
    });
    team.sync();
  });
  return count;
}

}  // namespace

TEST_CASE("every number goes to one group of a team", "[cuda][team]") {
  for (unsigned seed : {1u, 2u}) {
    emulated::seed = seed;
    for (int n : {1, 2, 7}) {
      auto const all = std::vector<int>(static_cast<std::size_t>(n), 32);
      CHECK(visits(128, n) == all);
      CHECK(visits(33, n) == all);  // one whole warp
    }
  }
}

TEST_CASE("what is loaded ahead for a number is used with that number, once", "[cuda][team]") {
  for (unsigned seed : {1u, 2u}) {
    emulated::seed = seed;
    for (int n : {0, 1, 7, 8, 9, 255, 256, 257, 2100}) {
      CAPTURE(n);
      std::vector<int> used(static_cast<std::size_t>(n));
      run_block(32, [&] {
        each_loaded<8>(
            BlockTeam{}, n, [&](int i) { return i < n ? 3 * i + 1 : -1; },
            [&](int i, int loaded) { used[static_cast<std::size_t>(i)] += loaded - 3 * i; });
      });
      CHECK(used == std::vector<int>(static_cast<std::size_t>(n), 1));
    }
  }
}

// Teams of 64 threads of a block of 160, of which the last 32 belong to none.
TEST_CASE("teams of a block work side by side and meet at barriers of their own", "[cuda][team]") {
  for (unsigned seed : {1u, 2u, 3u}) {
    emulated::seed = seed;
    std::vector<int> visits(2 * 100), sums(2), seen(2);
    run_block(160, [&] {
      PartOfBlock const team(6);
      auto const number = team.number();
      if (number == 2) return;
      auto const at = static_cast<std::size_t>(number);
      for (int turn = 0; turn < number + 2; ++turn) {  // one meets more often than the other
        team.each(100, [&](int i) { ++visits[100 * at + static_cast<std::size_t>(i)]; });
        team.sync();
        team.one([&] {
          sums[at] = 0;
          for (int i = 0; i < 100; ++i) sums[at] += visits[100 * at + static_cast<std::size_t>(i)];
        });
        team.sync();
        seen[at] += sums[at] == 100 * (turn + 1);
        team.sync();
      }
      team.groups(3, [&](auto const& group, int) {
        int const lanes = group.sum(1);
        group.one([&] { team.add(sums[at], lanes); });
      });
    });
    CHECK(seen == std::vector<int>{2 * 64, 3 * 64});
    CHECK(sums == std::vector<int>{200 + 3 * 32, 300 + 3 * 32});
  }
}

TEST_CASE("the lanes of a warp agree on a least value and on a sum", "[cuda][team]") {
  float const nan = std::numeric_limits<float>::quiet_NaN();
  int agree = 0;
  run_block(64, [&] {
    Warp const warp;
    int const lane = Warp::lane(), other = (lane * 13 + 5) % 32;
    agree += warp.min(other - 3) == -3;
    agree += warp.min(2.5 + other) == 2.5;
    agree += warp.min((std::int64_t{1} << 40) + other) == std::int64_t{1} << 40;
    agree += warp.min(other < 20 ? nan : float(other)) == 20.0f;
    float const none = warp.min(nan);
    agree += !(none == none);
    agree += warp.sum(other) == 31 * 16;
  });
  CHECK(agree == 6 * 64);
}

TEST_CASE("the lanes of a warp share numbers out in order, and know what those before them have",
          "[cuda][team]") {
  for (int n : {0, 1, 31, 32, 33, 100}) {
    std::vector<int> taker(static_cast<std::size_t>(n), -1);
    int right = 0;
    run_block(32, [&] {
      Warp const warp;
      Piece const mine = warp.part(n);
      for (int i = mine.first; i < mine.end; ++i) taker[static_cast<std::size_t>(i)] = Warp::lane();
      right += warp.sum_before(mine.end - mine.first) == mine.first;
    });
    CHECK(right == 32);
    CHECK(std::is_sorted(taker.begin(), taker.end()));
    CHECK((n == 0 || taker.front() >= 0));
  }
}

TEST_CASE("what one lane of a warp writes, the others read after it", "[cuda][team]") {
  for (unsigned seed : {1u, 2u, 3u}) {
    emulated::seed = seed;
    int told[2] = {0, 0}, heard = 0;
    run_block(64, [&] {
      BlockTeam{}.groups(2, [&](auto const& group, int i) {
        group.one([&] { told[i] = 40 + i; });
        group.sync();
        heard += told[i] == 40 + i;
      });
    });
    CHECK(heard == 64);
  }
}

TEST_CASE("a set of nodes is numbered alike by one lane and by a block", "[cuda][team]") {
  int const nodes = 2000, low = 333, high = 1910;
  auto const words = static_cast<std::size_t>(NodeSet::words_of(nodes));
  std::vector<unsigned> bits(words, 0xffffffffu), bits_of_one(bits);
  std::vector<int> before(words, -7), before_of_one(before);
  NodeSet::Range range{}, range_of_one{};
  NodeSet const set{bits.data(), before.data(), &range},
      of_one{bits_of_one.data(), before_of_one.data(), &range_of_one};
  auto const fill = [&](auto const& team, NodeSet const& all) {
    team.one([&] { all.cover(low, high); });
    team.sync();
    all.clear(team);
    team.sync();
    team.each(700, [&](int i) { all.insert(team, low + i * i * 7 % (high - low + 1)); });
    team.sync();
    all.number(team);
    team.sync();
  };
  fill(Solo{}, of_one);
  for (int threads : {32, 96, 512}) {
    run_block(threads, [&] { fill(BlockTeam{}, set); });
    CHECK(bits == bits_of_one);
    CHECK(before == before_of_one);
    CHECK(set.members() == of_one.members());
  }
}
