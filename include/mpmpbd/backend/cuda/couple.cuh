// The coupling of one environment, carried out by the first threads of a block.
#pragma once

#include <mpmpbd/backend/cuda/launch.cuh>
#include <mpmpbd/backend/cuda/near_cells.cuh>
#include <mpmpbd/backend/cuda/together.cuh>

namespace mpmpbd::cuda {

// Threads that carry out a coupling.
inline constexpr int team_size = 128;

template <class Scene, class T, class Grid> struct Couple {
  using Shape = typename Scene::Body::Shape;
  using Together = detail::TogetherOf<typename Scene::Substep::Stages>;
  using Stages = typename Together::type;
  using Near = NearCells<T, Shape>;
  using Ctx = typename StepRecord<Scene, T>::Ctx;
  using Nodes_ =
      NodesOfArena<Grid, MoveNodes<typename Scene::Body, typename Scene::Effects>, Ctx, Shape>;
  // Whether other threads of the block may go on meanwhile.
  static constexpr bool overlaps = Together::overlap;
  static constexpr bool any = Stages::size > 0;
  using Team_ = std::conditional_t<overlaps, FirstThreads<team_size>, BlockTeam>;

  // All stages of substep s; where others wait, they are let go as early as can be. `fast`: launch.fast_bytes of
  // shared memory. Returns the faults met.
  __device__ static std::uint32_t run(Launch<Scene, T> const& launch, std::int64_t env, Grid arena,
                                      unsigned* near, StepRecord<Scene, T> const& record, int s,
                                      bool others_wait, char* fast) {
    Ctx const context = record.at(s);
    bool announced = !others_wait;
    Nodes_ const nodes{arena,
                       context,
                       launch.scratch + env * launch.scratch_stride,
                       launch.slot_of_node + env * static_cast<std::int64_t>(arena.count),
                       Near{near, launch.lattice},
                       announced,
                       {fast, static_cast<std::size_t>(launch.fast_bytes)}};
    auto const faults = run_all(launch.fields(env), nodes, context, Stages{});
    nodes.let_others_go();
    return faults;
  }

 private:
  template <class Env, class... Ss>
  __device__ static std::uint32_t run_all(Env const& env, Nodes_ const& nodes, Ctx const& context,
                                          TypeList<Ss...>) {
    return (Ss::run(Team_{}, env, context, nodes) | ... | 0u);
  }
};

}  // namespace mpmpbd::cuda
