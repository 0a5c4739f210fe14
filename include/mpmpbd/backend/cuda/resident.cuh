// Resident execution: one thread block holds the grid of one environment in shared memory and runs all substeps of
// a step in one launch: scatter, (n - 1) x fused gather and scatter, gather.
//
// A coupling has serial parts for which everybody waits. With one, velocities take the place of their sums, and gather and
// scatter are passes apart: a multiprocessor holds twice as many environments, and one works while another waits.
//
// Stages are the scene's own. A coupling is carried out by the first threads of the block; as soon as it says
// which nodes it may change, the others take the particles that see none of them. Sums are integers, so bits do
// not depend on who came first.
//
// Limits: float (shared memory adds 64-bit integers in a loop); no FLIP (its grid would need twice the memory).
#pragma once

#include <mpmpbd/backend/cuda/couple.cuh>
#include <mpmpbd/backend/cuda/passes.cuh>

namespace mpmpbd::cuda {

// What the threads of a block share beside the grid.
template <class Scene> struct Shared : StepRecord<Scene, float> {
  int taken;    // chunks of particles that have been
  int waiting;  // particles that wait for the coupling
};

// Runs one environment on this block.
template <class Scene> class ResidentBlock {
  using In = typename Scene::In;
  using Move = MoveNodes<typename In::Body, typename In::Effects>;
  using Grid = std::conditional_t<detail::couples<Scene>, Arena<float, VelocitiesInPlace>,
                                  Arena<float, VelocitiesApart>>;
  using Coupling = Couple<Scene, float, Grid>;
  using Passes = ParticlePasses<Scene, float, Grid>;
  using Near = typename Coupling::Near;
  using Ctx = typename StepRecord<Scene, float>::Ctx;

 public:
  // Without the coupling's, which begins where these end.
  MPMPBD_HD static constexpr std::int64_t shared_bytes(std::int64_t nodes) {
    return aligned(shared_at(nodes) + static_cast<std::int64_t>(sizeof(Shared<Scene>)));
  }

  __device__ ResidentBlock(Launch<Scene, float> const& launch, char* memory)
      : launch_(launch),
        arena_(Grid::at(memory, static_cast<int>(launch.lattice.count()))),
        near_{reinterpret_cast<unsigned*>(memory + Grid::bytes(arena_.count)), launch.lattice},
        shared_(shared_part(memory, arena_.count)),
        live_(launch.live_particles(blockIdx.x)) {}

  __device__ void step() {
    if (!launch_.moves(blockIdx.x)) return;
    StepControl const control{launch_.fields(blockIdx.x)};
    if (control.frozen()) return;
    begin(control);
    __syncthreads();
    auto const clock = shared_.clock;
    if (shared_.frozen) {
      if (threadIdx.x == 0) control.finish(clock, 0);
      return;
    }
    Ctx const& context = shared_.context;
    auto const at = [&](int s) { return StepRecord<Scene, float>::at(context, clock, s); };
    Passes const passes{launch_, arena_, shared_.fixed_point()};
    if constexpr (!Grid::in_place) scatter(passes, at(0), 0);
    int done = 0;
    for (; done < clock.substeps; ++done) {
      __syncthreads();
      if (done > 0) close(control, done - 1);
      near_.clear();
      Ctx const now = at(done);
      if constexpr (Grid::in_place) {
        scatter(passes, now, done);
        __syncthreads();
      }
      shared_.note(move_nodes<Move>(arena_, Run{0, arena_.count}, now, passes.unit), done);
      if (__syncthreads_or(threadIdx.x == 0 && shared_.frozen)) break;
      if constexpr (!Grid::in_place) {
        if (done + 1 < clock.substeps) {
          advance(done, [&](std::int64_t index, Met& met) {
            passes.gather_and_scatter(index, now, at(done + 1), met);
          });
          continue;
        }
      }
      advance(done, [&](std::int64_t index, Met& met) { passes.gather(index, now, met); });
    }
    __syncthreads();
    if (done == clock.substeps) close(control, done - 1);
    if (threadIdx.x == 0) control.finish(clock, done);
  }

 private:
  MPMPBD_HD static constexpr std::int64_t aligned(std::int64_t bytes) {
    return (bytes + 15) / 16 * 16;
  }
  MPMPBD_HD static constexpr std::int64_t shared_at(std::int64_t nodes) {
    return aligned(Grid::bytes(nodes) + Near::bytes(nodes));
  }
  __device__ static Shared<Scene>& shared_part(char* memory, std::int64_t nodes) {
    return *reinterpret_cast<Shared<Scene>*>(memory + shared_at(nodes));
  }
  __device__ std::int64_t first() const { return launch_.first_particle(blockIdx.x); }

  // Bounds of the present state, and with them the substeps of this step.
  template <class Control> __device__ void begin(Control const& control) {
    if (threadIdx.x == 0) shared_.open(control.env, launch_.lattice);
    __syncthreads();
    shared_.found.include(
        look_at_particles(launch_, blockIdx.x, Run{0, live_}, Ctx(shared_.context)));
    __syncthreads();
    if (threadIdx.x == 0) shared_.choose(control, launch_);
  }
  template <class Control> __device__ void close(Control const& control, int s) {
    if (threadIdx.x == 0) shared_.close(control, s);
  }

  // All particles to a grid without anything, for substep s.
  __device__ void scatter(Passes const& passes, Ctx const& context, int s) {
    arena_.clear_sums();
    __syncthreads();
    Met met;
    Run{0, live_}.each([&](int slot) { passes.scatter(first() + slot, context, met); });
    if (threadIdx.x == 0) shared_.taken = shared_.waiting = 0;
    shared_.note(met.next, s);
  }

  // Coupling and particles of substep s.
  template <class Function> __device__ void advance(int s, Function const& f) {
    Met met;
    auto const one = [&](int slot) { f(first() + slot, met); };
    if constexpr (Coupling::overlaps) {
      if (threadIdx.x < team_size)
        met.now |= couple(launch_, s);
      else
        Coupling::Nodes_::meet_others();
      take_particles(one);
    } else {
      if constexpr (Coupling::any) {
        met.now |= couple(launch_, s);
        __syncthreads();
      }
      Run{0, live_}.each(one);
    }
    shared_.note(met.now, s);
    shared_.note(met.next, s + 1);
  }
  // A function of its own, told little: what its call takes must not crowd the particles' registers.
  __device__ __noinline__ static std::uint32_t couple(Launch<Scene, float> const& launch, int s) {
    alignas(16) extern __shared__ char dynamic_shared_memory[];
    char* const memory = dynamic_shared_memory;
    auto const arena = Grid::at(memory, static_cast<int>(launch.lattice.count()));
    auto* const near = reinterpret_cast<unsigned*>(memory + Grid::bytes(arena.count));
    return Coupling::run(launch, blockIdx.x, arena, near, shared_part(memory, arena.count), s,
                         Coupling::overlaps, memory + shared_bytes(arena.count));
  }

  // First the particles that see no node of the coupling, in chunks for whoever is free; then those that waited.
  template <class Function> __device__ __forceinline__ void take_particles(Function const& one) {
    int* const waiting = launch_.waiting + first();
#if defined(__CUDACC__)
#pragma unroll 1
#endif
    for (int turn = 0; turn < 2; ++turn) {
      if (turn == 1) __syncthreads();
      for (int i = static_cast<int>(threadIdx.x);; i += static_cast<int>(blockDim.x)) {
        int const slot = turn == 0 ? next_slot(waiting) : i < shared_.waiting ? waiting[i] : none;
        if (slot == none) break;
        if (slot != later) one(slot);
      }
    }
    __syncthreads();
    if (threadIdx.x == 0) shared_.taken = shared_.waiting = 0;
  }
  static constexpr int none = -2, later = -1;
  // Of a warp: the next 32 slots; a particle near the coupling goes to the list of those that wait.
  __device__ int next_slot(int* waiting) {
    int const lane = static_cast<int>(threadIdx.x) & 31;
    int chunk = 0;
    if (lane == 0) chunk = atomicAdd(&shared_.taken, 1);
    chunk = __shfl_sync(0xffffffffu, chunk, 0);
    if (32 * chunk >= live_) return none;
    int const slot = 32 * chunk + lane;
    bool const there = slot < live_;
    bool const waits =
        there &&
        near_.has(launch_.particles().view.template get<particle::Position>(first() + slot));
    unsigned const all = __ballot_sync(0xffffffffu, waits);
    int first = 0;
    if (lane == 0 && all != 0) first = atomicAdd(&shared_.waiting, __popc(all));
    first = __shfl_sync(0xffffffffu, first, 0);
    if (waits) waiting[first + __popc(all & ((1u << lane) - 1u))] = slot;
    return there && !waits ? slot : later;
  }

  Launch<Scene, float> const& launch_;
  Grid arena_;
  Near near_;
  Shared<Scene>& shared_;
  int live_;
};

// One step of every environment, a block each. 512 threads leave 128 registers: no spills in the loop.
template <class Scene, int threads>
__global__ void __launch_bounds__(threads, 1)
    step(__grid_constant__ Launch<Scene, float> const launch) {
  alignas(16) extern __shared__ char dynamic_shared_memory[];
  ResidentBlock<Scene>(launch, dynamic_shared_memory).step();
}

}  // namespace mpmpbd::cuda
