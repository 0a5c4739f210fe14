// Which particles wait for a coupling: those with a node that it changes. All others go on meanwhile.
#pragma once

#include <mpmpbd/backend/cuda/arena.cuh>
#include <mpmpbd/coupling/workspace.hpp>

namespace mpmpbd::cuda {

// A bit per stencil, by the index of its first node.
template <class T, class Shape> struct NearCells {
  unsigned* words;
  Lattice<T> lattice;

  MPMPBD_HD static constexpr std::int64_t bytes(std::int64_t nodes) {
    return (nodes + 31) / 32 * 4;
  }

  __device__ void clear() const {
    int const n = (static_cast<int>(lattice.count()) + 31) / 32;
    for (int i = static_cast<int>(threadIdx.x); i < n; i += static_cast<int>(blockDim.x))
      words[i] = 0;
  }
  __device__ bool has(Vec3<T> const& x) const {
    auto const s = Stencil<T, Shape>::at(lattice, x);
    int const i = static_cast<int>(lattice.index(s.base[0], s.base[1], s.base[2]));
    return (words[i >> 5] >> (i & 31)) & 1u;
  }
  // Marks the stencils that hold a node.
  __device__ void mark(int node) const {
    int const i = node % lattice.nodes[0], row = node / lattice.nodes[0];
    int const j = row % lattice.nodes[1], k = row / lattice.nodes[1];
    int const first = i < Shape::width ? 0 : i - Shape::width + 1;
    for (int z = k < Shape::width ? 0 : k - Shape::width + 1; z <= k; ++z)
      for (int y = j < Shape::width ? 0 : j - Shape::width + 1; y <= j; ++y)
        mark_row(static_cast<int>(lattice.index(first, y, z)), i - first + 1);
  }

 private:
  __device__ void mark_row(int first, int count) const {
    unsigned const bits = (1u << count) - 1u;
    int const shift = first & 31;
    atomicOr(words + (first >> 5), bits << shift);
    if (shift + count > 32) atomicOr(words + (first >> 5) + 1, bits >> (32 - shift));
  }
};

// Nodes as a coupling sees them: `team` works on it, the rest of the block waits until it knows which nodes.
template <class Grid, class Move, class Ctx, class Shape> struct NodesOfArena {
  using T = typename Ctx::Scalar;
  Grid arena;
  Ctx const& context;
  void* scratch;
  int* slot_of_node;
  NearCells<T, Shape> near;
  bool& announced;
  FastMemory fast;

  MPMPBD_HD T mass(int i) const { return arena.velocity.mass(i); }
  MPMPBD_HD Vec3<T> velocity(int i) const {
    auto const v = arena.velocity[i];
    return {{v[0], v[1], v[2]}};
  }
  MPMPBD_HD void set_velocity(int i, Vec3<T> const& v) const {
    arena.velocity.set(i, quad(v[0], v[1], v[2], mass(i)));
  }
  MPMPBD_HD Vec3<T> inverse_mass(int i) const {
    auto const& lattice = context.lattice;
    int const row = i / lattice.nodes[0];
    auto const x =
        lattice.position(i % lattice.nodes[0], row % lattice.nodes[1], row / lattice.nodes[1]);
    return Move::inverse_mass(velocity(i), mass(i), x, context);
  }

  // From here on the coupling reads no particle and changes no nodes but these.
  template <class Team_>
  __device__ void announce(Team_ const& team, Incidence<T> const& touched) const {
    if (announced) return;
    team.each(touched.counters[0], [&](int i) { near.mark(touched.nodes[i].index); });
    let_others_go();
  }
  __device__ void let_others_go() const {
    if (!announced) meet_others();
    announced = true;
  }
  // Where the rest of the block waits until then.
  __device__ static void meet_others() { __barrier_sync_count(2, blockDim.x); }
};

}  // namespace mpmpbd::cuda
