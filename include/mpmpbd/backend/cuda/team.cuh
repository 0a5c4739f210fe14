// Threads of one CUDA block as a team: all of them, or several teams side by side. Their groups are warps.
#pragma once

#include <cuda_runtime.h>

#include <mpmpbd/coupling/team.hpp>

namespace mpmpbd {

// What teams and groups share out is not unrolled, since a thread has one item of most stages, rarely many.

// The threads of a warp as a group.
struct Warp {
  static constexpr int size = 32;
  static constexpr unsigned all = 0xffffffffu;

  __device__ static int lane() { return static_cast<int>(threadIdx.x) % size; }
  template <class F> __device__ void each(int n, F const& f) const {
    MPMPBD_NO_UNROLL
    for (int i = lane(); i < n; i += size) f(i);
  }
  template <class F> __device__ void one(F const& f) const {
    if (lane() == 0) f();
  }
  __device__ void sync() const { __syncwarp(all); }
  // Both of a pair choose the same, so that no two lanes can go apart by the result.
  template <class T> __device__ T min(T a) const {
    for (int other = size / 2; other > 0; other /= 2) {
      T const b = __shfl_xor_sync(all, a, other);
      if (b < a || !(a == a)) a = b;
    }
    return a;
  }
  __device__ int sum(int a) const {
    for (int other = size / 2; other > 0; other /= 2) a += __shfl_xor_sync(all, a, other);
    return a;
  }
  __device__ int sum_before(int a) const {
    int sum = a;
    for (int nearer = 1; nearer < size; nearer *= 2) {
      int const before = __shfl_up_sync(all, sum, static_cast<unsigned>(nearer));
      if (lane() >= nearer) sum += before;
    }
    return sum - a;
  }
  __device__ Piece part(int n) const {
    int const length = (n + size - 1) / size, first = lane() * length;
    return {first < n ? first : n, first + length < n ? first + length : n};
  }
};

namespace detail {
// What threads of a block do as a team that knows its size(), and of the present thread its rank() in it. Counters
// are integers in shared or global memory.
template <class Team_> struct ThreadsOfBlock {
  template <class F> __device__ void each(int n, F const& f) const {
    MPMPBD_NO_UNROLL
    for (int i = self().rank(); i < n; i += self().size()) f(i);
  }
  // The last one: it has least to do of what threads share out, so that both go on side by side.
  template <class F> __device__ void one(F const& f) const {
    if (self().rank() == self().size() - 1) f();
  }
  // Those that are no whole warp have no share.
  template <class F> __device__ void groups(int n, F const& f) const {
    int const warps = self().size() / Warp::size, mine = self().rank() / Warp::size;
    MPMPBD_NO_UNROLL
    for (int i = mine; mine < warps && i < n; i += warps) f(Warp{}, i);
  }
  __device__ int add(int& counter, int amount) const { return atomicAdd(&counter, amount); }
  __device__ void raise(unsigned& word, unsigned bits) const { atomicOr(&word, bits); }

 private:
  __device__ Team_ const& self() const { return static_cast<Team_ const&>(*this); }
};
}  // namespace detail

// All threads of a block.
struct BlockTeam : detail::ThreadsOfBlock<BlockTeam> {
  __device__ static int rank() { return static_cast<int>(threadIdx.x); }
  __device__ static int size() { return static_cast<int>(blockDim.x); }
  __device__ void sync() const { __syncthreads(); }
};

// A barrier for all threads of a block, some of which have met at barriers of their own teams (PartOfBlock). One would do, and
// two cost no time that can be measured. The second is for racecheck: where warps come to a barrier after unequal numbers of
// others, it takes what they do before and after one for unordered, before and after two for ordered.
__device__ inline void sync_block() {
  __syncthreads();
  __syncthreads();
}

// Some warps of a block that follow one another. Several such teams are at work side by side: each meets at a barrier of
// its own. All that a thread keeps of its team is one number.
class PartOfBlock : public detail::ThreadsOfBlock<PartOfBlock> {
 public:
  static constexpr int most = 15;  // a block has 16 barriers, one of them for all of its threads

  // The present thread's of those with 2^log2 threads, at least 32.
  __device__ explicit PartOfBlock(int log2) : log2_(log2) {}

  __device__ int number() const { return static_cast<int>(threadIdx.x) >> log2_; }
  __device__ int rank() const { return static_cast<int>(threadIdx.x) & (size() - 1); }
  __device__ int size() const { return 1 << log2_; }
  __device__ void sync() const {
    __barrier_sync_count(static_cast<unsigned>(number() + 1), static_cast<unsigned>(size()));
  }

 private:
  int log2_;
};

// A run of numbers that all threads of the block share out.
struct Run {
  int first, end;
  template <class F> __device__ __forceinline__ void each(F const& f) const {
    for (int i = first + static_cast<int>(threadIdx.x); i < end; i += static_cast<int>(blockDim.x))
      f(i);
  }
};

}  // namespace mpmpbd
