// The coupling of one environment, carried out by a team of threads of a block.
#pragma once

#include <mpmpbd/backend/cuda/launch.cuh>
#include <mpmpbd/backend/cuda/together.cuh>
#include <mpmpbd/coupling/workspace.hpp>

namespace mpmpbd::cuda {

// Nodes as a coupling sees them. `items_by_blocks`: a stage that goes item by item is shared out among blocks, and has `add` to
// count over all of them.
template <class Move, class Ctx, bool items_by_blocks> struct NodesOfGrid {
  using T = typename Ctx::Scalar;
  Velocities<T> velocities;
  Ctx const& context;
  void* scratch;
  FastMemory fast;

  MPMPBD_HD T mass(int i) const { return velocities.mass(i); }
  MPMPBD_HD Vec3<T> velocity(int i) const {
    auto const v = velocities[i];
    return {{v[0], v[1], v[2]}};
  }
  MPMPBD_HD void set_velocity(int i, Vec3<T> const& v) const {
    velocities.set(i, quad(v[0], v[1], v[2], mass(i)));
  }
  MPMPBD_HD Vec3<T> inverse_mass(int i) const {
    auto const& lattice = context.lattice;
    int const row = i / lattice.nodes[0];
    auto const x =
        lattice.position(i % lattice.nodes[0], row % lattice.nodes[1], row / lattice.nodes[1]);
    return Move::inverse_mass(velocity(i), mass(i), x, context);
  }
  __device__ void add(int& counter, int amount) const requires items_by_blocks {
    atomicAdd(&counter, amount);
  }
};

template <class Scene, class T, bool items_by_blocks = false> struct Couple {
  using Stages = typename detail::TogetherOf<typename Scene::Substep::Stages>::type;
  using Before = typename detail::AtItemWise<Stages>::Before;
  using ItemWise = typename detail::AtItemWise<Stages>::ItemWise;
  using After = typename detail::AtItemWise<Stages>::After;
  using Ctx = typename StepRecord<Scene, T>::Ctx;
  using Nodes_ =
      NodesOfGrid<MoveNodes<typename Scene::Body, typename Scene::Effects>, Ctx, items_by_blocks>;
  static constexpr bool any = detail::couples<Scene>;

  // Stages of a substep on the nodes of an environment, Before or After. `fast`: launch.fast_bytes of shared memory.
  // Returns the faults met.
  template <class Stages_, class Team_>
  __device__ static std::uint32_t run(Team_ const& team, Launch<Scene, T> const& launch,
                                      std::int64_t env, Velocities<T> nodes, Ctx const& context,
                                      char* fast) {
    return run_all_by_team(Stages_{}, team, launch.fields(env), context,
                           seen(launch, env, nodes, context, fast));
  }
  // The same as a function by itself: one with two rows of stages keeps more of its numbers on the stack.
  template <class Stages_, class Team_>
  __device__ __noinline__ static std::uint32_t run_apart(Team_ const& team,
                                                         Launch<Scene, T> const& launch,
                                                         std::int64_t env, Velocities<T> nodes,
                                                         Ctx const& context, char* fast) {
    return run<Stages_>(team, launch, env, nodes, context, fast);
  }

  // Items of the stage between them: as many as an environment may have, as it has, and some of them by the threads of a
  // block.
  static std::int64_t most_items(Launch<Scene, T> const& launch) {
    return capacity(launch, ItemWise{});
  }
  __device__ static int items(Launch<Scene, T> const& launch, std::int64_t env) {
    return count(launch.fields(env), ItemWise{});
  }
  __device__ static void run_items(Launch<Scene, T> const& launch, std::int64_t env,
                                   Velocities<T> nodes, Ctx const& context, Run const& some) {
    auto const fields = launch.fields(env);
    auto const grid = seen(launch, env, nodes, context, nullptr);
    some.each([&](int item) { run_item(fields, grid, context, item, ItemWise{}); });
  }

 private:
  __device__ static Nodes_ seen(Launch<Scene, T> const& launch, std::int64_t env,
                                Velocities<T> nodes, Ctx const& context, char* fast) {
    return {nodes,
            context,
            launch.scratch + env * launch.scratch_stride,
            {fast, static_cast<std::size_t>(fast != nullptr ? launch.fast_bytes : 0)}};
  }
  static std::int64_t capacity(Launch<Scene, T> const&, TypeList<>) { return 0; }
  template <class S> static std::int64_t capacity(Launch<Scene, T> const& launch, TypeList<S>) {
    std::int64_t sum = 0;
    for_each_type(typename S::Items{}, [&]<class D>(std::type_identity<D>) {
      sum += launch.tables.template of<D>().view.capacity;
    });
    return sum;
  }
  template <class Env> __device__ static int count(Env const&, TypeList<>) { return 0; }
  template <class Env, class S> __device__ static int count(Env const& env, TypeList<S>) {
    return S::count(env);
  }
  template <class Env>
  __device__ static void run_item(Env const&, Nodes_ const&, Ctx const&, int, TypeList<>) {}
  template <class Env, class S>
  __device__ static void run_item(Env const& env, Nodes_ const& nodes, Ctx const& context, int item,
                                  TypeList<S>) {
    S::run(env, item, context, nodes);
  }
};

}  // namespace mpmpbd::cuda
