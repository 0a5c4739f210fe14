// The coupling of one environment, carried out by a team of threads of a block.
#pragma once

#include <mpmpbd/backend/cuda/launch.cuh>
#include <mpmpbd/backend/cuda/together.cuh>
#include <mpmpbd/coupling/workspace.hpp>

namespace mpmpbd::cuda {

// Nodes as a coupling sees them.
template <class Move, class Ctx> struct NodesOfGrid {
  using T = typename Ctx::Scalar;
  Velocities<T> velocities;
  Ctx const& context;
  void* scratch;
  int* slot_of_node;
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
};

template <class Scene, class T> struct Couple {
  using Stages = typename detail::TogetherOf<typename Scene::Substep::Stages>::type;
  using Ctx = typename StepRecord<Scene, T>::Ctx;
  using Nodes_ = NodesOfGrid<MoveNodes<typename Scene::Body, typename Scene::Effects>, Ctx>;
  static constexpr bool any = detail::couples<Scene>;

  // All stages of a substep on the nodes of an environment. `fast`: launch.fast_bytes of shared memory. Returns the
  // faults met.
  template <class Team_>
  __device__ static std::uint32_t run(Team_ const& team, Launch<Scene, T> const& launch,
                                      std::int64_t env, Velocities<T> nodes, Ctx const& context,
                                      char* fast) {
    Nodes_ const seen{nodes,
                      context,
                      launch.scratch + env * launch.scratch_stride,
                      launch.slot_of_node + env * launch.lattice.count(),
                      {fast, static_cast<std::size_t>(launch.fast_bytes)}};
    return run_all(team, launch.fields(env), seen, context, Stages{});
  }

 private:
  template <class Team_, class Env, class... Ss>
  __device__ static std::uint32_t run_all(Team_ const& team, Env const& env, Nodes_ const& nodes,
                                          Ctx const& context, TypeList<Ss...>) {
    return (Ss::run(team, env, context, nodes) | ... | 0u);
  }
};

}  // namespace mpmpbd::cuda
