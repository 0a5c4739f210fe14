// Threads of one CUDA block as a team: all of them, or the first few while the others do something else. Their
// groups are warps.
#pragma once

#include <cuda_runtime.h>

#include <mpmpbd/coupling/team.hpp>

namespace mpmpbd {

// The threads of a warp as a group.
struct Warp {
  static constexpr int size = 32;
  static constexpr unsigned all = 0xffffffffu;

  __device__ static int lane() { return static_cast<int>(threadIdx.x) % size; }
  template <class F> __device__ void each(int n, F const& f) const {
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
};

namespace detail {
// Integers in shared or global memory; every thread of a team calls with the same arguments.
struct ThreadsOfBlock {
  __device__ int add(int& counter, int amount) const { return atomicAdd(&counter, amount); }
  __device__ bool claim(int& mark, int from, int to) const {
    return atomicCAS(&mark, from, to) == from;
  }
  template <class F> __device__ void one(F const& f) const {
    if (threadIdx.x == 0) f();
  }
  // Of so many threads; those that are no whole warp have no share.
  template <class F> __device__ static void groups_of(int threads, int n, F const& f) {
    int const warps = threads / Warp::size, mine = static_cast<int>(threadIdx.x) / Warp::size;
    for (int i = mine; mine < warps && i < n; i += warps) f(Warp{}, i);
  }
};
}  // namespace detail

struct BlockTeam : detail::ThreadsOfBlock {
  template <class F> __device__ void each(int n, F const& f) const {
    for (int i = static_cast<int>(threadIdx.x); i < n; i += static_cast<int>(blockDim.x)) f(i);
  }
  // A block of at least one warp.
  template <class F> __device__ void groups(int n, F const& f) const {
    groups_of(static_cast<int>(blockDim.x), n, f);
  }
  __device__ void sync() const { __syncthreads(); }
};

// A run of numbers that all threads of the block share out.
struct Run {
  int first, end;
  template <class F> __device__ __forceinline__ void each(F const& f) const {
    for (int i = first + static_cast<int>(threadIdx.x); i < end; i += static_cast<int>(blockDim.x))
      f(i);
  }
};

// The first `count` threads, a multiple of 32; they meet at a barrier of their own.
template <int count> struct FirstThreads : detail::ThreadsOfBlock {
  template <class F> __device__ void each(int n, F const& f) const {
    for (int i = static_cast<int>(threadIdx.x); i < n; i += count) f(i);
  }
  template <class F> __device__ void groups(int n, F const& f) const { groups_of(count, n, f); }
  __device__ void sync() const { __barrier_sync_count(1, count); }
};

}  // namespace mpmpbd
