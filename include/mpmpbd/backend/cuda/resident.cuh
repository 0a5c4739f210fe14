// Resident execution: a thread block holds the grid of an environment in its shared memory, and all substeps of a step are
// one launch: scatter, (n - 1) x fused gather and scatter, gather.
//
// A coupling is a long row of short stages, each waiting for the one before. So a block of a scene with one carries
// several environments, and has two kinds of threads: those that move particles and grids, one environment after the other,
// and teams of a few that couple, each one environment, beside them. An environment goes to and fro between the two
// (Progress). What of a coupling goes item by item is done by those that move, when the grid is in shared memory again, and
// what comes after it by the team, before the next coupling. Where a block carries one environment alone, nothing could go
// on beside it, and all threads do both in turns.
//
// Stages are the scene's own. Sums are integers, so bits depend neither on who came first nor on who shares a block.
//
// Limits: float (shared memory adds 64-bit integers in a loop); no FLIP (its grid would need twice the memory).
#pragma once

#include <algorithm>

#include <mpmpbd/backend/cuda/couple.cuh>
#include <mpmpbd/backend/cuda/memory.cuh>
#include <mpmpbd/backend/cuda/passes.cuh>

namespace mpmpbd::cuda {

template <class Scene> struct ResidentLaunch {
  Launch<Scene, float> step;
  std::int64_t environments;
  int movers, teams, threads_of_team;  // of a block, in whole warps; movers come first
  int carried;                         // environments of a block that go to and fro; 0 in turns
  StepRecord<Scene, float>* records;   // per environment
  float4* grids;  // with a coupling: velocities after forces, per environment and node

  // Whether the same threads move and couple.
  MPMPBD_HD bool takes_turns() const { return carried == 0; }
};

// Of the shared memory of a block: what is found in an environment, how far those that it carries have come, and from `end`
// on what is free beside the grid.
struct ResidentLayout {
  std::int64_t found, moved, coupled, end;

