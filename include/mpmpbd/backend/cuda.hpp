// Runs on a CUDA device: Simulation<Scene, Cuda> moves all environments at once.
//
// This header needs no CUDA compiler. The functions that do are defined in backend/cuda/simulation.cuh: a catalogue
// compiles them once, so that a program of plain C++ links and drives them.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include <mpmpbd/core/array.hpp>
#include <mpmpbd/core/fixed_string.hpp>
#include <mpmpbd/scene/run_state.hpp>

namespace mpmpbd {

// Where to run.
struct Cuda {
  static constexpr FixedString name = "cuda";
  static constexpr int grids =
      2;  // of an environment, at least: one is added up while the other is read

  // resident: a thread block holds the grid of an environment in shared memory; a step is one launch. tiled: grids in the
  // memory of the device, of up to 2^29 nodes; a step of n substeps is 5 + 3 n launches. automatic: resident where it fits, but
  // tiled where few environments leave most of the device idle: E of them with room for N particles each, on P multiprocessors,
  // where 2 E / P + 3200 / N < 1. A scene of threads alone has no grid: leave it automatic; a step is one launch.
  enum class Execution { automatic, resident, tiled };

  int device = 0;
  void* stream = nullptr;  // a cudaStream_t of that device; null: its default stream
  // Of a block, at most: 128 to 512, a multiple of 32. Tiled takes 256 of them at most, and for couplings 128 or 256 whatever
  // is asked; threads alone take whole warps for their beads, or one where environments share multiprocessors. Bits depend
  // neither on this nor on the form.
  int threads = 512;
  Execution execution = Execution::automatic;
};

namespace cuda {
template <class Scene, class T> struct StateOnDevice;  // in backend/cuda/simulation.cuh
}

// Limits: no linear splines; double and FLIP run tiled.
template <class Scene, class Backend, class T> class Simulation;
template <class Scene_, class T> class Simulation<Scene_, Cuda, T> : private RunState<Scene_, T> {
  using Base = RunState<Scene_, T>;

 public:
  using Scene = Scene_;
  using Scalar = T;
  using Store = typename Base::Store;

  // Throws std::invalid_argument for options that are not allowed, and std::runtime_error, which leaves nothing allocated,
  // where there is no such device or not enough memory.
  explicit Simulation(SimulationOptions how, Cuda where = {});
  ~Simulation();
  Simulation(Simulation&&) noexcept;

  using Base::environments;
  using Base::lattice;
  using Base::options;

  // The state on the host. It is fetched when the device's is newer, which waits for the device; asked for so that
  // it can be changed, it is sent before anything else happens there.
  Store const& state() const { return fetched(); }
  Store& state() {
    Store& own = fetched();
    host_is_newer_ = true;
    return own;
  }
  std::uint32_t status(std::int64_t env) const {
    return static_cast<std::uint32_t>(state().template get<environment::Status>(env));
  }
  auto context(std::int64_t env) const {
    fetched();
    return Base::context(env);
  }

  // As on the host.
  template <class P> void set(parameters_t<P, double> const& k) { changed().template set<P>(k); }
  template <class P> void set(std::int64_t env, parameters_t<P, double> const& k) {
    changed().template set<P>(env, k);
  }
  void add_particles(std::int64_t env, std::span<Vec3<double> const> positions, double density,
                     double volume) requires(Scene_::has_body) {
    changed().add_particles(env, positions, density, volume);
  }
  void restore(Store const& source) { changed().restore(source); }
  void clone(std::int64_t from, std::int64_t to) { changed().clone(from, to); }

  // Makes the present state the one that reset() returns to; it lies on the device.
  void remember();
  // Puts environments (all of them, or those with a non-zero mask) back to the remembered state, exactly. A mask of the host's
  // is waited for, here and by step.
  void reset() { reset_where(nullptr); }
  void reset(std::span<unsigned char const> mask);

  // Advances every environment by h [s], each with its own number of substeps; with a mask, those where it is not 0.
  // Returns before the device has done so. Where environments in tiled form choose their substeps it waits until they have
  // chosen, once per step. What the host has changed is sent before, which waits (send). A launch that is refused throws
  // std::runtime_error; in tiled form, of several, that may leave a step half done: reset, or restore a state.
  void step(double h, std::span<unsigned char const> mask = {});

  // The same with masks in the memory of the device, of which nothing is copied. Null: all environments.
  void step_where(double h, unsigned char const* mask);
  void reset_where(unsigned char const* mask);
  // Several steps in one launch, where a step is one and scenes have tissue (resident); else it moves nothing and returns false.
  // Between two, one thread calls between(env) for every environment, moving or not: a CUDA compiler is needed
  // (backend/cuda/simulation.cuh). h [s]; fewer steps than 1 throw std::invalid_argument.
  template <class Between>
  bool steps_at_once(double h, unsigned char const* mask, int steps, Between const& between);
  // Sends the state where the host has changed it, and waits until it is there; takes no memory of the device unless the host
  // has put more slots to use: std::runtime_error where there is not enough. Then put fewer to use, or restore a state: until
  // that fits, neither step nor reset does anything.
  void send();
  // Waits until the device has done all that it was told.
  void wait() const;

  // A field in the memory of the device, (env, slot, component), valid as long as this run. From now on the device's state
  // is the newer one. Once the host has looked at the state, call again before more is written there: state() of a run that is
  // not const counts as changed, and is sent over it. Call before each replay of a graph with a step in it, too.
  template <class F> Array array() {
    static_assert(
        contains<typename Store::List, F>,
        "mpmpbd Simulation: the scene does not store this field; a policy that names it in "
        "Reads or Writes makes it state");
    send();
    device_is_newer_ = true;
    return field_array<F>(static_cast<element_t<F, T>*>(plane_of(field_index<F>())), environments(),
                          Base::state_.template table<typename F::Domain>().capacity(), place());
  }

  // The state for kernels of your own, which run in the same stream (backend/cuda/simulation.cuh). Sends what the
  // host has changed; from now on the device's state is the newer one.
  cuda::StateOnDevice<Scene, T> on_device();

  // How a step is carried out, and why.
  std::string execution() const;

 private:
  struct Device;  // in backend/cuda/simulation.cuh

  // The place of a field in the list of all that are stored.
  template <class F> static constexpr int field_index() {
    return []<class... Fs>(Fields<Fs...>) {
      int at = 0;
      static_cast<void>((... || (std::is_same_v<F, Fs> || (++at, false))));
      return at;
    }(typename Store::List{});
  }
  void* plane_of(int field) const;
  Place place() const;

  Store& fetched() const;
  Base& changed() {
    fetched();
    host_is_newer_ = true;
    return *this;
  }

  std::unique_ptr<Device> device_;
  mutable bool host_is_newer_ = true;
  mutable bool device_is_newer_ = false;
};

}  // namespace mpmpbd
