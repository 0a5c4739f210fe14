// What a step of a scene is launched with, and what is known of an environment while its step is under way: the same
// for a grid in shared memory and one in the memory of the device.
#pragma once

#include <mpmpbd/backend/cuda/arena.cuh>
#include <mpmpbd/backend/cuda/tables.cuh>
#include <mpmpbd/backend/cuda/team.cuh>
#include <mpmpbd/scene/step_bounds.hpp>
#include <mpmpbd/scene/step_control.hpp>

namespace mpmpbd::cuda {

// Of a block, as a caller may choose them.
inline constexpr int fewest_threads = 128, most_threads = 512;
// A block announces its next round without asking whether there is one: so many bytes lie behind the last particle.
inline constexpr std::size_t announced_bytes = most_threads * sizeof(double);

template <class Scene, class T> struct Launch {
  TablesOf<Scene, T> tables;
  Lattice<T> lattice;
  double h;  // length of the step [s]
  SubstepChoice choice;
  unsigned char const* mask;  // null: every environment moves, else those where it is not 0
  char* scratch;              // of the coupling, per environment
  std::int64_t scratch_stride;
  std::int64_t fast_bytes;  // of shared memory for the team that carries out a coupling

  __device__ bool moves(std::int64_t env) const { return mask == nullptr || mask[env] != 0; }
  // Made where they are used: kept, their many pointers would crowd the registers.
  __device__ auto fields(std::int64_t env) const { return tables.environment(env); }
  __device__ auto const& particles() const { return tables.template of<Particles>(); }
  __device__ std::int64_t first_particle(std::int64_t env) const {
    return env * particles().view.capacity;
  }
  __device__ int live_particles(std::int64_t env) const {
    return static_cast<int>(particles().live[env]);
  }
};

namespace detail {
__device__ inline void raise(float& to, float value) {  // neither is negative
  atomicMax(reinterpret_cast<int*>(&to), __float_as_int(value));
}
__device__ inline void lower(float& to, float value) {
  atomicMin(reinterpret_cast<int*>(&to), __float_as_int(value));
}
__device__ inline void raise(double& to, double value) {
  atomicMax(reinterpret_cast<long long*>(&to), __double_as_longlong(value));
}
__device__ inline void lower(double& to, double value) {
  atomicMin(reinterpret_cast<long long*>(&to), __double_as_longlong(value));
}
}  // namespace detail

// What is found in an environment before it moves. None of it depends on the order of particles.
template <class T> struct Findings {
  StepBounds<T> bounds;
  T heaviest = T(0), lightest = infinity<T>;  // particle [kg]
  unsigned held = 0;                          // faults of those beyond the border, and of bodies
  unsigned faults = 0;                        // of their state

  // Threads may do so at the same time.
  __device__ void include(Findings const& f) {
    detail::raise(bounds.frequency2, f.bounds.frequency2);
    detail::raise(bounds.damping, f.bounds.damping);
    detail::raise(bounds.speed2, f.bounds.speed2);
    detail::raise(bounds.rate2, f.bounds.rate2);
    detail::raise(heaviest, f.heaviest);
    detail::lower(lightest, f.lightest);
    if (f.held != 0) atomicOr(&held, f.held);
    if (f.faults != 0) atomicOr(&faults, f.faults);
  }
};

// What is looked at in a particle.
template <class Scene, class T> class ParticleLook {
  using Shape = typename Scene::Body::Shape;
  using Bounds = ParticleBounds<Scene>;

 public:
  using Reads = union_t<typename Bounds::Reads, Fields<particle::Mass, particle::Position>>;
  using Used = union_t<typename Bounds::Used, Fields<particle::Mass, particle::Position>>;

  __device__ explicit ParticleLook(Launch<Scene, T> const& launch) : launch_(launch) {
    for (int a = 0; a < 3; ++a) room_[a] = Room<T>::template on_axis<Shape>(launch.lattice, a);
  }

  // Adds what is found in p, the particle with that index; it is put back to the border where it is beyond. Returns whether
  // its numbers are finite.
  template <class P, class Ctx>
  __device__ __forceinline__ bool at(P& p, std::int64_t index, Ctx const& context,
                                     Findings<T>& all) const {
    bool moved = false;
    for (int a = 0; a < 3; ++a) moved = room_[a].hold(p[particle::Position{}][a]) || moved;
    if (moved) {
      p.store(launch_.particles().view, index, Fields<particle::Position>{});
      all.held |= static_cast<unsigned>(Fault::escape);
    }
    unsigned const faults = Bounds::include(p, context, SharesDoNotMatter{}, all.bounds);
    all.faults |= faults;
    all.heaviest = max(all.heaviest, p[particle::Mass{}]);
    all.lightest = min(all.lightest, p[particle::Mass{}]);
    return (faults & static_cast<unsigned>(Fault::not_finite)) == 0;
  }

 private:
  Launch<Scene, T> const& launch_;
  Room<T> room_[3];
};

// What this thread finds in a run of slots.
template <class Scene, class T, class Ctx>
__device__ Findings<T> look_at_particles(Launch<Scene, T> const& launch, std::int64_t env,
                                         Run const& slots, Ctx const& context) {
  using Look = ParticleLook<Scene, T>;
  Look const look(launch);
  Findings<T> all;
  slots.each([&](int slot) {
    std::int64_t const index = launch.first_particle(env) + slot;
    Local<T, typename Look::Used> p;
    p.load(launch.particles().view, index, typename Look::Reads{});
    look.at(p, index, context, all);
  });
  return all;
}

// The step of an environment. One thread opens, chooses and closes; all may look and note.
template <class Scene, class T> struct StepRecord {
  using Ctx = Context<T, typename Scene::Physics>;
  Ctx context;
  StepClock<T> clock;
  Findings<T> found;
  unsigned met[2];  // faults, by substeps: even, odd
  bool moves;       // from the beginning of its step to the end
  bool frozen;
  // What the step will turn out to be, if it is like the one before. Saves time where it is, and is not used where not.
  struct {
    int substeps;  // 0: nothing is expected
    T heaviest;
  } expected;

  // Before open.
  template <class Control>
  __device__ void expect(Control const& control, Launch<Scene, T> const& launch) {
    expected = {control.substeps_before(), found.heaviest};
    if (!(expected.heaviest > T(0))) expected.substeps = 0;
    if (expected.substeps > 0) clock = control.clock(launch.h, expected.substeps);
  }
  __device__ bool as_expected() const {
    return clock.substeps == expected.substeps && found.heaviest == expected.heaviest;
  }
  __device__ FixedPoint<T> expected_fixed_point() const {
    return FixedPoint<T>::make(expected.heaviest, context.lattice.dx, clock.dt);
  }

  // `chosen`: whether it is to move at all.
  template <class Control>
  __device__ void open(Control const& control, bool chosen, Lattice<T> const& lattice) {
    moves = chosen && !control.frozen();
    if (!moves) return;
    context = load_context<typename Scene::Physics>(control.env, lattice);
    found = {};
    met[0] = met[1] = 0;
    frozen = false;
  }
  // The substeps of the step, from what was found.
  template <class Control>
  __device__ void choose(Control const& control, Launch<Scene, T> const& launch) {
    found.bounds.speed2 =
        max(found.bounds.speed2, square(needle_speed<Scene>(control.env, context)));
    control.meet(found.held);
    control.meet(found.faults);
    if (found.heaviest > FixedPoint<T>::greatest_contrast * found.lightest)
      control.meet(static_cast<std::uint32_t>(Fault::overflow));
    auto const limit = step_limit<typename Scene::Body>(found.bounds, launch.lattice.dx);
    clock = control.begin(limit, launch.h, launch.choice);
    frozen = control.frozen();
    if (frozen) finish(control, 0);
  }
  __device__ void note(unsigned faults, int s) {
    if (faults != 0) atomicOr(&met[s & 1], faults);
  }
  // Before substep s: counts what the one before it has met. Ends the step where that was the last, or the environment
  // is lost.
  template <class Control> __device__ void close_before(Control const& control, int s) {
    if (s > 0) {
      control.meet(met[(s - 1) & 1]);
      met[(s - 1) & 1] = 0;
      frozen = control.frozen();
    }
    if (frozen || s == clock.substeps) finish(control, s);
  }

  __device__ FixedPoint<T> fixed_point() const {
    return FixedPoint<T>::make(found.heaviest, context.lattice.dx, clock.dt);
  }
  __device__ Ctx at(int s) const { return at(context, clock, s); }
  // The same for a team, whose threads all look at it where it lies, until they meet to ask for another substep.
  template <class Team_> __device__ Ctx const& at(Team_ const& team, int s) {
    team.one([&] { context.tick = clock.tick(s); });
    team.sync();
    return context;
  }
  __device__ static Ctx at(Ctx context, StepClock<T> const& clock, int s) {
    context.tick = clock.tick(s);
    return context;
  }

 private:
  template <class Control> __device__ void finish(Control const& control, int done) {
    control.finish(clock, done);
    moves = false;
  }
};

}  // namespace mpmpbd::cuda