  MPMPBD_HD static ResidentLayout of(std::int64_t nodes, std::int64_t carried) {
    auto const aligned = [](std::int64_t n) { return (n + 15) / 16 * 16; };
    auto const list = carried * static_cast<std::int64_t>(sizeof(Progress));
    ResidentLayout l{};
    l.found = aligned(Arena<float>::bytes(nodes));
    l.moved = aligned(l.found + static_cast<std::int64_t>(sizeof(Findings<float>)));
    l.coupled = l.moved + list;
    l.end = aligned(l.coupled + list);
    return l;
  }
};

// Runs the environments of this block.
template <class Scene> class ResidentBlock {
  using In = typename Scene::In;
  using Move = MoveNodes<typename In::Body, typename In::Effects>;
  using Coupling = Couple<Scene, float>;
  using Passes = ParticlePasses<Scene, float>;
  using Record = StepRecord<Scene, float>;
  using Found = Findings<float>;

 public:
  __device__ ResidentBlock(ResidentLaunch<Scene> const& launch, char* memory)
      : launch_(launch),
        layout_(ResidentLayout::of(launch.step.lattice.count(), launch.carried)),
        memory_(memory),
        arena_(Arena<float>::at(memory, static_cast<int>(launch.step.lattice.count()))),
        movers_(0, launch.movers, 0) {}

  __device__ void step() {
    arena_.clear_sums();
    Run::by_all(0, launch_.carried).each([&](int e) { moved()[e].steps = coupled()[e].steps = 0; });
    __syncthreads();
    if (movers_.rank() < launch_.movers) {
      for (int s = 0; move_all(s); ++s)
        if (Coupling::any && launch_.takes_turns()) couple_in_turn(s);
    } else if constexpr (Coupling::any) {
      couple_beside((movers_.rank() - launch_.movers) / launch_.threads_of_team);
    }
  }

 private:
  static constexpr int stopped = 1 << 30;  // more steps than there are

  __device__ Found& found() const { return *reinterpret_cast<Found*>(memory_ + layout_.found); }
  __device__ Progress* moved() const {
    return reinterpret_cast<Progress*>(memory_ + layout_.moved);
  }
  __device__ Progress* coupled() const {
    return reinterpret_cast<Progress*>(memory_ + layout_.coupled);
  }
  // Environment `number` of those that this block carries.
  __device__ std::int64_t environment(int number) const {
    return blockIdx.x + number * static_cast<std::int64_t>(gridDim.x);
  }

  // Particles and grids of all environments to substep s. Returns whether there is one that still moves.
  __device__ bool move_all(int s) {
    bool const beside = Coupling::any && !launch_.takes_turns();
    bool any = false;
    for (int e = 0; environment(e) < launch_.environments; ++e) {
      if (beside && s > 0) coupled()[e].wait_for(movers_, s);
      any = move(environment(e), s) || any;
      if (beside) moved()[e].set(movers_, s + 1);
    }
    return any;
  }
  // Between two calls, sums are zero; in a scene without coupling, the grid stays.
  __device__ bool move(std::int64_t env, int s) {
    Record& record = launch_.records[env];
    StepControl const control{launch_.step.fields(env)};
    if (s == 0) begin(env, control, record);
    if (!record.moves) return false;
    auto const clock = record.clock;
    auto const unit = record.fixed_point();
    auto const before = record.at(s - 1), now = record.at(s);
    auto const grid = after_forces(env);
    if (Coupling::any && s > 0) {
      arena_.velocity.copy(grid.velocity, arena_.count, launch_.movers);
      movers_.sync();
      move_items(launch_, env, arena_.velocity, s - 1);
    }
    Passes const passes{launch_.step, arena_, unit};
    Met met;
    auto const all = [&](auto const& f) {
      std::int64_t const first = launch_.step.first_particle(env);
      share(launch_.step.live_particles(env)).each([&](int slot) { f(first + slot); });
    };
    if (s == 0)
      all([&](std::int64_t i) { passes.scatter(i, now, met); });
    else if (s < clock.substeps)
      all([&](std::int64_t i) { passes.gather_and_scatter(i, before, now, met); });
    else
      all([&](std::int64_t i) { passes.gather(i, before, met); });
    if (s > 0) record.note(met.now, s - 1);
    record.note(met.next, s);
    movers_.sync();
    if constexpr (!Coupling::any) {
      close(movers_, record, control, s);
      if (!record.moves) {
        arena_.clear_sums();
        movers_.sync();
        return false;
      }
    }
    if (s < clock.substeps) record.note(move_nodes<Move>(grid, share(arena_.count), now, unit), s);
    movers_.sync();
    return true;
  }
  __device__ Run share(int count) const { return {0, count, launch_.movers}; }
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
    Run const all{0, Coupling::items(launch.step, env), launch.movers};
    Coupling::run_items(launch.step, env, nodes, launch.records[env].at(s), all);
  }
  // Bounds of the present state, and with them the substeps of this step.
  template <class Control>
  __device__ void begin(std::int64_t env, Control const& control, Record& record) {
    movers_.one([&] {
      record.open(control, launch_.step.moves(env), launch_.step.lattice);
      found() = {};
    });
    movers_.sync();
    if (!record.moves) return;
    auto const context = record.context;
    Found mine = look_at_particles(launch_.step, env, share(launch_.step.live_particles(env)),
                                   context);
    mine.held |= lost_bodies(movers_, control.env);
    found().include(mine);
    movers_.sync();
    movers_.one([&] {
      record.found = found();
      record.choose(control, launch_.step);
    });
    movers_.sync();
  }
  // Where the velocities of an environment are until its particles gather them; sums are the block's.
  __device__ Arena<float> after_forces(std::int64_t env) const {
    if constexpr (Coupling::any)
      return {{launch_.grids + env * arena_.count}, arena_.sums, arena_.count};
    else
      return arena_;
  }

  // The couplings of substep s by all threads, which take the place of the grid.
  __device__ void couple_in_turn(int s) {
    for (int e = 0; environment(e) < launch_.environments; ++e) {
      movers_.sync();
      couple(launch_, movers_, environment(e), s, memory_);
    }
    movers_.sync();
    arena_.clear_sums();
    movers_.sync();
  }
  // All couplings of the environments that are this team's, each when its particles have moved.
  __device__ void couple_beside(int number) {
    if (number >= launch_.teams) return;
    int const threads = launch_.threads_of_team;
    PartOfBlock const team(launch_.movers + number * threads, threads, number + 1);
    char* const fast = memory_ + layout_.end + number * launch_.step.fast_bytes;
    bool any = true;
    for (int s = 0; any; ++s) {
      any = false;
      for (int e = number; environment(e) < launch_.environments; e += launch_.teams) {
        bool const& moves = launch_.records[environment(e)].moves;
        if (s > 0 && !moves) continue;
        moved()[e].wait_for(team, s + 1);
        couple(launch_, team, environment(e), s, fast);
        any = any || moves;
        coupled()[e].set(team, moves ? s + 1 : stopped);
      }
    }
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
      record.note(Coupling::template run<typename Coupling::After>(team, launch.step, env, nodes,
                                                                   record.at(s - 1), fast),
                  s - 1);
    close(team, record, control, s);
    if (record.moves)
      record.note(Coupling::template run<typename Coupling::Before>(team, launch.step, env, nodes,
                                                                    record.at(s), fast),
                  s);
  }

