// The grid before the forces of a substep beside the grid itself, for transfers that look at both (FLIP).
#pragma once

#include <mpmpbd/backend/cuda/arena.cuh>

namespace mpmpbd::cuda {

template <class T> struct BothRows {
  FixedRow<T> now, before;
  __device__ __forceinline__ BothRows operator+(int n) const { return {now + n, before + n}; }
  __device__ __forceinline__ void add_mass(int n, T weight, Quad<T> const& all) const {
    now.add_mass(n, weight, all);
  }
  __device__ __forceinline__ void add_counts(int n, Counts<T> const& c) const {
    now.add_counts(n, c);
  }
  __device__ __forceinline__ void add_previous_counts(int n, Counts<T> const& c) const {
    before.add_counts(n, c);  // its mass is the same
  }
};
template <class T> struct SumsOfBoth : SumsOfArena<T> {
  Arena<T> before;
  __device__ __forceinline__ auto window(int const (&at)[3]) const {
    auto const now = SumsOfArena<T>::window(at);
    auto const other = SumsOfArena<T>{before, this->lattice, this->unit, this->start}.window(at);
    return Window{BothRows<T>{now.first, other.first}, now.next_row, now.next_plane};
  }
};
template <class T> struct VelocitiesOfBoth : VelocitiesOfArena<T> {
  Arena<T> before;
  __device__ __forceinline__ auto previous_window(int const (&at)[3]) const {
    return VelocitiesOfArena<T>{before, this->lattice}.window(at);
  }
};

}  // namespace mpmpbd::cuda
