// Resident execution: a thread block holds the grid of an environment in its shared memory, and all substeps of a step are
// one launch: scatter, (n - 1) x fused gather and scatter, gather. Several steps may be one launch as well.
//
// A coupling is a long row of short stages, each waiting for the one before. So a block of a scene with one carries
// several environments. Substep by substep it moves their particles, one environment after the other, puts each
// grid by, and then carries out all couplings side by side, a team of threads each: one works while others wait. What of a
// coupling goes item by item is done by all threads when the grid is there again, and what comes after it by the teams,
// before the next coupling.
//
// Stages are the scene's own. Sums are integers, so bits depend neither on who came first nor on who shares a block.
//
// Limits: float (shared memory adds 64-bit integers in a loop); no FLIP (its grid would need twice the memory).
#pragma once

#include <algorithm>
#include <bit>

#include <mpmpbd/backend/cuda/couple.cuh>
#include <mpmpbd/backend/cuda/memory.cuh>
#include <mpmpbd/backend/cuda/passes.cuh>

namespace mpmpbd::cuda {

template <class Scene> struct ResidentLaunch {
  Launch<Scene, float> step;
  std::int64_t environments;
  int teams, log2_of_team;            // how many, and of 2^log2_of_team threads each
  StepRecord<Scene, float>* records;  // per environment
  float4* grids;  // with a coupling: velocities after forces, per environment and node
};

// Runs the environments of this block.
template <class Scene> class ResidentBlock {
  using In = typename Scene::In;
  using Move = MoveNodes<typename In::Body, typename In::Effects>;
  using Coupling = Couple<Scene, float>;
  using Passes = ParticlePasses<Scene, float, most_threads>;  // the next round of a block
  using Record = StepRecord<Scene, float>;
  using Found = Findings<float>;

 public:
  MPMPBD_HD static constexpr std::int64_t shared_bytes(std::int64_t nodes) {
    return found_at(nodes) + static_cast<std::int64_t>(sizeof(Found));
  }

  __device__ ResidentBlock(ResidentLaunch<Scene> const& launch, char* memory)
      : launch_(launch),
        arena_(Arena<float>::at(memory, static_cast<int>(launch.step.lattice.count()))),
        found_(*reinterpret_cast<Found*>(memory + found_at(arena_.count))) {}

  // So many steps, and what happens to every environment between two of them.
  template <class Between> __device__ void run(int steps, Between const& between) {
    arena_.clear_sums();
    for (int done = 0;;) {
      step();
      if (++done == steps) return;
      each_environment(between);
    }
  }

 private:
  MPMPBD_HD static constexpr std::int64_t found_at(std::int64_t nodes) {
    return (Arena<float>::bytes(nodes) + 15) / 16 * 16;
  }

  __device__ void step() {
    for (int s = 0; move_all(s); ++s)
      if constexpr (Coupling::any) couple_all(s);
  }
  // A thread for each, of as many warps as there are.
  template <class Between> __device__ void each_environment(Between const& between) const {
    sync_block();
    std::int64_t const warp = threadIdx.x / Warp::size, warps = blockDim.x / Warp::size;
    for (std::int64_t env = blockIdx.x + warp * gridDim.x; env < launch_.environments;
         env += warps * gridDim.x)
      Warp{}.one([&] { between(env); });
    sync_block();
  }

  // Particles and grids of all environments to substep s. Returns whether there is one that still moves.
  __device__ bool move_all(int s) {
    bool any = false;
    fetch(blockIdx.x, s);
    for (std::int64_t env = blockIdx.x; env < launch_.environments; env += gridDim.x)
      any = move(env, s) || any;
    return any;
  }
  // A coupling has put the grid of an environment by. Begins to bring it back: the grid that is here has been gathered.
  __device__ void fetch(std::int64_t env, int s) const {
    if constexpr (Coupling::any)
      if (s > 0 && env < launch_.environments && launch_.records[env].moves)
        arena_.velocity.begin_copy(after_forces(env).velocity, arena_.count);
  }
  // Between two calls, sums are zero; in a scene without coupling, the grid stays, else that of the next is on its way.
  __device__ bool move(std::int64_t env, int s) {
    Record& record = launch_.records[env];
    StepControl const control{launch_.step.fields(env)};
    Met met;
    bool const scattered = s == 0 && begin(env, control, record, met);
    if (!record.moves) {
      fetch(env + gridDim.x, s);
      return false;
    }
    auto const clock = record.clock;
    auto const unit = record.fixed_point();
    auto const before = record.at(s - 1), now = record.at(s);
    auto const grid = after_forces(env);
    if (Coupling::any && s > 0) {
      arena_.velocity.end_copy();
      sync_block();
      move_items(launch_, env, arena_.velocity, s - 1);
    }
    Passes const passes{launch_.step, arena_, unit};
    if (s == 0 && !scattered)
      each_particle(env, [&](std::int64_t i) { passes.scatter(i, now, met); });
    else if (s > 0 && s < clock.substeps)
      each_particle(env, [&](std::int64_t i) { passes.gather_and_scatter(i, before, now, met); });
    else if (s > 0)
      each_particle(env, [&](std::int64_t i) { passes.gather(i, before, met); });
    if (s > 0) record.note(met.now, s - 1);
    record.note(met.next, s);
    sync_block();
    if constexpr (!Coupling::any) {
      close(BlockTeam{}, record, control, s);
      if (!record.moves) {
        arena_.clear_sums();
        sync_block();
        return false;
      }
    }
    fetch(env + gridDim.x, s);
    if (s < clock.substeps) record.note(move_nodes<Move>(grid, Run{0, arena_.count}, now, unit), s);
    sync_block();
    return true;
  }
  template <class F>
  __device__ __forceinline__ void each_particle(std::int64_t env, F const& f) const {
    std::int64_t const first = launch_.step.first_particle(env);
    Run{0, launch_.step.live_particles(env)}.each([&](int slot) { f(first + slot); });
  }
  // Counts what the substep before s has met, and ends the step where that was the last or the environment is lost.
  template <class Team_, class Control>
  __device__ static void close(Team_ const& team, Record& record, Control const& control, int s) {
    if (s > 0) record.note(lost_bodies(team, control.env), s - 1);
    team.sync();
    team.one([&] { record.close_before(control, s); });
    team.sync();
  }
  // Told little: see couple().
  __device__ __noinline__ static void move_items(ResidentLaunch<Scene> const& launch,
                                                 std::int64_t env, Velocities<float> nodes, int s) {
    Run const all{0, Coupling::items(launch.step, env)};
    Coupling::run_items(launch.step, env, nodes, launch.records[env].at(s), all);
  }
  // Bounds of the present state, and with them the substeps of this step. Particles come from the memory of the device,
  // and that takes the time: where the step is expected to be like the one before, they are scattered in the same visit,
  // unless that changes what is stored of them. Returns whether that holds.
  template <class Control>
  __device__ bool begin(std::int64_t env, Control const& control, Record& record, Met& met) {
    if (threadIdx.x == 0) {
      record.expect(control, launch_.step);
      record.open(control, launch_.step.moves(env), launch_.step.lattice);
      found_ = {};
    }
    sync_block();
    if (!record.moves) return false;
    constexpr bool leaves_particles = Passes::Scattering::Keeps::count == 0;
    bool const early = leaves_particles && record.expected.substeps > 0;
    Run const all{0, launch_.step.live_particles(env)};
    auto mine = early ? look_and_scatter(env, record, met)
                      : look_at_particles(launch_.step, env, all, record.context);
    mine.held |= lost_bodies(BlockTeam{}, control.env);
    found_.include(mine);
    sync_block();
    if (threadIdx.x == 0) {
      record.found = found_;
      record.choose(control, launch_.step);
    }
    sync_block();
    bool const holds = early && record.moves && record.as_expected();
    if (early && !holds) {
      met = {};
      arena_.clear_sums();
      sync_block();
    }
    return holds;
  }
  __device__ Found look_and_scatter(std::int64_t env, Record const& record, Met& met) {
    Passes const passes{launch_.step, arena_, record.expected_fixed_point()};
    ParticleLook<Scene, float> const look(launch_.step);
    auto const now = record.at(0);
    Found found;
    each_particle(env, [&](std::int64_t i) { passes.look_and_scatter(i, now, look, found, met); });
    return found;
  }
  // Where the velocities of an environment are until its particles gather them; sums are the block's.
  __device__ Arena<float> after_forces(std::int64_t env) const {
    if constexpr (Coupling::any)
      return {{launch_.grids + env * arena_.count}, arena_.sums, arena_.count};
    else
      return arena_;
  }

  // The couplings of substep s; teams take the place of the grid.
  __device__ void couple_all(int s) {
    PartOfBlock const team(launch_.log2_of_team);
    int const number = team.number();
    if (number < launch_.teams)
      for (std::int64_t env = blockIdx.x + number * static_cast<std::int64_t>(gridDim.x);
           env < launch_.environments; env += launch_.teams * static_cast<std::int64_t>(gridDim.x))
        couple(launch_, team, env, s,
               reinterpret_cast<char*>(arena_.velocity.data) + number * launch_.step.fast_bytes);
    sync_block();
    arena_.clear_sums();
    sync_block();
  }
  // A function of its own, told little: what its call takes must not crowd the particles' registers.
  __device__ __noinline__ static void couple(ResidentLaunch<Scene> const& launch,
                                             PartOfBlock const& team, std::int64_t env, int s,
                                             char* fast) {
    Record& record = launch.records[env];
    if (!record.moves) return;
    StepControl const control{launch.step.fields(env)};
    Velocities<float> const nodes{launch.grids + env * launch.step.lattice.count()};
    if (s > 0)
      record.note(Coupling::template run_apart<typename Coupling::After>(
                      team, launch.step, env, nodes, record.at(team, s - 1), fast),
                  s - 1);
    close(team, record, control, s);
    if (record.moves)
      record.note(Coupling::template run_apart<typename Coupling::Before>(
                      team, launch.step, env, nodes, record.at(team, s), fast),
                  s);
  }

  ResidentLaunch<Scene> const& launch_;
  Arena<float> arena_;
  Found& found_;
};

// Where a launch is one step.
struct NothingBetween {
  __device__ void operator()(std::int64_t) const {}
};

// Steps of every environment: blocks do not wait for each other between two. 512 threads leave 128 registers: no spills in
// the loop.
template <class Scene, int threads, class Between>
__global__ void __launch_bounds__(threads, 1)
    step(__grid_constant__ ResidentLaunch<Scene> const launch, int steps,
         __grid_constant__ Between const between) {
  alignas(16) extern __shared__ char dynamic_shared_memory[];
  ResidentBlock<Scene>(launch, dynamic_shared_memory).run(steps, between);
}

// The host's side: memory, and the launch.
template <class Scene, int most_threads> class ResidentSteps {
  using Record = StepRecord<Scene, float>;
  static constexpr bool couples = detail::couples<Scene>;

 public:
  static constexpr int most_teams = 8;

  static std::int64_t shared_bytes(std::int64_t nodes) {
    return ResidentBlock<Scene>::shared_bytes(nodes);
  }
  static std::size_t bytes(std::int64_t environments, std::int64_t nodes) {
    auto const grids = couples ? environments * nodes : 0;
    return grids_at(environments) + static_cast<std::size_t>(grids) * sizeof(float4);
  }
  ResidentSteps() = default;
  ResidentSteps(std::int64_t environments, std::int64_t nodes, cudaStream_t stream)
      : environments_(environments),
        grid_bytes_(shared_bytes(nodes)),
        memory_(bytes(environments, nodes)) {
    // Records are copied as a whole, with what no step has written yet.
    require(cudaMemsetAsync(memory_.as(), 0, grids_at(environments), stream), "clearing records");
  }

  // Lets blocks have so much shared memory on the present device.
  static void reserve(std::int64_t bytes);

  // With blocks of so many threads on a device with so many multiprocessors, each of which has `limit` bytes of shared
  // memory to give. Teams get what is left of step.fast_bytes each.
  void run(Launch<Scene, float> const& step, int threads, std::int64_t processors,
           std::int64_t limit, cudaStream_t stream) const;
  // Several steps in one launch. Between two, a thread calls between(env) for every environment. Its kernel is compiled where it
  // is called.
  template <class Between>
  void run_at_once(Launch<Scene, float> const& step, int steps, Between const& between, int threads,
                   std::int64_t processors, std::int64_t limit, cudaStream_t stream) const {
    reserve_shared(cuda::step<Scene, most_threads, Between>, limit);
    launch(step, steps, between, threads, processors, limit, stream);
  }

 private:
  template <class Between>
  void launch(Launch<Scene, float> step, int steps, Between const& between, int threads,
              std::int64_t processors, std::int64_t limit, cudaStream_t stream) const {
    auto const blocks = couples ? std::min(environments_, processors) : environments_;
    auto const teams = teams_for((environments_ + blocks - 1) / blocks, threads);
    auto const shared = std::clamp(teams * step.fast_bytes, grid_bytes_, limit);
    step.fast_bytes = shared / teams / 16 * 16;
    auto const of_team = static_cast<unsigned>(threads / teams);  // at least a warp
    ResidentLaunch<Scene> const all{step,
                                    environments_,
                                    static_cast<int>(teams),
                                    static_cast<int>(std::bit_width(of_team)) - 1,
                                    memory_.as<Record>(),
                                    memory_.as<float4>(grids_at(environments_))};
    start(stream, "a step", cuda::step<Scene, most_threads, Between>, blocks, threads,
          static_cast<std::size_t>(shared), all, steps, between);
  }
  static std::size_t grids_at(std::int64_t environments) {
    return (static_cast<std::size_t>(environments) * sizeof(Record) + 255) / 256 * 256;
  }

  // As many as can be at work at once, and no more than so many turns need.
  static std::int64_t teams_for(std::int64_t carried, int threads) {
    auto const at_once = std::min<std::int64_t>(most_teams, threads / Warp::size);
    auto const turns = (carried + at_once - 1) / at_once;
    return (carried + turns - 1) / turns;
  }

  std::int64_t environments_ = 0, grid_bytes_ = 0;
  Memory memory_;
};

// Not inline, so that `extern template` keeps the kernel to one source.
template <class Scene, int most_threads>
void ResidentSteps<Scene, most_threads>::reserve(std::int64_t bytes) {
  reserve_shared(cuda::step<Scene, most_threads, NothingBetween>, bytes);
}
template <class Scene, int most_threads>
void ResidentSteps<Scene, most_threads>::run(Launch<Scene, float> const& step, int threads,
                                             std::int64_t processors, std::int64_t limit,
                                             cudaStream_t stream) const {
  launch(step, 1, NothingBetween{}, threads, processors, limit, stream);
}

}  // namespace mpmpbd::cuda
