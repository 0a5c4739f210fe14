// In which form a device carries out the steps of a scene, and why: resident.cuh or tiled.cuh where there is tissue,
// alone.cuh where there is none.
#pragma once

#include <stdexcept>
#include <string>

#include <mpmpbd/backend/cuda.hpp>
#include <mpmpbd/backend/cuda/alone.cuh>
#include <mpmpbd/backend/cuda/resident.cuh>
#include <mpmpbd/backend/cuda/tiled.cuh>

namespace mpmpbd::cuda {

inline std::int64_t attribute(Cuda const& where, cudaDeviceAttr which) {
  int value = 0;
  require(cudaDeviceGetAttribute(&value, which, where.device), "asking what it has");
  return value;
}

template <class Scene, class T> class ExecutionOnGrid {
  static_assert(
      has_bounded_stiffness<typename Scene::Body>,
      "mpmpbd Simulation<Scene, Cuda>: the stable step of linear splines hangs on who shares a "
      "node, which is not looked at on a device yet; take QuadraticBSpline or CubicBSpline");
  // Shared memory adds 32-bit integers at once, those of 64 bits in a loop; and it does not hold two grids.
  static constexpr bool looks_back = Scene::Body::Transfer::needs_previous_grid;
  static constexpr bool may_be_resident = std::is_same_v<T, float> && !looks_back;
  // Particles that a block moves while the tiled form has its kernels launched (decision 34).
  static constexpr std::int64_t moved_meanwhile = 3200;
  using Resident = ResidentSteps<Scene, most_threads>;
  using Tiled = TiledSteps<Scene, T>;

 public:
  // particles: of an environment at most. Refuses what the present device cannot do, with nothing allocated.
  ExecutionOnGrid(Cuda const& where, std::int64_t environments, std::int64_t particles,
                  Lattice<T> const& lattice)
      : threads_(where.threads),
        environments_(environments),
        nodes_(lattice.count()),
        grid_bytes_(Resident::shared_bytes(nodes_)),
        shared_limit_(attribute(where, cudaDevAttrMaxSharedMemoryPerBlockOptin)),
        processors_(attribute(where, cudaDevAttrMultiProcessorCount)),
        is_resident_(where.execution == Cuda::Execution::automatic
                         ? fits() && !faster_spread(particles)
                         : where.execution == Cuda::Execution::resident),
        asked_for_(where.execution != Cuda::Execution::automatic) {
    if (is_resident_)
      prepare_resident();
    else
      prepare_tiled();
  }

  std::size_t bytes() const {
    return is_resident_ ? Resident::bytes(environments_, nodes_)
                        : Tiled::bytes(environments_, nodes_);
  }
  void take_memory(cudaStream_t stream) {
    if (is_resident_)
      resident_ = Resident(environments_, nodes_, stream);
    else
      tiled_ = Tiled(environments_, nodes_, stream);
  }
  void run(Launch<Scene, T> const& launch, cudaStream_t stream) const {
    if constexpr (may_be_resident)
      if (is_resident_) return resident_.run(launch, threads_, processors_, shared_limit_, stream);
    tiled_.run(launch, threads_, processors_, shared_limit_, stream);
  }
  // Several steps in one launch, where a step is one: returns whether it is. Between two, a thread calls between(env) for every
  // environment.
  template <class Between>
  bool run_at_once(Launch<Scene, T> const& launch, int steps, Between const& between,
                   cudaStream_t stream) const {
    if constexpr (may_be_resident)
      if (is_resident_)
        resident_.run_at_once(launch, steps, between, threads_, processors_, shared_limit_, stream);
    return is_resident_;
  }
  std::string why() const {
    if (looks_back)
      return "tiled: FLIP needs the grid before forces too, which does not fit beside the grid in "
             "shared memory";
    if (!may_be_resident)
      return "tiled: sums of double take 64 bits, which a device adds at once in its own memory only";
    std::string const takes = "the grid of an environment takes " + std::to_string(grid_bytes_) +
                              " bytes of " + std::to_string(shared_limit_) +
                              " of shared memory per block";
    if (is_resident_) return "resident: " + takes;
    if (!fits()) return "tiled: " + takes + ", so it lies in the memory of the device";
    if (asked_for_) return "tiled, as asked for: " + takes;
    return "tiled: with a block for each environment " + std::to_string(environments_) + " of " +
           std::to_string(processors_) + " multiprocessors would be at work; " + takes;
  }

 private:
  bool fits() const { return may_be_resident && grid_bytes_ <= shared_limit_; }
  // Spread over all multiprocessors, particles are moved at half the rate of blocks that keep their grids to themselves: so it
  // pays where less than half of these would be at work, and more so than the launches cost.
  bool faster_spread(std::int64_t particles) const {
    return 2 * environments_ * particles + moved_meanwhile * processors_ < processors_ * particles;
  }
  void prepare_resident() const {
    if constexpr (!may_be_resident) {
      throw std::invalid_argument("mpmpbd Cuda: resident execution asked for; " + why() +
                                  ". Take tiled execution");
    } else {
      if (!fits())
        throw std::runtime_error("mpmpbd Cuda: " + why() +
                                 "; use a grid of fewer nodes or larger cells, or tiled execution");
      Resident::reserve(shared_limit_);
    }
  }
  void prepare_tiled() const {
    if (nodes_ > Tiled::most_nodes)
      throw std::invalid_argument("mpmpbd Cuda: a grid of " + std::to_string(nodes_) +
                                  " nodes; a device holds " + std::to_string(Tiled::most_nodes) +
                                  " of an environment at most; use fewer nodes or larger cells");
    Tiled::reserve(shared_limit_);
  }

  int threads_;
  std::int64_t environments_, nodes_, grid_bytes_, shared_limit_, processors_;
  bool is_resident_, asked_for_;
  Resident resident_;
  Tiled tiled_;
};

template <class Scene, class T> class ExecutionAlone {
  static_assert(
      Scene::has_rods,
      "mpmpbd Simulation<Scene, Cuda>: a scene with neither tissue nor threads; add Mpm<NeoHookean> or "
      "Pbd<Constraints<Distance>>");

 public:
  ExecutionAlone(Cuda const& where, std::int64_t environments, std::int64_t, Lattice<T> const&)
      : threads_(where.threads),
        environments_(environments),
        processors_(attribute(where, cudaDevAttrMultiProcessorCount)) {
    if (where.execution != Cuda::Execution::automatic)
      throw std::invalid_argument(
          "mpmpbd Cuda: resident or tiled execution asked for; these say where the grid of tissue "
          "lies, and this scene has threads alone. Take Cuda::Execution::automatic");
  }
  std::size_t bytes() const { return 0; }
  void take_memory(cudaStream_t) {}
  void run(Launch<Scene, T> const& launch, cudaStream_t stream) const {
    run_alone(launch, environments_, threads_, processors_, stream);
  }
  template <class Between>
  bool run_at_once(Launch<Scene, T> const&, int, Between const&, cudaStream_t) const {
    return false;
  }
  std::string why() const { return "alone: threads without tissue need no grid"; }

 private:
  int threads_;
  std::int64_t environments_, processors_;
};

template <class Scene, class T>
using Execution =
    std::conditional_t<Scene::has_body, ExecutionOnGrid<Scene, T>, ExecutionAlone<Scene, T>>;

}  // namespace mpmpbd::cuda
