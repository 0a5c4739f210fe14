// Resident execution: one thread block holds the grid of one environment in shared memory and runs all
// substeps of a step in one launch: scatter, (n - 1) x fused gather and scatter, gather.
//
// Stages are the scene's own; only how a grid adds and reads is said here. Sums are 32-bit fixed point
// (shared float atomics are compare-and-swap loops on sm_90, and their order is not repeatable).
#pragma once

#include <mpmpbd/core/table.hpp>
#include <mpmpbd/scene/scene.hpp>

namespace mpmpbd::resident {

// Units of the sums: mass in heaviest particles, momentum in that mass times a cell per substep.
struct FixedPoint {
  static constexpr float scale = 4194304.0f;  // 2^22

  float mass;              // counts per kg
  float momentum;          // counts per kg m/s
  float inverse_mass;      // kg per count
  float inverse_momentum;  // kg m/s per count

  static MPMPBD_HD FixedPoint make(float heaviest, float dx, float dt) {
    float const p = heaviest * dx / dt;
    return {scale / heaviest, scale / p, heaviest / scale, p / scale};
  }
};

// Shared memory of one environment: 16 B of sums and 16 B of velocity per node.
struct Arena {
  float4* velocity;
  int* sums;  // four planes: momentum x, y, z, mass
  int count;  // nodes

  static constexpr int bytes_per_node = sizeof(float4) + 4 * sizeof(int);

  __device__ static Arena at(char* memory, int count) {
    return {reinterpret_cast<float4*>(memory),
            reinterpret_cast<int*>(memory + sizeof(float4) * count), count};
  }
  __device__ void clear() const {
    for (int i = threadIdx.x; i < 4 * count; i += blockDim.x) sums[i] = 0;
  }
};

struct FixedRow {
  int* first;
  int plane;
  FixedPoint unit;
  __device__ __forceinline__ void add(int n, Quad<float> const& q) const {
    atomicAdd(first + n, __float2int_rn(q[0] * unit.momentum));
    atomicAdd(first + plane + n, __float2int_rn(q[1] * unit.momentum));
    atomicAdd(first + 2 * plane + n, __float2int_rn(q[2] * unit.momentum));
    atomicAdd(first + 3 * plane + n, __float2int_rn(q[3] * unit.mass));
  }
};
struct SharedWriter {
  Arena arena;
  Lattice<float> lattice;
  FixedPoint unit;
  __device__ __forceinline__ FixedRow row(int i, int j, int k) const {
    return {arena.sums + static_cast<int>(lattice.index(i, j, k)), arena.count, unit};
  }
};

struct VelocityRow {
  float4 const* first;
  __device__ __forceinline__ Quad<float> operator[](int n) const {
    float4 const v = first[n];
    return quad<float>(v.x, v.y, v.z, v.w);
  }
};
struct SharedReader {
  Arena arena;
  Lattice<float> lattice;
  __device__ __forceinline__ VelocityRow row(int i, int j, int k) const {
    return {arena.velocity + static_cast<int>(lattice.index(i, j, k))};
  }
};

// What a fused pass has to load and keep: a field that the next gather overwrites unread stays in
// registers and never goes through memory.
template <class GatherStage, class ScatterStage> struct Fused {
  using Used = on_t<union_t<typename GatherStage::Reads, typename GatherStage::Writes,
                            typename ScatterStage::Reads, typename ScatterStage::Writes>,
                    Particles>;
  using Loads =
      stored_t<on_t<union_t<typename GatherStage::Reads,
                            minus_t<typename ScatterStage::Reads, typename GatherStage::Writes>>,
                    Particles>>;
  using Changed = union_t<typename GatherStage::Writes, typename ScatterStage::Writes>;
  using Overwritten = minus_t<typename GatherStage::Writes, typename GatherStage::Reads>;
  using Keeps = stored_t<on_t<minus_t<Changed, Overwritten>, Particles>>;
};

// Velocities from sums, then the scene's forces and boundaries; clears the sums.
template <class Stage, class Ctx>
__device__ __forceinline__ void move_nodes(Arena const& arena, Ctx const& context,
                                           FixedPoint const& unit) {
  using Used = on_t<union_t<typename Stage::Reads, typename Stage::Writes>, Nodes>;
  auto const& lattice = context.lattice;
  for (int i = threadIdx.x; i < arena.count; i += blockDim.x) {
    Local<float, Used> n;
    n[node::Momentum{}] = {{arena.sums[i] * unit.inverse_momentum,
                            arena.sums[arena.count + i] * unit.inverse_momentum,
                            arena.sums[2 * arena.count + i] * unit.inverse_momentum}};
    n[node::Mass{}] = arena.sums[3 * arena.count + i] * unit.inverse_mass;
    int const x = i % lattice.nodes[0], yz = i / lattice.nodes[0];
    n[node::Position{}] = lattice.position(x, yz % lattice.nodes[1], yz / lattice.nodes[1]);
    Stage::run(n, context);
    Vec3<float> const v = n[node::Velocity{}];
    arena.velocity[i] = make_float4(v[0], v[1], v[2], n[node::Mass{}]);
    for (int c = 0; c < 4; ++c) arena.sums[c * arena.count + i] = 0;
  }
}

// The particles of one environment, shared among the threads of a block. Every pass returns the faults
// that this thread met.
template <class ParticleView> struct Block {
  ParticleView view;
  std::int64_t first;
  int live;

  template <class Stage, class Sums, class Ctx>
  __device__ __forceinline__ unsigned scatter(Sums const& sums, Ctx const& context) const {
    return pass<Stage>([&](auto& p) { return Stage::run(p, sums, context); });
  }
  template <class Stage, class Nodes, class Ctx>
  __device__ __forceinline__ unsigned gather(Nodes const& nodes, Ctx const& context) const {
    return pass<Stage>([&](auto& p) { return Stage::run(p, nodes, context); });
  }
  template <class GatherStage, class ScatterStage, class Nodes, class Sums, class Ctx>
  __device__ __forceinline__ unsigned gather_scatter(Nodes const& nodes, Sums const& sums,
                                                     Ctx const& context) const {
    using Plan = Fused<GatherStage, ScatterStage>;
    return pass<typename Plan::Used, typename Plan::Loads, typename Plan::Keeps>([&](auto& p) {
      unsigned const faults = GatherStage::run(p, nodes, context);
      return faults | ScatterStage::run(p, sums, context);
    });
  }

 private:
  template <class Stage, class Function>
  __device__ __forceinline__ unsigned pass(Function const& f) const {
    using Reads = on_t<typename Stage::Reads, Particles>;
    using Writes = on_t<typename Stage::Writes, Particles>;
    return pass<union_t<Reads, Writes>, stored_t<Reads>, stored_t<Writes>>(f);
  }
  template <class Used, class Loads, class Keeps, class Function>
  __device__ __forceinline__ unsigned pass(Function const& f) const {
    unsigned faults = 0;
    for (int slot = threadIdx.x; slot < live; slot += blockDim.x) {
      Local<float, Used> p;
      p.load(view, first + slot, Loads{});
      faults |= f(p);
      p.store(view, first + slot, Keeps{});
    }
    return faults;
  }
};

}  // namespace mpmpbd::resident
