// Threads of one CUDA block as a team: all of them, or the first few while the others do something else.
#pragma once

#include <cuda_runtime.h>

#include <mpmpbd/coupling/team.hpp>

namespace mpmpbd {

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
};
}  // namespace detail

struct BlockTeam : detail::ThreadsOfBlock {
  template <class F> __device__ void each(int n, F const& f) const {
    for (int i = static_cast<int>(threadIdx.x); i < n; i += static_cast<int>(blockDim.x)) f(i);
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
  __device__ void sync() const { __barrier_sync_count(1, count); }
};

}  // namespace mpmpbd