  ResidentLaunch<Scene> const& launch_;
  ResidentLayout layout_;
  char* memory_;
  Arena<float> arena_;
  PartOfBlock movers_;
};

// One step of every environment. 512 threads leave 128 registers: no spills in the loop.
template <class Scene, int threads>
__global__ void __launch_bounds__(threads, 1)
    step(__grid_constant__ ResidentLaunch<Scene> const launch) {
  alignas(16) extern __shared__ char dynamic_shared_memory[];
  ResidentBlock<Scene>(launch, dynamic_shared_memory).step();
}

// The host's side: memory, and the launch.
template <class Scene, int most_threads> class ResidentSteps {
  using Record = StepRecord<Scene, float>;
  static constexpr bool couples = detail::couples<Scene>;

 public:
  static constexpr int most_teams = 4;
  static constexpr int threads_of_team = 32;

  static std::int64_t shared_bytes(std::int64_t nodes) {
    return ResidentLayout::of(nodes, 0).end;
  }
  static std::size_t bytes(std::int64_t environments, std::int64_t nodes) {
    auto const grids = couples ? environments * nodes : 0;
    return grids_at(environments) + static_cast<std::size_t>(grids) * sizeof(float4);
  }
  ResidentSteps() = default;
  ResidentSteps(std::int64_t environments, std::int64_t nodes, cudaStream_t stream)
      : environments_(environments),
        nodes_(nodes),
        memory_(bytes(environments, nodes)) {
    // Records are copied as a whole, with what no step has written yet.
    require(cudaMemsetAsync(memory_.as(), 0, grids_at(environments), stream), "clearing records");
  }

  // Lets blocks have so much shared memory on the present device.
  static void reserve(std::int64_t bytes);

  // With blocks of so many threads on a device with so many multiprocessors, each of which has `limit` bytes of shared
  // memory to give. Teams get what is left of step.fast_bytes each.
  void run(Launch<Scene, float> step, int threads, std::int64_t processors, std::int64_t limit,
           cudaStream_t stream) const;

 private:
  static std::size_t grids_at(std::int64_t environments) {
    return (static_cast<std::size_t>(environments) * sizeof(Record) + 255) / 256 * 256;
  }

  std::int64_t environments_ = 0, nodes_ = 0;
  Memory memory_;
};

// Not inline, so that `extern template` keeps the kernel to one source.
template <class Scene, int most_threads>
void ResidentSteps<Scene, most_threads>::reserve(std::int64_t bytes) {
  require(
      cudaFuncSetAttribute(cuda::step<Scene, most_threads>,
                           cudaFuncAttributeMaxDynamicSharedMemorySize, static_cast<int>(bytes)),
      "reserving shared memory for a program of this architecture");
}
template <class Scene, int most_threads>
void ResidentSteps<Scene, most_threads>::run(Launch<Scene, float> step, int threads,
                                             std::int64_t processors, std::int64_t limit,
                                             cudaStream_t stream) const {
  auto const blocks = couples ? std::min(environments_, processors) : environments_;
  auto const carried = (environments_ + blocks - 1) / blocks;
  int const couplers = most_teams * threads_of_team;
  auto layout = ResidentLayout::of(nodes_, carried);
  bool const beside = couples && carried > 1 && threads > couplers && layout.end <= limit;
  if (!beside) layout = ResidentLayout::of(nodes_, 0);
  // Who couples beside the particles has the shared memory that their grid leaves, else all of it.
  auto const teams = beside ? std::min<std::int64_t>(carried, most_teams) : 1;
  auto const first = beside ? layout.end : 0;
  auto const shared = std::clamp(first + teams * step.fast_bytes, layout.end, limit);
  step.fast_bytes = (shared - first) / teams / 16 * 16;
  ResidentLaunch<Scene> const launch{step,
                                     environments_,
                                     beside ? threads - couplers : threads,
                                     static_cast<int>(teams),
                                     threads_of_team,
                                     beside ? static_cast<int>(carried) : 0,
                                     memory_.as<Record>(),
                                     memory_.as<float4>(grids_at(environments_))};
  start(stream, "a step", cuda::step<Scene, most_threads>, blocks, threads,
        static_cast<std::size_t>(shared), launch);
}

}  // namespace mpmpbd::cuda
