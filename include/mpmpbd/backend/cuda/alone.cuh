// Execution without a grid, for scenes of threads alone: a step is one launch, and a block moves an environment.
//
// The stages are the scene's own, and carried out by a team as a coupling is; so bits do not depend on how many threads
// there are.
#pragma once

#include <algorithm>
#include <utility>

#include <mpmpbd/backend/cuda/launch.cuh>
#include <mpmpbd/backend/cuda/memory.cuh>
#include <mpmpbd/backend/grid.hpp>

namespace mpmpbd::cuda {

// What one thread of a block finds out for all of them.
template <class T> struct AloneRecord {
  StepClock<T> clock;
  unsigned met;  // faults of a substep
  int done;      // substeps
  bool moves;
};

// The environment of a block. All of its threads call.
template <class Scene, class T> class EnvironmentAlone {
  using Env = decltype(std::declval<Launch<Scene, T> const&>().fields(0));
  using Record = AloneRecord<T>;

 public:
  __device__ EnvironmentAlone(Launch<Scene, T> const& launch, std::int64_t env, Record& record)
      : launch_(launch), fields_(launch.fields(env)), record_(record) {}

  __device__ void step() const {
    StepControl const control{fields_};
    begin(control);
    auto context = load_context<typename Scene::Physics>(fields_, launch_.lattice);
    while (record_.moves) {
      context.tick = record_.clock.tick(record_.done);
      note(run_all_by_team(typename Scene::Substep::Stages{}, team_, fields_, context, NoNodes{}));
      note(lost_bodies(team_, fields_));
      team_.sync();
      team_.one([&] { close(control); });
      team_.sync();
    }
    team_.one([&] { control.finish(record_.clock, record_.done); });
  }

 private:
  // Nothing bounds the substep of a thread.
  template <class Control> __device__ void begin(Control const& control) const {
    team_.one([&] { record_.met = 0; });
    team_.sync();
    note(lost_bodies(team_, fields_));
    team_.sync();
    team_.one([&] {
      control.meet(record_.met);
      record_.clock = control.begin(StepLimit<T>{}, launch_.h, launch_.choice);
      record_.met = 0;
      record_.done = 0;
      record_.moves = !control.frozen();
    });
    team_.sync();
  }
  template <class Control> __device__ void close(Control const& control) const {
    control.meet(record_.met);
    record_.met = 0;
    record_.done += 1;
    record_.moves = record_.done < record_.clock.substeps && !control.frozen();
  }
  __device__ void note(unsigned faults) const {
    if (faults != 0) atomicOr(&record_.met, faults);
  }

  Launch<Scene, T> const& launch_;
  Env fields_;
  Record& record_;
  BlockTeam team_{};
};

template <class Scene, class T>
__global__ void __launch_bounds__(most_threads)
    step_alone(__grid_constant__ Launch<Scene, T> const launch) {
  alignas(16) extern __shared__ char dynamic_shared_memory[];
  auto& record = *reinterpret_cast<AloneRecord<T>*>(dynamic_shared_memory);
  std::int64_t const env = blockIdx.x;
  if (!launch.moves(env) || StepControl{launch.fields(env)}.frozen()) return;
  EnvironmentAlone<Scene, T>(launch, env, record).step();
}

// The host's side: the launch. It keeps nothing. A direct solver leaves most to one thread: where multiprocessors are shared, a
// warp for each environment lets most of them go on side by side; else there are as many whole warps as beads have a place in.
template <class Scene, class T>
void run_alone(Launch<Scene, T> const& launch, std::int64_t environments, int threads,
               std::int64_t processors, cudaStream_t stream) {
  auto const beads = launch.tables.template of<Beads>().view.capacity;
  auto const wanted = environments > processors ? 1 : (beads + Warp::size - 1) / Warp::size;
  auto const warps = std::clamp<std::int64_t>(wanted, 1, threads / Warp::size);
  start(stream, "a step", step_alone<Scene, T>, environments, static_cast<int>(warps) * Warp::size,
        sizeof(AloneRecord<T>), launch);
}

}  // namespace mpmpbd::cuda
