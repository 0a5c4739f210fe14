// Tiled execution: the grid of every environment lies in the memory of the device, and many blocks move its particles. For
// bodies whose grid does not fit into the shared memory of one block.
//
// A step is a row of launches on one stream:
//
//   open    look    choose    scatter    n x ( nodes    environment    particles )    close
//
// particles: gather and scatter at once, by way of a tile (tile.cuh); in the last substep gather alone. Other blocks of the
// same launch carry out the stage of a coupling that goes item by item, and what comes after it is left to the next
// `environment`. An environment that does not move, is lost or is done skips the rest. Sums, stages and the bookkeeping of a
// step are those of the resident form, so bits are too.
//
// Limits: where environments choose their substeps, how many launches there are is read back once per step.
#pragma once

#include <algorithm>

#include <mpmpbd/backend/cuda/couple.cuh>
#include <mpmpbd/backend/cuda/memory.cuh>
#include <mpmpbd/backend/cuda/passes.cuh>

namespace mpmpbd::cuda {

// What one launch leaves to the next.
template <class Scene, class T> struct TiledRecord : StepRecord<Scene, T> { FixedPoint<T> unit; };

template <class Scene, class T> struct TiledLaunch {
  Launch<Scene, T> step;
  TiledRecord<Scene, T>* records;  // per environment
  char* grids;                     // per environment; sums are zero between two steps
  int* most_substeps;              // of any environment

  // Grids of an environment: a second one, before forces, where the transfer asks for it.
  static constexpr int grids_of_one = Scene::Body::Transfer::needs_previous_grid ? 2 : 1;
};

// Blocks beside those of particles carry out what goes item by item.
template <class Scene, class T> using TiledCouple = Couple<Scene, T, true>;

// The environment of this block, and its place among the blocks of that environment.
template <class Scene, class T> struct TiledBlock {
  using Record = TiledRecord<Scene, T>;
  TiledLaunch<Scene, T> const& launch;
  std::int64_t env;
  int part;

  __device__ static TiledBlock of(TiledLaunch<Scene, T> const& launch, int parts) {
    auto const block = static_cast<int>(blockIdx.x);
    return {launch, block / parts, block % parts};
  }
  __device__ Record& record() const { return launch.records[env]; }
  __device__ Arena<T> arena() const { return grid(0); }
  __device__ Arena<T> before() const {
    if constexpr (TiledLaunch<Scene, T>::grids_of_one == 2)
      return grid(1);
    else
      return {};
  }
  // As many of `count` items as the block has threads.
  __device__ Run items(int count) const {
    int const size = static_cast<int>(blockDim.x);
    return {part * size, count - part * size < size ? count : (part + 1) * size};
  }
  __device__ Run particles() const { return items(launch.step.live_particles(env)); }
  // Whether substep s belongs to the step of this environment.
  __device__ bool has(int s) const { return record().moves && s < record().clock.substeps; }

 private:
  __device__ Arena<T> grid(int which) const {
    auto const count = launch.step.lattice.count();
    auto const number = env * TiledLaunch<Scene, T>::grids_of_one + which;
    return Arena<T>::at(launch.grids + number * Arena<T>::bytes(count), static_cast<int>(count));
  }
};

// Finds what bounds the step of an environment, and what is at fault in its particles.
template <class Scene, class T>
__global__ void tiled_look(__grid_constant__ TiledLaunch<Scene, T> const launch, int parts) {
  alignas(16) extern __shared__ char dynamic_shared_memory[];
  auto const block = TiledBlock<Scene, T>::of(launch, parts);
  if (!block.record().moves) return;
  auto& found = *reinterpret_cast<Findings<T>*>(dynamic_shared_memory);
  if (threadIdx.x == 0) found = {};
  __syncthreads();
  auto const context = block.record().context;
  found.include(look_at_particles(launch.step, block.env, block.particles(), context));
  __syncthreads();
  if (threadIdx.x == 0) block.record().found.include(found);
}

// The particles of a block: one a thread, since a loop would hold in registers what all of its turns need.
template <class Scene, class T> class TiledParticles {
  using Body = typename Scene::Body;
  using Passes = ParticlePasses<Scene, T>;
  static constexpr bool by_tile = std::is_same_v<T, float> && !Body::Transfer::needs_previous_grid;
  using To = std::conditional_t<by_tile, ToTile<typename Body::Shape>, ToGrid>;

 public:
  static constexpr std::size_t shared_bytes = by_tile ? ToTile<typename Body::Shape>::bytes : 0;

  __device__ static void run(TiledBlock<Scene, T> const& block, int s) {
    auto& record = block.record();
    auto const clock = record.clock;
    auto const context = record.context;
    auto const at = [&](int n) { return StepRecord<Scene, T>::at(context, clock, n); };
    Passes const passes{block.launch.step, block.arena(), record.unit, block.before()};
    Run const slots = block.particles();
    int const slot = slots.first + static_cast<int>(threadIdx.x);
    bool const has_particle = slot < slots.end;
    std::int64_t const index = block.launch.step.first_particle(block.env) + slot;
    Met met;
    if (s < 0)
      passes.scatter(index, at(0), met, to(has_particle));
    else if (s + 1 < clock.substeps)
      passes.gather_and_scatter(index, at(s), at(s + 1), met, to(has_particle));
    else if (has_particle)
      passes.gather(index, at(s), met);
    record.note(met.now, s);
    record.note(met.next, s + 1);
  }

 private:
  __device__ static To to(bool has_particle) {
    if constexpr (by_tile) {
      alignas(16) extern __shared__ char dynamic_shared_memory[];
      return To(dynamic_shared_memory, has_particle);
    } else {
      return To{has_particle};
    }
  }
};

// A function of its own, so that what it takes does not crowd the particles' registers.
template <class Scene, class T>
__device__ __noinline__ void tiled_items(TiledBlock<Scene, T> const& block, int s) {
  using Coupling = TiledCouple<Scene, T>;
  auto const context = block.record().at(s);
  Coupling::run_items(block.launch.step, block.env, block.arena().velocity, context,
                      block.items(Coupling::items(block.launch.step, block.env)));
}

// Of an environment's parts, the last `parts` of particles: items take longest, so they begin first. Two blocks or more of a
// multiprocessor: one adds to its tile while another meets at a barrier.
template <class Scene, class T, int threads>
__global__ void __launch_bounds__(threads, 512 / threads)
    tiled_particles(__grid_constant__ TiledLaunch<Scene, T> const launch, int parts, int item_parts,
                    int s) {
  auto block = TiledBlock<Scene, T>::of(launch, parts + item_parts);
  if (!block.has(s)) return;
  if (block.part < item_parts) {
    if constexpr (TiledCouple<Scene, T>::ItemWise::size > 0) tiled_items(block, s);
    return;
  }
  block.part -= item_parts;
  Run const slots = block.particles();
  if (slots.first < slots.end) TiledParticles<Scene, T>::run(block, s);
}

template <class Scene, class T>
__global__ void tiled_nodes(__grid_constant__ TiledLaunch<Scene, T> const launch, int parts,
                            int s) {
  using Move = MoveNodes<typename Scene::Body, typename Scene::Effects>;
  auto const block = TiledBlock<Scene, T>::of(launch, parts);
  if (!block.has(s)) return;
  auto& record = block.record();
  auto const arena = block.arena();
  record.note(
      move_nodes<Move>(arena, block.items(arena.count), record.at(s), record.unit, block.before()),
      s);
}

// What concerns an environment as a whole, by one block each: its step is opened, its substeps are chosen, what the
// last substep has met is counted and the coupling of the next carried out.
template <class Scene, class T> class TiledEnvironment {
  using Coupling = TiledCouple<Scene, T>;

 public:
  static constexpr int most_threads = 256;
  // Where every environment has a multiprocessor to itself, all that its registers allow; else two share one.
  static int threads(std::int64_t environments, std::int64_t processors) {
    return environments <= processors ? most_threads : most_threads / 2;
  }
  // And of the shared memory that a block may have, less what the device itself keeps for each.
  static std::int64_t fast_bytes(std::int64_t asked, std::int64_t environments,
                                 std::int64_t processors, std::int64_t limit) {
    constexpr std::int64_t kept = 1 << 10;
    return std::min(asked, environments <= processors ? limit : (limit - kept) / 2);
  }
  static constexpr int opens = -2, chooses = -1;  // else: the substep that is coupled

  __device__ explicit TiledEnvironment(TiledLaunch<Scene, T> const& launch)
      : block_{launch, blockIdx.x, 0} {}

  // Part of its kernel, whose registers a function would not get.
  __device__ __forceinline__ void run(int s) const {
    auto& record = block_.record();
    StepControl const control{step().fields(block_.env)};
    bool const moves = record.moves;
    if (moves && s > 0) {
      couple<typename Coupling::After>(record, s - 1);
      record.note(lost_bodies(BlockTeam{}, control.env), s - 1);
    }
    __syncthreads();
    if (threadIdx.x == 0) {
      if (s == opens)
        record.open(control, step().moves(block_.env), step().lattice);
      else if (moves && s == chooses)
        choose(control, record);
      else if (moves)
        record.close_before(control, s);
    }
    __syncthreads();
    if (s == opens && record.moves) {
      Findings<T> of_bodies;
      of_bodies.held = lost_bodies(BlockTeam{}, control.env);
      record.found.include(of_bodies);
    }
    if (s >= 0 && record.moves) couple<typename Coupling::Before>(record, s);
  }

 private:
  using Record = TiledRecord<Scene, T>;
  __device__ Launch<Scene, T> const& step() const { return block_.launch.step; }

  template <class Control> __device__ void choose(Control const& control, Record& record) const {
    record.choose(control, step());
    record.unit = record.fixed_point();
    if (record.moves) atomicMax(block_.launch.most_substeps, record.clock.substeps);
  }
  template <class Stages>
  __device__ void couple([[maybe_unused]] Record& record, [[maybe_unused]] int s) const {
    if constexpr (Stages::size > 0) {
      alignas(16) extern __shared__ char dynamic_shared_memory[];
      auto const nodes = block_.arena().velocity;
      BlockTeam const team;
      record.note(Coupling::template run<Stages>(team, step(), block_.env, nodes,
                                                 record.at(team, s), dynamic_shared_memory),
                  s);
      __syncthreads();
    }
  }

  TiledBlock<Scene, T> block_;
};

// One block is enough for a multiprocessor, so that registers are not saved by spilling.
template <class Scene, class T>
__global__ void __launch_bounds__(TiledEnvironment<Scene, T>::most_threads, 1)
    tiled_environment(__grid_constant__ TiledLaunch<Scene, T> const launch, int s) {
  TiledEnvironment<Scene, T>(launch).run(s);
}

// The host's side: memory, and the row of launches.
template <class Scene, class T> class TiledSteps {
  using Environment = TiledEnvironment<Scene, T>;
  using Record = TiledRecord<Scene, T>;

 public:
  static constexpr int most_threads = 256;  // of a block: a tenth faster than 512
  // Indices of nodes and their four sums are 32-bit integers.
  static constexpr std::int64_t most_nodes = std::int64_t{1} << 29;

  static std::size_t bytes(std::int64_t environments, std::int64_t nodes) {
    auto const grids = environments * TiledLaunch<Scene, T>::grids_of_one;
    return grids_at(environments) + static_cast<std::size_t>(grids * Arena<T>::bytes(nodes));
  }
  TiledSteps() = default;
  TiledSteps(std::int64_t environments, std::int64_t nodes, cudaStream_t stream)
      : environments_(environments), memory_(bytes(environments, nodes)) {
    fill(0, memory_.bytes(), stream);
  }

  // Lets blocks have so much shared memory on the present device.
  static void reserve(std::int64_t bytes);

  // With blocks of so many threads on a device with so many multiprocessors, where a block may have `limit` bytes of shared
  // memory.
  void run(Launch<Scene, T> step, int threads, std::int64_t processors, std::int64_t limit,
           cudaStream_t stream) const;

 private:
  static constexpr std::size_t counter_bytes = 256;
  static std::size_t grids_at(std::int64_t environments) {
    auto const n = counter_bytes + static_cast<std::size_t>(environments) * sizeof(Record);
    return (n + 255) / 256 * 256;
  }
  void fill(int value, std::size_t bytes, cudaStream_t stream) const {
    require(cudaMemsetAsync(memory_.as(), value, bytes, stream), "clearing the grid");
  }
  void launch_all(Launch<Scene, T> const& step, int threads, std::int64_t processors,
                  cudaStream_t stream) const;
  // Waits for the device: the one time in a step, and only where environments choose their substeps.
  int most_substeps(cudaStream_t stream) const {
    int most = 0;
    require(cudaMemcpyAsync(&most, memory_.as(), sizeof most, cudaMemcpyDeviceToHost, stream),
            "asking for the substeps");
    require(cudaStreamSynchronize(stream), "asking for the substeps");
    return most;
  }

  std::int64_t environments_ = 0;
  Memory memory_;
};

// Not inline, so that `extern template` keeps the kernels to one source.
template <class Scene, class T> void TiledSteps<Scene, T>::reserve(std::int64_t bytes) {
  reserve_shared(tiled_environment<Scene, T>, bytes);
}
template <class Scene, class T>
void TiledSteps<Scene, T>::run(Launch<Scene, T> step, int threads, std::int64_t processors,
                               std::int64_t limit, cudaStream_t stream) const {
  step.fast_bytes = Environment::fast_bytes(step.fast_bytes, environments_, processors, limit);
  try {
    launch_all(step, std::min(threads, most_threads), processors, stream);
  } catch (...) {  // sums were under way
    if (cudaMemsetAsync(memory_.as(), 0, memory_.bytes(), stream) != cudaSuccess)
      cudaGetLastError();
    throw;
  }
}
template <class Scene, class T>
void TiledSteps<Scene, T>::launch_all(Launch<Scene, T> const& step, int threads,
                                      std::int64_t processors, cudaStream_t stream) const {
  TiledLaunch<Scene, T> const launch{step, memory_.as<Record>(counter_bytes),
                                     memory_.as(grids_at(environments_)), memory_.as<int>()};
  auto const environment = [&](int s) {
    start(stream, "a step", tiled_environment<Scene, T>, environments_,
          Environment::threads(environments_, processors),
          static_cast<std::size_t>(step.fast_bytes), launch, s);
  };
  auto const parts_of = [&](std::int64_t items) {
    return items > 0 ? static_cast<int>((items + threads - 1) / threads) : 1;
  };
  int const particles = parts_of(step.tables.template of<Particles>().view.capacity);
  int const nodes = parts_of(step.lattice.count());
  auto const most_items = TiledCouple<Scene, T>::most_items(step);
  auto const move = [&](int s) {
    int const items = s >= 0 && most_items > 0 ? parts_of(most_items) : 0;
    start(stream, "a step", tiled_particles<Scene, T, most_threads>,
          environments_ * (particles + items), threads, TiledParticles<Scene, T>::shared_bytes,
          launch, particles, items, s);
  };
  environment(Environment::opens);
  start(stream, "a step", tiled_look<Scene, T>, environments_ * particles, threads,
        sizeof(Findings<T>), launch, particles);
  fill(0, sizeof(int), stream);
  environment(Environment::chooses);
  int const substeps = step.choice.fixed > 0 ? step.choice.fixed : most_substeps(stream);
  move(-1);
  for (int s = 0; s < substeps; ++s) {
    start(stream, "a step", tiled_nodes<Scene, T>, environments_ * nodes, threads, 0, launch, nodes,
          s);
    environment(s);
    move(s);
  }
  environment(substeps);
}

}  // namespace mpmpbd::cuda
