// What Simulation<Scene, Cuda> does on the device: memory, transfers and launches.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <mpmpbd/backend/cuda/execution.cuh>
#include <mpmpbd/backend/cuda/planes.cuh>

namespace mpmpbd {

namespace cuda {

// A run as kernels see it: its state, the one that it returns to, and its grid.
template <class Scene, class T> struct StateOnDevice {
  TablesOf<Scene, T> now, remembered;
  Lattice<T> lattice;
};

}  // namespace cuda

template <class Scene_, class T> struct Simulation<Scene_, Cuda, T>::Device {
  using Layout = cuda::Layout<Store>;
  using Tables = cuda::TablesOf<Scene, T>;
  // Scenes that only store more have their steps in common, kernels and all. Spelled out: what nvcc generates for a kernel
  // names its scene as it is written here, and may not name a member of this class.
  using Execution = cuda::Execution<typename Scene_::Stepped, T>;

  Cuda where;
  cudaStream_t stream;
  Execution execution;
  cuda::Memory now, initial, planes, work, mask;
  int plane_count = 0;
  std::size_t work_stride = 0,
              remembered_stride = 0;  // of an environment; for the state that reset() returns to
  std::int64_t fast_bytes = 0;        // that help a coupling, in shared memory

  Device(Cuda where_, Base const& run)
      : where(checked(where_, run)),
        stream(static_cast<cudaStream_t>(where.stream)),
        execution(on_its_device(where, run)) {
    cuda::OnDevice const here(where.device);
    take_memory(run);
  }

  // Refuses what no device does, and a device that there is not.
  static Cuda const& checked(Cuda const& where, Base const& run) {
    if (where.threads < cuda::fewest_threads || where.threads > cuda::most_threads ||
        where.threads % 32 != 0)
      throw std::invalid_argument("mpmpbd Cuda: threads = " + std::to_string(where.threads) +
                                  "; give a multiple of 32 from " +
                                  std::to_string(cuda::fewest_threads) + " to " +
                                  std::to_string(cuda::most_threads));
    if (Scene::has_body && run.options().strict)
      throw std::invalid_argument(
          "mpmpbd Cuda: strict = true; a device finds the stable limit inside the step and sets "
          "Fault::time_step. Give strict = false, or substeps = 0, which keeps to the limit");
    int count = 0;
    auto const e = cudaGetDeviceCount(&count);
    if (e != cudaSuccess || where.device < 0 || where.device >= count) {
      cudaGetLastError();
      throw std::runtime_error("mpmpbd Cuda: device " + std::to_string(where.device) +
                               " asked for; there are " + std::to_string(count) +
                               " with a working driver" +
                               (e != cudaSuccess ? std::string(": ") + cudaGetErrorString(e) : ""));
    }
    return where;
  }
  static Execution on_its_device(Cuda const& where, Base const& run) {
    cuda::OnDevice const here(where.device);
    std::int64_t particles = 0;
    if constexpr (Scene::has_body) particles = run.state().template table<Particles>().capacity();
    return Execution(where, run.environments(), particles, run.lattice());
  }
  void take_memory(Base const& run) {
    auto const state = Layout::bytes(run.state()) + cuda::announced_bytes;
    auto const masks = static_cast<std::size_t>(run.environments());
    auto const all = cuda::planes_of_environment(run.state());
    cuda::require_free(2 * state + masks + all.size() * sizeof(cuda::Plane) + execution.bytes());
    now = cuda::Memory(state);
    // It is copied as a whole, with what lies between two planes.
    cuda::require(cudaMemsetAsync(now.as(), 0, state, stream), "clearing the state");
    initial = cuda::Memory(state);
    mask = cuda::Memory(masks);
    planes = cuda::Memory(all.size() * sizeof(cuda::Plane));
    plane_count = static_cast<int>(all.size());
    copy(planes.as(), all.data(), planes.bytes(), cudaMemcpyHostToDevice);
    cuda::require(cudaStreamSynchronize(stream), "sending the planes");
    execution.take_memory(stream);
  }

  // As much of it as these tables hold.
  template <class Tables_ = Tables>
  Tables_ tables(Store const& store, cuda::Memory const& memory) const {
    Tables_ t{};
    Layout::walk(
        store,
        [&]<class F>(F, std::size_t, std::size_t at) {
          if constexpr (contains<typename Tables_::Stored, F>) {
            auto& view = t.template of<typename F::Domain>().view;
            auto const& table = store.template table<typename F::Domain>();
            view.capacity = table.capacity();
            view.stride = store.environments() * table.capacity();
            static_cast<detail::Plane<T, F>&>(view).data = memory.as<element_t<F, T>>(at);
          }
        },
        [&]<class D>(std::type_identity<D>, std::size_t, std::size_t at) {
          t.template of<D>().live = memory.as<std::int64_t>(at);
        });
    return t;
  }

  // All of a store to the device, and back; live counts are few and go through copies.
  void send(Store const& store) {
    std::vector<std::vector<std::int64_t>> counts;
    Layout::walk(
        store,
        [&]<class F>(F, std::size_t n, std::size_t at) {
          auto const& from = store.template table<typename F::Domain>().template planes<F>();
          copy(now.as(at), from.data(), n, cudaMemcpyHostToDevice);
        },
        [&]<class D>(std::type_identity<D>, std::size_t n, std::size_t at) {
          auto& live = counts.emplace_back();
          for (std::int64_t e = 0; e < store.environments(); ++e)
            live.push_back(store.template table<D>().live(e));
          copy(now.as(at), live.data(), n, cudaMemcpyHostToDevice);
        });
    cuda::require(cudaStreamSynchronize(stream), "sending");
  }
  void fetch(Store& store) const {
    std::vector<std::vector<std::int64_t>> counts;
    Layout::walk(
        store,
        [&]<class F>(F, std::size_t n, std::size_t at) {
          auto& to = store.template table<typename F::Domain>().template planes<F>();
          copy(to.data(), now.as(at), n, cudaMemcpyDeviceToHost);
        },
        [&]<class D>(std::type_identity<D>, std::size_t n, std::size_t at) {
          auto& live = counts.emplace_back(static_cast<std::size_t>(store.environments()));
          copy(live.data(), now.as(at), n, cudaMemcpyDeviceToHost);
        });
    cuda::require(cudaStreamSynchronize(stream), "fetching");
    auto live = counts.begin();
    for_each_type(typename Store::Domains{}, [&]<class D>(std::type_identity<D>) {
      for (std::int64_t e = 0; e < store.environments(); ++e)
        store.template table<D>().set_live(e, (*live)[static_cast<std::size_t>(e)]);
      ++live;
    });
  }
  void copy(void* to, void const* from, std::size_t n, cudaMemcpyKind way) const {
    cuda::copy(stream, to, from, n, way);
  }

  // Work memory for the present numbers of beads, points and the like, and for those of the remembered state, which a reset
  // brings back unseen by the host: it grows, and never holds history.
  template <class Contexts> void reserve(Base& run, Contexts const& context_of) {
    WorkBytes most;
    for (std::int64_t e = 0; e < run.environments(); ++e)
      most.include(run.state(), e, context_of(e));
    fast_bytes = static_cast<std::int64_t>(most.fast);
    auto const bytes = std::max(Layout::aligned(most.scratch), remembered_stride);
    if (bytes <= work_stride) return;
    work_stride = 0;  // there is none until there is more
    work = cuda::Memory{};
    work = cuda::Memory(static_cast<std::size_t>(run.environments()) * bytes);
    work_stride = bytes;
  }
  // The most that a stage asks for an environment: work memory, and how much of it had better be fast.
  struct WorkBytes {
    std::size_t scratch = 16, fast = 0;

    template <class Ctx> void include(Store& store, std::int64_t env, Ctx const& context) {
      auto const fields = access_environment(store, env, typename Store::Domains{});
      for_each_type(typename Scene::Substep::Stages{}, [&]<class S>(std::type_identity<S>) {
        if constexpr (requires { S::scratch_bytes(fields, context); })
          scratch = std::max(scratch, S::scratch_bytes(fields, context));
        if constexpr (requires { S::fast_bytes(fields, context); })
          fast = std::max(fast, S::fast_bytes(fields, context));
      });
    }
  };

  cuda::Launch<typename Scene_::Stepped, T> launch_of(Base const& run, double h,
                                                      unsigned char const* of) const {
    using Tables_ = cuda::TablesOf<typename Scene_::Stepped, T>;
    return {tables<Tables_>(run.state(), now),
            run.lattice(),
            h,
            run.options().substep_choice(),
            of,
            work.as(),
            static_cast<std::int64_t>(work_stride),
            fast_bytes};
  }
  void reset(Base const& run, unsigned char const* of) const {
    constexpr int parts = 8;
    auto const all = tables(run.state(), now);
    auto* const episodes =
        all.template of<Environments>().view.template plane<environment::Episode>(0);
    cuda::start(stream, "a reset", cuda::reset<std::uint32_t>, run.environments() * parts, 256, 0,
                now.as<std::uint32_t>(), initial.as<std::uint32_t>(), planes.as<cuda::Plane>(),
                plane_count, episodes, of, parts);
  }
  // Waits: a mask of the host's may be another, or gone, once the caller has it back.
  unsigned char const* upload(std::span<unsigned char const> of) const {
    if (of.empty()) return nullptr;
    copy(mask.as(), of.data(), of.size(), cudaMemcpyHostToDevice);
    cuda::require(cudaStreamSynchronize(stream), "sending a mask");
    return mask.as<unsigned char>();
  }
};

template <class Scene_, class T>
Simulation<Scene_, Cuda, T>::Simulation(SimulationOptions how, Cuda where)
    : Base(std::move(how)),
      device_(std::make_unique<Device>(where, static_cast<Base const&>(*this))) {
  remember();
}
template <class Scene_, class T> Simulation<Scene_, Cuda, T>::~Simulation() = default;
template <class Scene_, class T>
Simulation<Scene_, Cuda, T>::Simulation(Simulation&&) noexcept = default;

template <class Scene_, class T> auto Simulation<Scene_, Cuda, T>::fetched() const -> Store& {
  auto& own = const_cast<Store&>(Base::state_);
  if (device_is_newer_) {
    cuda::OnDevice const here(device_->where.device);
    device_->fetch(own);
    device_is_newer_ = false;
  }
  return own;
}
template <class Scene_, class T> void Simulation<Scene_, Cuda, T>::send() {
  if (!host_is_newer_) return;
  cuda::OnDevice const here(device_->where.device);
  device_->reserve(*this, [this](std::int64_t env) { return Base::context_of(env); });
  device_->send(Base::state_);
  host_is_newer_ = false;
}
template <class Scene_, class T> void Simulation<Scene_, Cuda, T>::wait() const {
  cuda::OnDevice const here(device_->where.device);  // a null stream is another one on each device
  cuda::require(cudaStreamSynchronize(device_->stream), "waiting for the device");
}

template <class Scene_, class T> void Simulation<Scene_, Cuda, T>::remember() {
  send();
  cuda::OnDevice const here(device_->where.device);
  device_->copy(device_->initial.as(), device_->now.as(), device_->now.bytes(),
                cudaMemcpyDeviceToDevice);
  device_->remembered_stride = device_->work_stride;
}
template <class Scene_, class T>
void Simulation<Scene_, Cuda, T>::reset(std::span<unsigned char const> mask) {
  Base::check_mask(mask);
  cuda::OnDevice const here(device_->where.device);
  reset_where(device_->upload(mask));
}
template <class Scene_, class T>
void Simulation<Scene_, Cuda, T>::reset_where(unsigned char const* mask) {
  send();
  cuda::OnDevice const here(device_->where.device);
  device_->reset(*this, mask);
  device_is_newer_ = true;
}

template <class Scene_, class T>
void Simulation<Scene_, Cuda, T>::step(double h, std::span<unsigned char const> mask) {
  detail::check_step(h);
  if (!mask.empty()) Base::check_mask(mask);
  cuda::OnDevice const here(device_->where.device);
  step_where(h, device_->upload(mask));
}
template <class Scene_, class T>
void Simulation<Scene_, Cuda, T>::step_where(double h, unsigned char const* mask) {
  detail::check_step(h);
  send();
  cuda::OnDevice const here(device_->where.device);
  device_is_newer_ = true;  // of several launches some may be done when one is refused
  device_->execution.run(device_->launch_of(*this, h, mask), device_->stream);
}
template <class Scene_, class T>
template <class Between>
bool Simulation<Scene_, Cuda, T>::steps_at_once(double h, unsigned char const* mask, int steps,
                                                Between const& between) {
  detail::check_step(h);
  if (steps < 1)
    throw std::invalid_argument("mpmpbd Simulation: " + std::to_string(steps) +
                                " steps at once; give at least 1");
  send();
  cuda::OnDevice const here(device_->where.device);
  bool const taken = device_->execution.run_at_once(device_->launch_of(*this, h, mask), steps,
                                                    between, device_->stream);
  device_is_newer_ = device_is_newer_ || taken;
  return taken;
}

template <class Scene_, class T> void* Simulation<Scene_, Cuda, T>::plane_of(int field) const {
  void* found = nullptr;
  int i = 0;
  cuda::Layout<Store>::walk(
      Base::state_,
      [&](auto, std::size_t, std::size_t at) {
        if (i++ == field) found = device_->now.as(at);
      },
      [](auto...) {});
  return found;
}
template <class Scene_, class T>
cuda::StateOnDevice<Scene_, T> Simulation<Scene_, Cuda, T>::on_device() {
  send();
  device_is_newer_ = true;
  return {device_->tables(Base::state_, device_->now),
          device_->tables(Base::state_, device_->initial), Base::lattice_};
}
template <class Scene_, class T> Place Simulation<Scene_, Cuda, T>::place() const {
  return {MemorySpace::cuda, device_->where.device, device_->where.stream};
}
template <class Scene_, class T> std::string Simulation<Scene_, Cuda, T>::execution() const {
  return device_->execution.why();
}

}  // namespace mpmpbd
