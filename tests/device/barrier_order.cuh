// How the threads of a resident block meet, and nothing else: a grid in fast memory is filled and read by all of them, for one
// environment after the other; then teams work in the same memory, unequally long, and meet at barriers of their own.
// It has no race. Where all meet at one barrier instead of at two in succession, racecheck reports some.
#pragma once

#include <vector>

#include <mpmpbd/backend/cuda/team.cuh>

namespace test {

struct BarrierOrder {
  int threads, log2_of_team, nodes, substeps, turns;  // teams of 2^log2_of_team threads
  bool twice = true;                                  // all meet at two barriers

  MPMPBD_HD static int environments(int block) { return 1 + block % 2; }
  MPMPBD_HD static unsigned filled(int node, int substep) {
    return static_cast<unsigned>(node * 3 + substep);
  }
  MPMPBD_HD int read(int thread, int k, int substep) const {
    return (thread * 7 + k * 131 + substep) % nodes;
  }
  MPMPBD_HD int turns_of(int team) const { return turns * (team + 1); }
  MPMPBD_HD int own(int team) const { return team * (nodes / (threads >> log2_of_team)); }

  __device__ void meet() const {
    if (twice)
      mpmpbd::sync_block();
    else
      __syncthreads();
  }
  // What a thread has seen in the end; `grid`: nodes numbers, which the block shares.
  __device__ unsigned run(unsigned* grid, int block) const {
    auto const thread = static_cast<int>(threadIdx.x);
    mpmpbd::PartOfBlock const team(log2_of_team);
    unsigned seen = 0;
    for (int s = 0; s < substeps; ++s) {
      for (int e = 0; e < environments(block); ++e) {
        for (int i = thread; i < nodes; i += threads) grid[i] = filled(i, s);
        meet();
        for (int k = 0; k < 27; ++k) seen += grid[read(thread, k, s)];
        meet();
      }
      unsigned* const mine = grid + own(team.number());
      if (team.number() < environments(block))
        for (int turn = 0; turn < turns_of(team.number()); ++turn) {
          mine[team.rank()] = seen;
          team.sync();
          seen += mine[(team.rank() + 5) & (team.size() - 1)];
          team.sync();
        }
      meet();
    }
    return seen;
  }
  // The same by one thread after the other.
  std::vector<unsigned> expected(int block) const {
    std::vector<unsigned> seen(static_cast<std::size_t>(threads));
    auto const at = [&](int thread) -> unsigned& { return seen[static_cast<std::size_t>(thread)]; };
    int const size = 1 << log2_of_team;
    for (int s = 0; s < substeps; ++s) {
      for (int t = 0; t < threads; ++t)
        for (int k = 0; k < 27; ++k)
          at(t) += static_cast<unsigned>(environments(block)) * filled(read(t, k, s), s);
      for (int team = 0; team < environments(block); ++team)
        for (int turn = 0; turn < turns_of(team); ++turn) {
          auto const before = seen;
          for (int r = 0; r < size; ++r)
            at(team * size + r) +=
                before[static_cast<std::size_t>(team * size + ((r + 5) & (size - 1)))];
        }
    }
    return seen;
  }
};

}  // namespace test
