// Teams of the threads of a block, on an emulated device: who does what, and what the lanes of a group agree on.
#include "catch.hpp"

#include <limits>
#include <vector>

#include <mpmpbd/backend/cuda/team.cuh>

using namespace mpmpbd;

static_assert(Team<BlockTeam> && Team<FirstThreads<64>> && Group<Warp>);

namespace {

template <class F> void run_block(int threads, F const& f) {
  blockDim = dim3(static_cast<unsigned>(threads));
  emulated::Block(static_cast<unsigned>(threads), f).run();
}

// How often each of n numbers was taken up by a lane.
template <class Team_> std::vector<int> visits(Team_ const& team, int members, int threads, int n) {
  std::vector<int> count(static_cast<std::size_t>(n));
  run_block(threads, [&] {
    if (static_cast<int>(threadIdx.x) >= members) return;
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
      CHECK(visits(BlockTeam{}, 128, 128, n) == all);
      CHECK(visits(BlockTeam{}, 33, 33, n) == all);  // one whole warp
      CHECK(visits(FirstThreads<64>{}, 64, 128, n) == all);
    }
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

TEST_CASE("what one lane of a warp writes, the others read after it", "[cuda][team]") {
  for (unsigned seed : {1u, 2u, 3u}) {
    emulated::seed = seed;
    int told[2] = {0, 0}, heard = 0;
    run_block(64, [&] {
      FirstThreads<64>{}.groups(2, [&](auto const& group, int i) {
        group.one([&] { told[i] = 40 + i; });
        group.sync();
        heard += told[i] == 40 + i;
      });
    });
    CHECK(heard == 64);
  }
}
