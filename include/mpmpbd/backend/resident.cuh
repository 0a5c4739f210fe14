// Resident execution: one thread block holds the grid of one environment in shared memory and runs all
// substeps of a step in one launch: scatter, (n - 1) x fused gather and scatter, gather.
//
// Stages are the scene's own; only how a grid adds and reads is said here. Sums are 32-bit fixed point
// (shared float atomics are compare-and-swap loops on sm_90, and their order is not repeatable).
//
// Limits: float; no FLIP (a row has no add_previous); the caller gives dt and the number of substeps, and
// holds particles that were set from outside inside the domain.
#pragma once

#include <mpmpbd/core/table.hpp>
#include <mpmpbd/coupling/team.cuh>
#include <mpmpbd/pbd/access.hpp>
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
  __device__ __forceinline__ FixedRow operator+(int n) const { return {first + n, plane, unit}; }
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
  __device__ __forceinline__ auto window(int const (&at)[3]) const {
    int const first = static_cast<int>(lattice.index(at[0], at[1], at[2]));
    return Window{FixedRow{arena.sums + first, arena.count, unit}, lattice.nodes[0],
                  lattice.nodes[0] * lattice.nodes[1]};
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
struct SharedReader {
  Arena arena;
  Lattice<float> lattice;
  __device__ __forceinline__ auto window(int const (&at)[3]) const {
    int const first = static_cast<int>(lattice.index(at[0], at[1], at[2]));
    return Window{VelocityRow{arena.velocity + first}, lattice.nodes[0],
                  lattice.nodes[0] * lattice.nodes[1]};
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

// Nodes as a coupling sees them; the mass stands beside the velocity.
template <class Move, class Ctx> struct SharedNodes {
  Arena arena;
  Ctx const& context;
  void* scratch;
  int* slot_of_node;

  MPMPBD_HD float mass(int i) const { return arena.velocity[i].w; }
  MPMPBD_HD Vec3<float> velocity(int i) const {
    float4 const v = arena.velocity[i];
    return {{v.x, v.y, v.z}};
  }
  MPMPBD_HD void set_velocity(int i, Vec3<float> const& v) const {
    arena.velocity[i] = {v[0], v[1], v[2], mass(i)};
  }
  MPMPBD_HD Vec3<float> inverse_mass(int i) const {
    auto const& lattice = context.lattice;
    int const row = i / lattice.nodes[0];
    auto const x =
        lattice.position(i % lattice.nodes[0], row % lattice.nodes[1], row / lattice.nodes[1]);
    return Move::inverse_mass(velocity(i), mass(i), x, context);
  }
};

// The tables of a store on the device: views by value, live counts per domain and environment.
template <class List, class Domains> struct Tables;
template <class List, class... Ds> struct Tables<List, TypeList<Ds...>> {
  template <class D> struct Held {
    View<float, on_t<List, D>> view;
    std::int64_t const* live;
  };
  struct All : Held<Ds>... {};
  All all;

  template <class D> MPMPBD_HD auto const& of() const { return static_cast<Held<D> const&>(all); }
  template <class D> auto& of() { return static_cast<Held<D>&>(all); }
  __device__ auto environment(std::int64_t env) const {
    return EnvironmentAccess<float, DomainAccess<Ds, View<float, on_t<List, Ds>>>...>{
        access_domain<Ds>(of<Ds>().view, env, of<Ds>().live[env])...};
  }
};
template <class Scene> using SceneStore = State<float, typename Scene::StateFields>;
template <class Scene>
using SceneTables = Tables<typename SceneStore<Scene>::List, typename SceneStore<Scene>::Domains>;

// What a step of a scene is launched with.
template <class Scene> struct Launch {
  using Ctx = Context<float, typename Scene::Policies>;
  SceneTables<Scene> tables;
  Ctx const* contexts;  // per environment; tick of the first substep
  float heaviest;       // particle [kg]
  int substeps;
  char* scratch;  // of the coupling, per environment
  std::int64_t scratch_stride;
  int* slot_of_node;  // per environment and node; -1
  unsigned* faults;   // per environment
};

// Runs one environment on this block.
template <class Scene> struct Block {
  using In = typename Scene::In;
  using Ctx = typename Launch<Scene>::Ctx;
  using P2G = ParticlesToGrid<typename In::Body, typename In::Effects>;
  using G2P = GridToParticles<typename In::Body, typename In::Effects>;
  using Move = MoveNodes<typename In::Body, typename In::Effects>;

  Launch<Scene> const& launch;
  Arena arena;
  Ctx context;
  FixedPoint unit;
  unsigned met = 0;

  __device__ Block(Launch<Scene> const& launch_, char* memory)
      : launch(launch_), arena(), context(launch_.contexts[blockIdx.x]) {
    arena = Arena::at(memory, static_cast<int>(context.lattice.count()));
    unit = FixedPoint::make(launch.heaviest, context.lattice.dx, context.tick.dt);
  }

  __device__ void step() {
    arena.clear();
    __syncthreads();
    SharedWriter const sums{arena, context.lattice, unit};
    SharedReader const nodes{arena, context.lattice};
    context.tick.substeps = launch.substeps;
    pass<P2G>([&](auto& p) { return P2G::run(p, sums, context); });
    for (int s = 0; s < launch.substeps; ++s) {
      __syncthreads();
      move_nodes<Move>(arena, context, unit);
      __syncthreads();
      context.tick.substep = s;
      for_each_stage(typename Scene::Substep::Stages{});
      if (s + 1 == launch.substeps) {
        pass<G2P>([&](auto& p) { return G2P::run(p, nodes, context); });
        break;
      }
      using Plan = Fused<G2P, P2G>;
      pass<typename Plan::Used, typename Plan::Loads, typename Plan::Keeps>([&](auto& p) {
        unsigned const faults = G2P::run(p, nodes, context);
        return faults | P2G::run(p, sums, context);
      });
      context.tick.step += 1;
      context.tick.previous_dt = context.tick.dt;
      context.tick.time += context.tick.dt;
    }
    if (met != 0) atomicOr(launch.faults + blockIdx.x, met);
  }

 private:
  template <class... Stages> __device__ void for_each_stage(TypeList<Stages...>) {
    (together<Stages>(), ...);
  }
  // Stages over the whole environment run between the barriers; the others are inlined in the passes.
  template <class Stage> __device__ void together() {
    if constexpr (std::is_same_v<typename Stage::Kind, kind::Together>) {
      SharedNodes<Move, Ctx> const grid{arena, context,
                                        launch.scratch + blockIdx.x * launch.scratch_stride,
                                        launch.slot_of_node + blockIdx.x * context.lattice.count()};
      met |= Stage::run(BlockTeam{}, launch.tables.environment(blockIdx.x), context, grid);
      __syncthreads();
    }
  }

  template <class Stage, class Function> __device__ __forceinline__ void pass(Function const& f) {
    using Reads = on_t<typename Stage::Reads, Particles>;
    using Writes = on_t<typename Stage::Writes, Particles>;
    pass<union_t<Reads, Writes>, stored_t<Reads>, stored_t<Writes>>(f);
  }
  // The particles of the environment, shared among the threads.
  template <class Used, class Loads, class Keeps, class Function>
  __device__ __forceinline__ void pass(Function const& f) {
    auto const& table = launch.tables.template of<Particles>();
    int const live = static_cast<int>(table.live[blockIdx.x]);
    std::int64_t const first = blockIdx.x * table.view.capacity;
    unsigned faults = 0;
    for (int slot = threadIdx.x; slot < live; slot += blockDim.x) {
      Local<float, Used> p;
      p.load(table.view, first + slot, Loads{});
      faults |= f(p);
      p.store(table.view, first + slot, Keeps{});
    }
    met |= faults;
  }
};

// One step of every environment, a block each. 512 threads leave 128 registers: no spills in the loop.
template <class Scene, int threads>
__global__ void __launch_bounds__(threads, 1) step(Launch<Scene> const launch) {
  extern __shared__ char memory[];
  Block<Scene> block(launch, memory);
  block.step();
}

}  // namespace mpmpbd::resident
