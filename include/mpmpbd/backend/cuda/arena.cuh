// The grid of one environment, in the shared memory of a thread block or in the memory of the device.
//
// Sums are fixed point, of 32 bits for float and 64 for double: shared float atomics are compare-and-swap loops on sm_90,
// and their order is not repeatable, while integers may be added in any order.
#pragma once

#include <cuda_pipeline_primitives.h>

#include <mpmpbd/backend/cuda/team.cuh>
#include <mpmpbd/core/quad.hpp>
#include <mpmpbd/core/status.hpp>
#include <mpmpbd/mpm/lattice.hpp>
#include <mpmpbd/scene/stage.hpp>

namespace mpmpbd::cuda {

// Four numbers that are loaded at once, and the integers that sums of T are kept in.
template <class T> struct NumbersOf;
template <> struct NumbersOf<float> {
  using Four = float4;
  using Integer = int;
  using Unsigned = unsigned;
  static constexpr float scale = 4194304.0f;  // 2^22
  static constexpr float most_cells = 1.0f;
  // For |a| up to `scale`, the most that a particle brings to a node: 3 x 2^22 more, and the whole numbers are the last bits
  // of a float, beside others that differences do not have; no conversion is waited for. NaN would be some number: no momentum
  // that is NaN comes here (Scatter).
  __device__ __forceinline__ static Integer bits_of_nearest(float a) {
    return __float_as_int(a + 3.0f * scale);
  }
  // The count nearest to a b, product and rounding in one instruction.
  __device__ __forceinline__ static Integer nearest(float a, float b) {
    constexpr int bits_of_zero = 0x4b400000;
    return __float_as_int(multiply_add(a, b, 3.0f * scale)) - bits_of_zero;
  }
};
template <> struct NumbersOf<double> {
  struct alignas(32) Four {
    double x, y, z, w;
  };
  using Integer = long long;
  using Unsigned = unsigned long long;
  static constexpr double scale = 17592186044416.0;  // 2^44
  static constexpr double most_cells = 1024.0;
  __device__ __forceinline__ static Integer bits_of_nearest(double a) { return __double2ll_rn(a); }
  __device__ __forceinline__ static Integer nearest(double a, double b) {
    return __double2ll_rn(a * b);
  }
};

// Adds unsigned: a lost environment's sum wraps, and no other atomic sum has 64 bits. The bits are those of a signed sum.
template <class T>
__device__ __forceinline__ void add_counts(typename NumbersOf<T>::Integer* sum,
                                           typename NumbersOf<T>::Integer counts) {
  using Unsigned = typename NumbersOf<T>::Unsigned;
  atomicAdd(reinterpret_cast<Unsigned*>(sum), static_cast<Unsigned>(counts));
}

// Units of the sums: mass in heaviest particles, momentum in that mass times a cell per substep.
template <class T> struct FixedPoint {
  static constexpr T scale = NumbersOf<T>::scale;
  // At a node; 511 fit. In float a sum of masses begins anew at 1,024 of them, so up to 500 more than a multiple of that pass
  // unseen: at a start, or where a node with less than 500 has more than twice as many after one substep.
  static constexpr T most_masses = 500;
  // Of momentum over mass that a particle brings, per substep: with no more than most_masses at a node the sums hold it.
  static constexpr T most_cells = NumbersOf<T>::most_cells;
  static constexpr T greatest_contrast = 100;  // of masses in an environment

  T mass;              // counts per kg
  T momentum;          // counts per kg m/s
  T inverse_mass;      // kg per count
  T inverse_momentum;  // kg m/s per count

  MPMPBD_HD static FixedPoint make(T heaviest, T dx, T dt) {
    T const p = heaviest * dx / dt;
    return {scale / heaviest, scale / p, heaviest / scale, p / scale};
  }
};

// Velocities of nodes and their masses: four numbers together.
template <class T> struct Velocities {
  using Four = typename NumbersOf<T>::Four;
  Four* data;  // w: mass

  __device__ __forceinline__ Velocities operator+(int n) const { return {data + n}; }
  __device__ __forceinline__ Quad<T> operator[](int n) const {
    auto const v = data[n];
    return quad<T>(v.x, v.y, v.z, v.w);
  }
  __device__ __forceinline__ void set(int n, Quad<T> const& v) const {
    data[n] = {v[0], v[1], v[2], v[3]};
  }
  __device__ T mass(int n) const { return data[n].w; }

  // A copy by all threads of the block that goes on while they work: it is there after end_copy() and a barrier.
  __device__ void begin_copy(Velocities const& from, int count) const {
    for (int i = static_cast<int>(threadIdx.x); i < count; i += static_cast<int>(blockDim.x))
      __pipeline_memcpy_async(data + i, from.data + i, sizeof(Four));
    __pipeline_commit();
  }
  __device__ static void end_copy() { __pipeline_wait_prior(0); }
};

// Float: 16 B of velocity and 16 B of sums per node.
template <class T> struct Arena {
  using Integer = typename NumbersOf<T>::Integer;
  Velocities<T> velocity;
  Integer* sums;  // four planes: momentum x, y, z, mass
  int count;      // nodes

  MPMPBD_HD static constexpr std::int64_t bytes(std::int64_t nodes) {
    return static_cast<std::int64_t>(sizeof(typename Velocities<T>::Four) + 4 * sizeof(Integer)) *
           nodes;
  }

  __device__ static Arena at(char* memory, int count) {
    auto* const velocities = reinterpret_cast<typename Velocities<T>::Four*>(memory);
    return {{velocities}, reinterpret_cast<Integer*>(velocities + count), count};
  }
  __device__ void clear_sums() const {
    Run{0, 4 * count}.each([&](int i) { sums[i] = 0; });
  }
};

// Momentum in whole counts.
template <class T> struct Counts { typename NumbersOf<T>::Integer x, y, z; };

// What the nodes of a particle get of its momentum, one after the other, in whole counts: the running sum of its shares is
// rounded, not each share. Small shares are the most frequent, and more of them would be rounded down than up: what moves would
// come to rest. From a start drawn by lot, every node gets its share in the mean, however small (systematic sampling).
template <class T> struct Shares {
  using Numbers = NumbersOf<T>;
  using Integer = typename Numbers::Integer;
  T sum[3];          // from `start` on [counts]
  Integer given[3];  // its bits_of_nearest

  // `start` in [-1/2, 1/2): nothing has been given.
  __device__ __forceinline__ static Shares from(T start) {
    Integer const none = Numbers::bits_of_nearest(T(0));
    return {{start, start, start}, {none, none, none}};
  }
  // Of the share weight * all.
  __device__ __forceinline__ Counts<T> next(T weight, Quad<T> const& all) {
    return {next(0, weight, all[0]), next(1, weight, all[1]), next(2, weight, all[2])};
  }

 private:
  __device__ __forceinline__ Integer next(int a, T weight, T all) {
    sum[a] = multiply_add(weight, all, sum[a]);
    Integer const now = Numbers::bits_of_nearest(sum[a]), more = now - given[a];
    given[a] = now;
    return more;
  }
};
// Drawn by lot from where a particle is [m] and the number of a substep, in [-1/2, 1/2) counts: the finish of
// MurmurHash3 (Appleby 2011), for which Philox would take more instructions than all shares.
template <class T> __device__ __forceinline__ T start_of(Vec3<T> const& x, std::int64_t step) {
  auto const bits = [&](int a) {
    return static_cast<unsigned>(__float_as_int(static_cast<float>(x[a])));
  };
  unsigned h = bits(0) * 0x9e3779b1u ^ bits(1) * 0x85ebca77u ^ bits(2) * 0xc2b2ae3du ^
               static_cast<unsigned>(step) * 0x27d4eb2fu;
  h = (h ^ (h >> 16)) * 0x85ebca6bu;
  h = (h ^ (h >> 13)) * 0xc2b2ae35u;
  return __int_as_float(static_cast<int>(0x3f800000u | (h >> 9))) - 1.5f;
}

// A pointer to each plane: an address is then one addition to what the stencil knows.
template <class T> struct FixedRow {
  using Integer = typename NumbersOf<T>::Integer;
  Integer *x, *y, *z, *mass;
  __device__ __forceinline__ FixedRow operator+(int n) const {
    return {x + n, y + n, z + n, mass + n};
  }
  __device__ __forceinline__ void add_mass(int n, T weight, Quad<T> const& all) const {
    cuda::add_counts<T>(mass + n, NumbersOf<T>::nearest(weight, all[3]));
  }
  __device__ __forceinline__ void add_counts(int n, Counts<T> const& c) const {
    cuda::add_counts<T>(x + n, c.x);
    cuda::add_counts<T>(y + n, c.y);
    cuda::add_counts<T>(z + n, c.z);
  }
};
template <class T> struct SumsOfArena {
  Arena<T> arena;
  Lattice<T> lattice;
  FixedPoint<T> unit;
  T start;  // of running sums
  static constexpr T most_cells = FixedPoint<T>::most_cells;
  __device__ __forceinline__ Shares<T> shares() const { return Shares<T>::from(start); }
  __device__ __forceinline__ auto window(int const (&at)[3]) const {
    auto* const first = arena.sums + static_cast<int>(lattice.index(at[0], at[1], at[2]));
    int const plane = arena.count;
    return Window{FixedRow<T>{first, first + plane, first + 2 * plane, first + 3 * plane},
                  lattice.nodes[0], lattice.nodes[0] * lattice.nodes[1]};
  }
};

template <class T> struct VelocitiesOfArena {
  Arena<T> arena;
  Lattice<T> lattice;
  __device__ __forceinline__ auto window(int const (&at)[3]) const {
    int const first = static_cast<int>(lattice.index(at[0], at[1], at[2]));
    return Window{arena.velocity + first, lattice.nodes[0], lattice.nodes[0] * lattice.nodes[1]};
  }
};

// Velocities of a run of nodes from their sums, then the scene's forces and boundaries; clears the sums that lie
// apart. `before`: the grid before the forces, where the transfer asks for it. Returns the faults met.
template <class Stage, class T, class Ctx>
__device__ __forceinline__ std::uint32_t move_nodes(Arena<T> const& arena, Run const& nodes,
                                                    Ctx const& context, FixedPoint<T> const& unit,
                                                    Arena<T> const& before = {}) {
  using Unsigned = typename NumbersOf<T>::Unsigned;
  using Used = on_t<union_t<typename Stage::Reads, typename Stage::Writes>, Nodes>;
  constexpr auto most = static_cast<Unsigned>(FixedPoint<T>::most_masses * FixedPoint<T>::scale);
  auto const& lattice = context.lattice;
  constexpr bool looks_back = contains<Used, node::PreviousMomentum>;
  int const plane = arena.count;
  auto const momentum = [&](auto const* sum) {
    return vec(static_cast<T>(sum[0]) * unit.inverse_momentum,
               static_cast<T>(sum[plane]) * unit.inverse_momentum,
               static_cast<T>(sum[2 * plane]) * unit.inverse_momentum);
  };
  bool crowded = false;
  nodes.each([&](int i) {
    auto* const sum = arena.sums + i;
    auto const mass = static_cast<Unsigned>(sum[3 * plane]);
    crowded = crowded || mass > most;
    Local<T, Used> n;
    n[node::Momentum{}] = momentum(sum);
    if constexpr (looks_back) n[node::PreviousMomentum{}] = momentum(before.sums + i);
    n[node::Mass{}] = static_cast<T>(mass) * unit.inverse_mass;
    int const x = i % lattice.nodes[0], yz = i / lattice.nodes[0];
    n[node::Position{}] = lattice.position(x, yz % lattice.nodes[1], yz / lattice.nodes[1]);
    Stage::run(n, context);
    Vec3<T> const v = n[node::Velocity{}];
    arena.velocity.set(i, quad(v[0], v[1], v[2], n[node::Mass{}]));
    for (int c = 0; c < 4; ++c) sum[c * plane] = 0;
    if constexpr (looks_back) {
      Vec3<T> const u = n[node::PreviousVelocity{}];
      before.velocity.set(i, quad(u[0], u[1], u[2], T(0)));
      for (int c = 0; c < 3; ++c) before.sums[i + c * plane] = 0;
    }
  });
  return crowded ? static_cast<std::uint32_t>(Fault::overflow) : 0u;
}

}  // namespace mpmpbd::cuda
