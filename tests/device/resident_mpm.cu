// Tissue alone in the resident form: a block of the GPU gives what the serial back end gives, and the
// same bits for any number of environments and threads of a block.
#include <cuda_runtime.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <mpmpbd/backend/resident.cuh>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>

namespace {

using namespace mpmpbd;

struct Tissue : Mpm<NeoHookean> {};
struct Block : Scene<Tissue> {};
using Run = Simulation<Block, Serial, float>;
using Ctx = Context<float, Block::Policies>;
using ParticleFields = on_t<Run::Store::List, Particles>;
using ParticleView = View<float, ParticleFields>;

constexpr int substeps = 4;
constexpr float dt = 1e-3f;

void require(cudaError_t e, char const* what) {
  if (e == cudaSuccess) return;
  std::printf("%s: %s\n0 passed, 1 failed\n", what, cudaGetErrorString(e));
  std::exit(1);
}

// One step of one environment per block. Shared memory holds the grid; state stays in `particles`.
template <int threads>
__global__ void __launch_bounds__(threads, 1)
    step(ParticleView particles, Ctx const* contexts, int live, float heaviest, int count,
         unsigned* faults) {
  using P2G = ParticlesToGrid<Tissue, Block::Effects>;
  using G2P = GridToParticles<Tissue, Block::Effects>;
  using Nodes = MoveNodes<Tissue, Block::Effects>;
  extern __shared__ char memory[];
  Ctx const context = contexts[blockIdx.x];
  auto const unit = resident::FixedPoint::make(heaviest, context.lattice.dx, context.tick.dt);
  auto const arena = resident::Arena::at(memory, static_cast<int>(context.lattice.count()));
  resident::SharedWriter const sums{arena, context.lattice, unit};
  resident::SharedReader const nodes{arena, context.lattice};
  resident::Block<ParticleView> const block{particles, blockIdx.x * particles.capacity, live};

  arena.clear();
  __syncthreads();
  unsigned met = block.scatter<P2G>(sums, context);
  for (int s = 0; s < count; ++s) {
    __syncthreads();
    resident::move_nodes<Nodes>(arena, context, unit);
    __syncthreads();
    met |= s + 1 < count ? block.gather_scatter<G2P, P2G>(nodes, sums, context)
                         : block.gather<G2P>(nodes, context);
  }
  if (met != 0) atomicOr(faults + blockIdx.x, met);
}

std::vector<Vec3<double>> lattice_points() {
  std::vector<Vec3<double>> x;
  for (int k = 0; k < 22; ++k)
    for (int j = 0; j < 21; ++j)
      for (int i = 0; i < 43; ++i)
        x.push_back({{0.3 + 2.0 * (i + 0.5) / 43, 0.3 + (j + 0.5) / 21, 0.3 + (k + 0.5) / 22}});
  return x;
}

Run make_run(int environments, int capacity) {
  SimulationOptions options;
  options.environments = environments;
  options.cell_size = 0.1;
  options.nodes[0] = 26;
  options.nodes[1] = options.nodes[2] = 16;
  options.capacity = {{"particle", capacity}};
  options.substeps = substeps;
  Run run(options);
  run.set<NeoHookean>(lame(5e5, 0.4));
  auto const x = lattice_points();
  for (int e = 0; e < environments; ++e) {
    run.add_particles(e, x, 1000.0, 2.0 / double(x.size()));
    for (std::int64_t p = 0; p < run.state().table<Particles>().live(e); ++p) {
      auto const at = run.state().get<particle::Position>(e, p);
      float const a = 0.4f + 0.1f * float(e % 3);
      run.state().set<particle::Velocity>(e, p,
                                          {{a * sinf(3 * at[1]), -a * at[0], a * cosf(2 * at[2])}});
    }
  }
  return run;
}

// The particle planes of a run, on the device.
struct DeviceState {
  ParticleView view;
  std::vector<void*> owned;
  Ctx* contexts = nullptr;
  unsigned* faults = nullptr;

