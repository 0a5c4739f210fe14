// A copy of a run's state on the device, and its step there; for tests and measurements.
#pragma once

#include <cuda_runtime.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <mpmpbd/backend/resident.cuh>
#include <mpmpbd/scene/simulation.hpp>

namespace test {

inline void require(cudaError_t e, char const* what) {
  if (e == cudaSuccess) return;
  std::printf("%s: %s\n0 passed, 1 failed\n", what, cudaGetErrorString(e));
  std::exit(1);
}

template <class Scene> class OnDevice {
 public:
  using Run = mpmpbd::Simulation<Scene, mpmpbd::Serial, float>;
  using Store = typename Run::Store;
  using Launch = mpmpbd::resident::Launch<Scene>;

  // `dt` [s] for each of `substeps`.
  OnDevice(Run& run, float dt, int substeps)
      : environments_(run.environments()), lattice_(run.lattice()) {
    mpmpbd::for_each_type(typename Store::Domains{},
                          [&]<class D>(std::type_identity<D>) { copy_table<D>(run.state()); });
    std::vector<typename Launch::Ctx> contexts;
    for (std::int64_t e = 0; e < environments_; ++e) contexts.push_back(context_of(run, e, dt));
    launch_.contexts = upload(contexts);
    launch_.heaviest = run.state().template get<mpmpbd::particle::Mass>(0, 0);
    launch_.substeps = substeps;
    launch_.scratch_stride = 1 << 20;
    launch_.scratch = allocate<char>(environments_ * launch_.scratch_stride);
    launch_.slot_of_node =
        upload(std::vector<int>(static_cast<std::size_t>(environments_ * lattice_.count()), -1));
    launch_.faults = upload(std::vector<unsigned>(static_cast<std::size_t>(environments_), 0));
  }
  OnDevice(OnDevice const&) = delete;
  OnDevice& operator=(OnDevice const&) = delete;
  ~OnDevice() {
    for (void* p : owned_) cudaFree(p);
  }

  template <int threads> void start() {
    int const bytes = mpmpbd::resident::Arena::bytes_per_node * static_cast<int>(lattice_.count());
    require(cudaFuncSetAttribute(mpmpbd::resident::step<Scene, threads>,
                                 cudaFuncAttributeMaxDynamicSharedMemorySize, bytes),
            "shared memory");
    mpmpbd::resident::step<Scene, threads>
        <<<static_cast<unsigned>(environments_), threads, static_cast<std::size_t>(bytes)>>>(
            launch_);
    require(cudaGetLastError(), "launch");
  }
  template <int threads> void step() {
    start<threads>();
    require(cudaDeviceSynchronize(), "step");
  }
  // Median time of a step over `runs` [ms].
  template <int threads> double time(int runs) {
    step<threads>();
    std::vector<float> ms;
    cudaEvent_t a, b;
    cudaEventCreate(&a), cudaEventCreate(&b);
    for (int r = 0; r < runs; ++r) {
      cudaEventRecord(a);
      start<threads>();
      cudaEventRecord(b);
      require(cudaEventSynchronize(b), "step");
      float t = 0;
      cudaEventElapsedTime(&t, a, b);
      ms.push_back(t);
    }
    cudaEventDestroy(a), cudaEventDestroy(b);
    std::sort(ms.begin(), ms.end());
    return ms[ms.size() / 2];
  }

  // All numbers of a field, as the host's table holds them.
  template <class F> std::vector<mpmpbd::element_t<F, float>> read() const {
    auto const& view = launch_.tables.template of<typename F::Domain>().view;
    std::vector<mpmpbd::element_t<F, float>> values(
        static_cast<std::size_t>(F::components * view.stride));
    require(cudaMemcpy(values.data(), view.template plane<F>(), values.size() * sizeof(values[0]),
                       cudaMemcpyDeviceToHost),
            "read");
    return values;
  }
  std::vector<unsigned> faults() const {
    std::vector<unsigned> f(static_cast<std::size_t>(environments_));
    require(
        cudaMemcpy(f.data(), launch_.faults, f.size() * sizeof(unsigned), cudaMemcpyDeviceToHost),
        "faults");
    return f;
  }

 private:
  template <class V> V* allocate(std::int64_t count) {
    V* to = nullptr;
    require(cudaMalloc(&to, static_cast<std::size_t>(count) * sizeof(V) + 1), "cudaMalloc");
    owned_.push_back(to);
    return to;
  }
  template <class V> V* upload(std::vector<V> const& from) {
    V* to = allocate<V>(static_cast<std::int64_t>(from.size()));
    require(cudaMemcpy(to, from.data(), from.size() * sizeof(V), cudaMemcpyHostToDevice), "copy");
    return to;
  }
  template <class D> void copy_table(Store const& store) {
    auto const& table = store.template table<D>();
    auto& held = launch_.tables.template of<D>();
    held.view.capacity = table.capacity();
    held.view.stride = table.capacity() * environments_;
    mpmpbd::for_each_field(mpmpbd::on_t<typename Store::List, D>{}, [&]<class F>(F) {
      static_cast<mpmpbd::detail::Plane<float, F>&>(held.view).data =
          upload(table.template planes<F>());
    });
    std::vector<std::int64_t> live;
    for (std::int64_t e = 0; e < environments_; ++e) live.push_back(table.live(e));
    held.live = upload(live);
  }
  typename Launch::Ctx context_of(Run& run, std::int64_t env, float dt) const {
    typename Launch::Ctx c{};
    c.lattice = run.lattice();
    c.tick = {dt, dt, 0};
    mpmpbd::for_each_type(typename Scene::Policies{}, [&]<class P>(std::type_identity<P>) {
      c.parameters.template get<P>() = run.state().template parameters<P>(env);
    });
    return c;
  }

  std::int64_t environments_;
  mpmpbd::Lattice<float> lattice_;
  Launch launch_{};
  std::vector<void*> owned_;
};

}  // namespace test
