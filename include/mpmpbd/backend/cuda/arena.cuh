// The grid of one environment, in the shared memory of a thread block or in the memory of the device.
//
// Sums are 32-bit fixed point: shared float atomics are compare-and-swap loops on sm_90, and their order is not
// repeatable, while integers may be added in any order.
#pragma once

#include <mpmpbd/backend/cuda/team.cuh>
#include <mpmpbd/core/quad.hpp>
#include <mpmpbd/core/status.hpp>
#include <mpmpbd/mpm/lattice.hpp>

namespace mpmpbd::cuda {

// Units of the sums: mass in heaviest particles, momentum in that mass times a cell per substep.
struct FixedPoint {
  static constexpr float scale = 4194304.0f;          // 2^22
  static constexpr float most_masses = 500.0f;        // at a node; 511 fit
  static constexpr float greatest_contrast = 100.0f;  // of masses in an environment

  float mass;              // counts per kg
  float momentum;          // counts per kg m/s
  float inverse_mass;      // kg per count
  float inverse_momentum;  // kg m/s per count

  MPMPBD_HD static FixedPoint make(float heaviest, float dx, float dt) {
    float const p = heaviest * dx / dt;
    return {scale / heaviest, scale / p, heaviest / scale, p / scale};
  }
};

// 16 B of sums and 16 B of velocity per node.
struct Arena {
  float4* velocity;  // w: mass
  int* sums;         // four planes: momentum x, y, z, mass
  int count;         // nodes

  static constexpr int bytes_per_node = sizeof(float4) + 4 * sizeof(int);
  MPMPBD_HD static constexpr std::int64_t bytes(std::int64_t nodes) {
    return bytes_per_node * nodes;
  }

  __device__ static Arena at(char* memory, int count) {
    return {reinterpret_cast<float4*>(memory),
            reinterpret_cast<int*>(memory + sizeof(float4) * static_cast<unsigned>(count)), count};
  }
  __device__ void clear_sums() const {
    Run{0, 4 * count}.each([&](int i) { sums[i] = 0; });
  }
};

// A pointer to each plane: an address is then one addition to what the stencil knows.
struct FixedRow {
  int *x, *y, *z, *mass;
  __device__ __forceinline__ FixedRow operator+(int n) const {
    return {x + n, y + n, z + n, mass + n};
  }
  __device__ __forceinline__ void add(int n, Quad<float> const& counts) const {
    atomicAdd(x + n, __float2int_rn(counts[0]));
    atomicAdd(y + n, __float2int_rn(counts[1]));
    atomicAdd(z + n, __float2int_rn(counts[2]));
    atomicAdd(mass + n, __float2int_rn(counts[3]));
  }
};
struct SumsOfArena {
  Arena arena;
  Lattice<float> lattice;
  FixedPoint unit;
  // Momentum at a cell per substep counts as much as mass: with no more than most_masses at a node the sums hold it.
  __device__ __forceinline__ Quad<float> in_counts(Quad<float> const& q) const {
    return quad(q[0] * unit.momentum, q[1] * unit.momentum, q[2] * unit.momentum, q[3] * unit.mass);
  }
  template <class Change>
  __device__ __forceinline__ Change in_counts(Change const& momentum) const {
    return unit.momentum * momentum;
  }
  __device__ __forceinline__ auto window(int const (&at)[3]) const {
    int* const first = arena.sums + static_cast<int>(lattice.index(at[0], at[1], at[2]));
    int const plane = arena.count;
    return Window{FixedRow{first, first + plane, first + 2 * plane, first + 3 * plane},
                  lattice.nodes[0], lattice.nodes[0] * lattice.nodes[1]};
  }
};

struct VelocityRow {
  float4 const* first;
  __device__ __forceinline__ VelocityRow operator+(int n) const { return {first + n}; }
  __device__ __forceinline__ Quad<float> operator[](int n) const {
    float4 const v = first[n];
    return quad<float>(v.x, v.y, v.z, v.w);
  }
};
struct VelocitiesOfArena {
  Arena arena;
  Lattice<float> lattice;
  __device__ __forceinline__ auto window(int const (&at)[3]) const {
    int const first = static_cast<int>(lattice.index(at[0], at[1], at[2]));
    return Window{VelocityRow{arena.velocity + first}, lattice.nodes[0],
                  lattice.nodes[0] * lattice.nodes[1]};
  }
};

// Velocities of a run of nodes from their sums, then the scene's forces and boundaries; clears the sums. Returns the
// faults met.
template <class Stage, class Ctx>
__device__ __forceinline__ std::uint32_t move_nodes(Arena const& arena, Run const& nodes,
                                                    Ctx const& context, FixedPoint const& unit) {
  using Used = on_t<union_t<typename Stage::Reads, typename Stage::Writes>, Nodes>;
  constexpr auto most = static_cast<unsigned>(FixedPoint::most_masses * FixedPoint::scale);
  auto const& lattice = context.lattice;
  bool crowded = false;
  nodes.each([&](int i) {
    int* const sum = arena.sums + i;
    int const plane = arena.count;
    auto const mass = static_cast<unsigned>(sum[3 * plane]);
    crowded = crowded || mass > most;
    Local<float, Used> n;
    n[node::Momentum{}] = {{static_cast<float>(sum[0]) * unit.inverse_momentum,
                            static_cast<float>(sum[plane]) * unit.inverse_momentum,
                            static_cast<float>(sum[2 * plane]) * unit.inverse_momentum}};
    n[node::Mass{}] = static_cast<float>(mass) * unit.inverse_mass;
    int const x = i % lattice.nodes[0], yz = i / lattice.nodes[0];
    n[node::Position{}] = lattice.position(x, yz % lattice.nodes[1], yz / lattice.nodes[1]);
    Stage::run(n, context);
    Vec3<float> const v = n[node::Velocity{}];
    arena.velocity[i] = make_float4(v[0], v[1], v[2], n[node::Mass{}]);
    for (int c = 0; c < 4; ++c) sum[c * plane] = 0;
  });
  return crowded ? static_cast<std::uint32_t>(Fault::overflow) : 0u;
}

}  // namespace mpmpbd::cuda