  explicit DeviceState(Run& run, std::vector<Ctx> const& host_contexts) {
    view.capacity = run.state().table<Particles>().capacity();
    view.stride = view.capacity * run.environments();
    for_each_field(ParticleFields{}, [&]<class F>(F) {
      auto const& plane = run.state().table<Particles>().template planes<F>();
      float* to = nullptr;
      require(cudaMalloc(&to, plane.size() * sizeof(float)), "cudaMalloc");
      require(cudaMemcpy(to, plane.data(), plane.size() * sizeof(float), cudaMemcpyHostToDevice),
              "copy");
      static_cast<detail::Plane<float, F>&>(view).data = to;
      owned.push_back(to);
    });
    require(cudaMalloc(&contexts, host_contexts.size() * sizeof(Ctx)), "cudaMalloc");
    require(cudaMemcpy(contexts, host_contexts.data(), host_contexts.size() * sizeof(Ctx),
                       cudaMemcpyHostToDevice),
            "copy");
    require(cudaMalloc(&faults, host_contexts.size() * sizeof(unsigned)), "cudaMalloc");
    require(cudaMemset(faults, 0, host_contexts.size() * sizeof(unsigned)), "memset");
  }
  DeviceState(DeviceState const&) = delete;
  DeviceState& operator=(DeviceState const&) = delete;
  ~DeviceState() {
    for (void* p : owned) cudaFree(p);
    cudaFree(contexts);
    cudaFree(faults);
  }
  template <class F> std::vector<float> read() const {
    std::vector<float> values(static_cast<std::size_t>(F::components * view.stride));
    require(cudaMemcpy(values.data(), view.plane<F>(), values.size() * sizeof(float),
                       cudaMemcpyDeviceToHost),
            "read");
    return values;
  }
};

template <int threads> void launch(Run& run, DeviceState& device, int count) {
  int const bytes = resident::Arena::bytes_per_node * int(run.lattice().count());
  require(cudaFuncSetAttribute(step<threads>, cudaFuncAttributeMaxDynamicSharedMemorySize, bytes),
          "shared memory");
  float const mass = run.state().get<particle::Mass>(0, 0);
  step<threads><<<unsigned(run.environments()), threads, std::size_t(bytes)>>>(
      device.view, device.contexts, int(run.state().table<Particles>().live(0)), mass, count,
      device.faults);
  require(cudaGetLastError(), "launch");
  require(cudaDeviceSynchronize(), "step");
}

std::vector<Ctx> contexts_of(Run& run) {
  Ctx c{};
  c.lattice = run.lattice();
  c.tick = {dt, dt, 0};
  c.parameters.get<NeoHookean>() = run.state().parameters<NeoHookean>(0);
  return std::vector<Ctx>(std::size_t(run.environments()), c);
}

double time_per_particle_substep(int environments, int count) {
  Run run = make_run(1, 19866);
  SimulationOptions options = run.options();
  options.environments = environments;
  Run many(options);
  for (int e = 0; e < environments; ++e) many.state().copy_environment(e, run.state(), 0);
  DeviceState device(many, contexts_of(many));
  launch<512>(many, device, count);
  std::vector<float> ms;
  for (int r = 0; r < 15; ++r) {
    cudaEvent_t a, b;
    cudaEventCreate(&a), cudaEventCreate(&b);
    cudaEventRecord(a);
    launch<512>(many, device, count);
    cudaEventRecord(b);
    cudaEventSynchronize(b);
    float t = 0;
    cudaEventElapsedTime(&t, a, b);
    ms.push_back(t);
    cudaEventDestroy(a), cudaEventDestroy(b);
  }
  std::sort(ms.begin(), ms.end());
  return 1e6 * ms[ms.size() / 2] / count / environments / 19866.0;
}

}  // namespace

int main() {
  int passed = 0, failed = 0;
  auto check = [&](bool ok, char const* what, double value) {
    std::printf("%s: %s (%.3g)\n", ok ? "pass" : "FAIL", what, value);
    ok ? ++passed : ++failed;
  };

  Run serial = make_run(3, 20000);
  DeviceState device(serial, contexts_of(serial)), narrow(serial, contexts_of(serial));
  launch<512>(serial, device, substeps);
  launch<256>(serial, narrow, substeps);
  serial.step(double(dt) * substeps);

  auto const x = device.read<particle::Position>(), v = device.read<particle::Velocity>();
  auto const& xs = serial.state().table<Particles>().planes<particle::Position>();
  auto const& vs = serial.state().table<Particles>().planes<particle::Velocity>();
  double worst_x = 0, worst_v = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    worst_x = std::max(worst_x, std::abs(double(x[i]) - xs[i]));
    worst_v = std::max(worst_v, std::abs(double(v[i]) - vs[i]));
  }
  // Fixed point at 2^-22 of a cell per substep at each of 27 nodes, some rounding of float beside it.
  check(worst_x < 4e-6, "positions equal the serial back end's [m]", worst_x);
  check(worst_v < 1e-3, "velocities equal the serial back end's [m/s]", worst_v);
  check(std::memcmp(x.data(), narrow.read<particle::Position>().data(), x.size() * sizeof(float)) ==
            0,
        "512 and 256 threads give the same bits", 0);

  Run alone = make_run(1, 20000);
  DeviceState single(alone, contexts_of(alone));
  launch<512>(alone, single, substeps);
  auto const x1 = single.read<particle::Position>();
  bool same = true;
  for (int c = 0; c < 3; ++c)
    same = same && std::memcmp(&x1[std::size_t(c) * 20000], &x[std::size_t(c) * 60000],
                               19866 * sizeof(float)) == 0;
  check(same, "an environment alone equals slot 0 of three, bit for bit", 0);

  for (int environments : {1, 132, 1056})
    std::printf("%d environments of 19866 particles, %d substeps: %.4f ns per particle-substep\n",
                environments, substeps, time_per_particle_substep(environments, substeps));
  std::printf("%d passed, %d failed\n", passed, failed);
  return failed == 0 ? 0 : 1;
}
