// Resident execution: one thread block holds the grid of one environment in shared memory and runs all substeps of
// a step in one launch: scatter, (n - 1) x fused gather and scatter, gather.
//
// Stages are the scene's own. A coupling is carried out by the first threads of the block; as soon as it says
// which nodes it may change, the others take the particles that see none of them. Sums are integers, so bits do
// not depend on who came first.
//
// Limits: float; no FLIP (its grid would need twice the memory).
#pragma once

#include <mpmpbd/backend/cuda/near_cells.cuh>
#include <mpmpbd/backend/cuda/tables.cuh>
#include <mpmpbd/backend/cuda/team.cuh>
#include <mpmpbd/scene/step_bounds.hpp>
#include <mpmpbd/scene/step_control.hpp>

namespace mpmpbd::cuda {

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
// The same of one stage alone.
template <class Stage> struct Single {
  using Reads = on_t<typename Stage::Reads, Particles>;
  using Keeps = stored_t<on_t<typename Stage::Writes, Particles>>;
  using Used = union_t<Reads, on_t<typename Stage::Writes, Particles>>;
  using Loads = stored_t<Reads>;
};

// What a step of a scene is launched with.
template <class Scene> struct Launch {
  TablesOf<Scene, float> tables;
  Lattice<float> lattice;
  double h;  // length of the step [s]
  SubstepChoice choice;
  unsigned char const* mask;  // null: every environment moves, else those where it is not 0
  char* scratch;              // of the coupling, per environment
  std::int64_t scratch_stride;
  int* slot_of_node;  // of the coupling, per environment and node; -1 between two exchanges
  int* waiting;       // per environment and slot of a particle
};

// What the threads of a block share beside the grid.
template <class Scene> struct Shared {
  Context<float, typename Scene::Policies> context;
  StepClock<float> clock;
  StepBounds<float> bounds;
  float heaviest, lightest;  // particle [kg]
  unsigned met[2];           // faults, by substeps: even, odd
  int taken;                 // chunks of particles that have been
  int waiting;               // particles that wait for the coupling
  bool frozen;
};

namespace detail {
// Stages over the whole environment, and whether the rest of the block may go on meanwhile: those that change
// nodes must say which (announces_nodes).
template <class Stages> struct TogetherOf;
template <class... Ss> struct TogetherOf<TypeList<Ss...>> {
  template <class S>
  static constexpr bool is_together = std::is_same_v<typename S::Kind, kind::Together>;
  template <class S> static consteval bool may_overlap() {
    if constexpr (!is_together<S> || !contains<typename S::Writes, node::Velocity>)
      return true;
    else if constexpr (requires { S::announces_nodes; })
      return S::announces_nodes;
    else
      return false;
  }
  using type = join_t<std::conditional_t<is_together<Ss>, TypeList<Ss>, TypeList<>>...>;
  static constexpr bool overlap = (may_overlap<Ss>() && ...) && type::size > 0;
};

__device__ inline void raise(float& to, float value) {  // neither is negative
  atomicMax(reinterpret_cast<int*>(&to), __float_as_int(value));
}
__device__ inline void lower(float& to, float value) {
  atomicMin(reinterpret_cast<int*>(&to), __float_as_int(value));
}
}  // namespace detail

// Runs one environment on this block.
template <class Scene> class ResidentBlock {
  using In = typename Scene::In;
  using Body = typename In::Body;
  using Shape = typename Body::Shape;
  using Ctx = Context<float, typename Scene::Policies>;
  using P2G = ParticlesToGrid<Body, typename In::Effects>;
  using G2P = GridToParticles<Body, typename In::Effects>;
  using Move = MoveNodes<Body, typename In::Effects>;
  using Together = detail::TogetherOf<typename Scene::Substep::Stages>;
  using Near = NearCells<Shape>;
  using Nodes_ = NodesOfArena<Move, Ctx, Shape>;
  static constexpr int team_size = 128;
  using Team_ = std::conditional_t<Together::overlap, FirstThreads<team_size>, BlockTeam>;

 public:
  static constexpr int fewest_threads = team_size;

  MPMPBD_HD static constexpr std::int64_t shared_bytes(std::int64_t nodes) {
    return Arena::bytes(nodes) + Near::bytes(nodes) + 16 +
           static_cast<std::int64_t>(sizeof(Shared<Scene>));
  }

  __device__ ResidentBlock(Launch<Scene> const& launch, char* memory)
      : launch_(launch),
        memory_(memory),
        arena_(Arena::at(memory, static_cast<int>(launch.lattice.count()))),
        near_{reinterpret_cast<unsigned*>(memory + Arena::bytes(arena_.count)), launch.lattice},
        shared_(shared_part(memory, arena_.count)),
        live_(static_cast<int>(particles().live[blockIdx.x])) {}

  __device__ void step() {
    if (launch_.mask != nullptr && launch_.mask[blockIdx.x] == 0) return;
    StepControl const control{fields(launch_)};
    if (control.frozen()) return;
    begin(control);
    __syncthreads();
    auto const clock = shared_.clock;
    if (shared_.frozen) {
      if (threadIdx.x == 0) control.finish(clock, 0);
      return;
    }
    Ctx const& context = shared_.context;
    unit_ = FixedPoint::make(shared_.heaviest, context.lattice.dx, clock.dt);
    arena_.clear_sums();
    __syncthreads();
    scatter(at(context, clock, 0));
    int done = 0;
    for (; done < clock.substeps; ++done) {
      __syncthreads();
      if (done > 0) close(control, done - 1);
      near_.clear();
      Ctx const now = at(context, clock, done);
      note(move_nodes<Move>(arena_, now, unit_), done);
      __syncthreads();
      if (shared_.frozen) break;
      if (done + 1 < clock.substeps)
        advance<Fused<G2P, P2G>>(done, [&](auto& p, unsigned& met, unsigned& next) {
          met |= G2P::run(p, VelocitiesOfArena{arena_, launch_.lattice}, now);
          next |= P2G::run(p, SumsOfArena{arena_, launch_.lattice, unit_},
                           at(context, clock, done + 1));
        });
      else
        advance<Single<G2P>>(done, [&](auto& p, unsigned& met, unsigned&) {
          met |= G2P::run(p, VelocitiesOfArena{arena_, launch_.lattice}, now);
        });
    }
    __syncthreads();
    if (!shared_.frozen) close(control, done - 1);
    if (threadIdx.x == 0) control.finish(clock, done);
  }

 private:
  __device__ static Shared<Scene>& shared_part(char* memory, std::int64_t nodes) {
    auto const used = Arena::bytes(nodes) + Near::bytes(nodes);
    return *reinterpret_cast<Shared<Scene>*>(memory + (used + 15) / 16 * 16);
  }
  // Fields of this environment are made where they are used: kept, their many pointers would crowd the registers.
  __device__ static auto fields(Launch<Scene> const& launch) {
    return launch.tables.environment(blockIdx.x);
  }
  __device__ auto const& particles() const { return launch_.tables.template of<Particles>(); }
  __device__ std::int64_t first() const { return blockIdx.x * particles().view.capacity; }

  __device__ static Ctx at(Ctx context, StepClock<float> const& clock, int s) {
    context.tick = clock.tick(s);
    return context;
  }

  // Bounds of the present state, and with them the substeps of this step.
  template <class Control> __device__ void begin(Control const& control) {
    if (threadIdx.x == 0) {
      shared_.context = load_context<typename Scene::Policies>(control.env, launch_.lattice);
      shared_.bounds = {};
      shared_.heaviest = 0.0f;
      shared_.lightest = infinity<float>;
      shared_.met[0] = shared_.met[1] = 0;
      shared_.frozen = false;
    }
    __syncthreads();
    unsigned held = 0, faults = 0;
    measure(held, faults);
    if (held != 0) atomicOr(&shared_.met[0], held);
    if (faults != 0) atomicOr(&shared_.met[1], faults);
    __syncthreads();
    if (threadIdx.x != 0) return;
    shared_.bounds.speed =
        max(shared_.bounds.speed, needle_speed<Scene>(control.env, shared_.context));
    control.meet(shared_.met[0] | lost_bodies(control.env));
    control.meet(shared_.met[1]);
    if (shared_.heaviest > FixedPoint::greatest_contrast * shared_.lightest)
      control.meet(static_cast<std::uint32_t>(Fault::overflow));
    auto const limit = step_limit<Body>(shared_.bounds, launch_.lattice.dx);
    shared_.clock = control.begin(limit, launch_.h, launch_.choice);
    shared_.met[0] = shared_.met[1] = 0;
    shared_.frozen = control.frozen();
  }
  __device__ void measure(unsigned& held, unsigned& faults) const {
    using Bounds = ParticleBounds<Scene>;
    auto const& view = particles().view;
    Room<float> room[3];
    for (int a = 0; a < 3; ++a) room[a] = Room<float>::template on_axis<Shape>(launch_.lattice, a);
    Ctx const context = shared_.context;
    StepBounds<float> all;
    float heaviest = 0.0f, lightest = infinity<float>;
    for (int slot = static_cast<int>(threadIdx.x); slot < live_;
         slot += static_cast<int>(blockDim.x)) {
      Local<float, union_t<typename Bounds::Used, Fields<particle::Mass, particle::Position>>> p;
      p.load(view, first() + slot,
             union_t<typename Bounds::Reads, Fields<particle::Mass, particle::Position>>{});
      bool moved = false;
      for (int a = 0; a < 3; ++a) moved = room[a].hold(p[particle::Position{}][a]) || moved;
      if (moved) {
        p.store(view, first() + slot, Fields<particle::Position>{});
        held |= static_cast<unsigned>(Fault::escape);
      }
      faults |= Bounds::include(p, context, SharesDoNotMatter{}, all);
      heaviest = max(heaviest, p[particle::Mass{}]);
      lightest = min(lightest, p[particle::Mass{}]);
    }
    detail::raise(shared_.bounds.frequency2, all.frequency2);
    detail::raise(shared_.bounds.damping, all.damping);
    detail::raise(shared_.bounds.speed, all.speed);
    detail::raise(shared_.bounds.rate, all.rate);
    detail::raise(shared_.heaviest, heaviest);
    detail::lower(shared_.lightest, lightest);
  }

  // What substep s has met; thread 0 also gets the counters of the next one ready.
  template <class Control> __device__ void close(Control const& control, int s) {
    if (threadIdx.x != 0) return;
    control.meet(shared_.met[s & 1] | lost_bodies(control.env));
    shared_.met[s & 1] = 0;
    shared_.frozen = control.frozen();
  }
  __device__ void note(unsigned faults, int s) const {
    if (faults != 0) atomicOr(&shared_.met[s & 1], faults);
  }

  __device__ void scatter(Ctx const& context) {
    unsigned met = 0;
    for (int slot = static_cast<int>(threadIdx.x); slot < live_;
         slot += static_cast<int>(blockDim.x))
      particle<Single<P2G>>(slot, [&](auto& p) {
        met |= P2G::run(p, SumsOfArena{arena_, launch_.lattice, unit_}, context);
      });
    if (threadIdx.x == 0) shared_.taken = shared_.waiting = 0;
    note(met, 0);
  }

  // Coupling and particles of substep s.
  template <class Pass, class Function> __device__ void advance(int s, Function const& f) {
    unsigned met = 0, next = 0;
    auto const one = [&](int slot) { particle<Pass>(slot, [&](auto& p) { f(p, met, next); }); };
    if constexpr (Together::overlap) {
      if (threadIdx.x < team_size)
        met |= couple(launch_, memory_, s);
      else
        Nodes_::meet_others();
      take_particles(one);
    } else {
      if constexpr (Together::type::size > 0) {
        met |= couple(launch_, memory_, s);
        __syncthreads();
      }
      for (int slot = static_cast<int>(threadIdx.x); slot < live_;
           slot += static_cast<int>(blockDim.x))
        one(slot);
    }
    note(met, s);
    note(next, s + 1);
  }

  // A function of its own, told little: what it keeps in registers must not crowd the particles'.
  __device__ __noinline__ static std::uint32_t couple(Launch<Scene> const& launch, char* memory,
                                                      int s) {
    auto const arena = Arena::at(memory, static_cast<int>(launch.lattice.count()));
    auto const& shared = shared_part(memory, arena.count);
    Ctx const context = at(shared.context, shared.clock, s);
    bool announced = !Together::overlap;
    Nodes_ const nodes{
        arena,
        context,
        launch.scratch + blockIdx.x * launch.scratch_stride,
        launch.slot_of_node + blockIdx.x * static_cast<std::int64_t>(arena.count),
        Near{reinterpret_cast<unsigned*>(memory + Arena::bytes(arena.count)), launch.lattice},
        announced};
    auto const faults = run_all(fields(launch), nodes, context, typename Together::type{});
    if constexpr (Together::overlap) nodes.let_others_go();
    return faults;
  }
  template <class Env, class... Stages>
  __device__ static std::uint32_t run_all(Env const& env, Nodes_ const& nodes, Ctx const& context,
                                          TypeList<Stages...>) {
    return (Stages::run(Team_{}, env, context, nodes) | ... | 0u);
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
        there && near_.has(particles().view.template get<particle::Position>(first() + slot));
    unsigned const all = __ballot_sync(0xffffffffu, waits);
    int first = 0;
    if (lane == 0 && all != 0) first = atomicAdd(&shared_.waiting, __popc(all));
    first = __shfl_sync(0xffffffffu, first, 0);
    if (waits) waiting[first + __popc(all & ((1u << lane) - 1u))] = slot;
    return there && !waits ? slot : later;
  }

  template <class Pass, class Function>
  __device__ __forceinline__ void particle(int slot, Function const& f) const {
    auto const& view = particles().view;
    Local<float, typename Pass::Used> p;
    p.load(view, first() + slot, typename Pass::Loads{});
    f(p);
    p.store(view, first() + slot, typename Pass::Keeps{});
  }

  Launch<Scene> const& launch_;
  char* memory_;
  Arena arena_;
  Near near_;
  Shared<Scene>& shared_;
  int live_;
  FixedPoint unit_{};
};

// One step of every environment, a block each. 512 threads leave 128 registers: no spills in the loop.
template <class Scene, int threads>
__global__ void __launch_bounds__(threads, 1) step(__grid_constant__ Launch<Scene> const launch) {
  alignas(16) extern __shared__ char dynamic_shared_memory[];
  ResidentBlock<Scene>(launch, dynamic_shared_memory).step();
}

}  // namespace mpmpbd::cuda
