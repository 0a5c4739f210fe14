// A box of a grid in the shared memory of a block. Particles that follow one another lie close together: what those of a
// block bring is added up here, and once per node to the grid in the memory of the device.
//
// Limits: float, since shared memory adds 64-bit integers in a loop. A block whose particles lie too far apart adds to the
// grid itself. Integers may be added in any order: the bits are the same.
#pragma once

#include <mpmpbd/backend/cuda/arena.cuh>

namespace mpmpbd::cuda {

// Where a particle's shares go: straight to the grid.
struct ToGrid {
  bool has_particle = true;  // of this thread

  template <class P, class Sums, class Add>
  __device__ __forceinline__ void operator()(P const&, Sums const& grid, Add const& add) const {
    if (has_particle) add(grid);
  }
};

// Sums of a box, by the numbers of the grid's nodes.
template <class T> struct SumsOfBox : SumsOfArena<T> {
  int low[3];
  __device__ __forceinline__ auto window(int const (&at)[3]) const {
    int const inside[3] = {at[0] - low[0], at[1] - low[1], at[2] - low[2]};
    return SumsOfArena<T>::window(inside);
  }
};

// By way of a box around the stencils of the block's particles. All threads of the block take part.
template <class Shape> class ToTile {
  struct Box {
    int low[3], high[3];  // of first nodes
  };

 public:
  static constexpr int most_nodes = 2560;
  static constexpr std::size_t bytes = sizeof(Box) + 4 * most_nodes * sizeof(int);

  bool has_particle;

  // `memory`: `bytes` of shared memory.
  __device__ ToTile(char* memory, bool particle)
      : has_particle(particle),
        sums_(reinterpret_cast<int*>(memory)),
        box_(*reinterpret_cast<Box*>(sums_ + 4 * most_nodes)) {}

  template <class P, class Add>
  __device__ __forceinline__ void operator()(P const& p, SumsOfArena<float> const& grid,
                                             Add const& add) const {
    surround(p, grid.lattice);
    SumsOfBox<float> const box = sums_in_box(grid);
    auto const& n = box.lattice.nodes;
    bool const fits = n[0] <= most_nodes && n[1] <= most_nodes && n[2] <= most_nodes &&
                      box.lattice.count() <= most_nodes;
    if (!fits) {
      if (has_particle) add(grid);
      return;
    }
    Run const nodes{0, static_cast<int>(box.lattice.count())};
    for (int c = 0; c < 4; ++c) nodes.each([&](int i) { sums_[c * most_nodes + i] = 0; });
    __syncthreads();
    if (has_particle) add(box);
    __syncthreads();
    hand_on(nodes, box, grid);
  }

 private:
  // The first nodes of all stencils.
  template <class P>
  __device__ __forceinline__ void surround(P const& p, Lattice<float> const& lattice) const {
    constexpr int beyond = 1 << 30;
    if (threadIdx.x == 0) box_ = {{beyond, beyond, beyond}, {-beyond, -beyond, -beyond}};
    int first[3] = {beyond, beyond, beyond};
    if (has_particle) {
      auto const s = Stencil<float, Shape>::at(lattice, p[particle::Position{}]);
      for (int a = 0; a < 3; ++a) first[a] = s.base[a];
    }
    __syncthreads();
    for (int a = 0; a < 3; ++a) {
      int const low = Warp{}.min(first[a]), high = -Warp{}.min(has_particle ? -first[a] : beyond);
      Warp{}.one([&] {
        atomicMin(&box_.low[a], low);
        atomicMax(&box_.high[a], high);
      });
    }
    __syncthreads();
  }
  __device__ __forceinline__ SumsOfBox<float> sums_in_box(SumsOfArena<float> const& grid) const {
    SumsOfBox<float> box{grid, {}};
    box.arena.sums = sums_;
    box.arena.count = most_nodes;
    for (int a = 0; a < 3; ++a) {
      box.low[a] = box_.low[a];
      box.lattice.nodes[a] = box_.high[a] - box_.low[a] + Shape::width;
    }
    return box;
  }
  __device__ __forceinline__ void hand_on(Run const& nodes, SumsOfBox<float> const& box,
                                          SumsOfArena<float> const& grid) const {
    int const nx = box.lattice.nodes[0], ny = box.lattice.nodes[1];
    nodes.each([&](int i) {
      int const yz = i / nx;
      auto* const to =
          grid.arena.sums +
          grid.lattice.index(box.low[0] + i % nx, box.low[1] + yz % ny, box.low[2] + yz / ny);
      for (int c = 0; c < 4; ++c) {
        int const sum = sums_[c * most_nodes + i];
        if (sum != 0) add_counts<float>(to + c * grid.arena.count, sum);
      }
    });
  }

  int* sums_;
  Box& box_;
};

}  // namespace mpmpbd::cuda
