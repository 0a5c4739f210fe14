// The threads of one CUDA block as a team.
#pragma once

#include <mpmpbd/coupling/team.hpp>

namespace mpmpbd {

// Every thread of the block calls the coupling with the same arguments; its counters and work arrays
// lie in shared or global memory.
struct BlockTeam {
  template <class F> __device__ void each(int n, F const& f) const {
    for (int i = static_cast<int>(threadIdx.x); i < n; i += static_cast<int>(blockDim.x)) f(i);
  }
  template <class F> __device__ void one(F const& f) const {
    if (threadIdx.x == 0) f();
  }
  __device__ void sync() const { __syncthreads(); }
  __device__ int add(int& counter, int amount) const { return atomicAdd(&counter, amount); }
  __device__ bool claim(int& mark, int from, int to) const {
    return atomicCAS(&mark, from, to) == from;
  }
};

}  // namespace mpmpbd
