// Particle-substeps per second on a CPU: quadratic MLS-APIC, neo-Hookean, float, about 20,000 particles.
//
// `single`: one particle at a time, the reference path. `packs`: four at a time, what a scene of branch-free
// policies runs by default. `threads/n`: the same on n threads, scatter included.
#include <benchmark/benchmark.h>

#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>

namespace {

using namespace mpmpbd;

struct BranchingNeoHookean : NeoHookean {
  static constexpr bool branch_free = false;
};
struct Packs : Scene<Mpm<NeoHookean>> {};
struct Single : Scene<Mpm<BranchingNeoHookean>> {};

constexpr int substeps = 8;

template <class Scene, class Material, class Backend>
Simulation<Scene, Backend> block(Backend backend) {
  SimulationOptions options;
  options.cell_size = 0.1;
  options.nodes[0] = 26;
  options.nodes[1] = options.nodes[2] = 16;
  options.capacity = {{"particle", 20000}};
  options.substeps = substeps;
  Simulation<Scene, Backend> sim(options, backend);
  sim.template set<Material>(lame(5e5, 0.4));
  std::vector<Vec3<double>> x;
  for (int k = 0; k < 22; ++k)
    for (int j = 0; j < 21; ++j)
      for (int i = 0; i < 43; ++i)
        x.push_back({{0.3 + 2.0 * (i + 0.5) / 43, 0.3 + (j + 0.5) / 21, 0.3 + (k + 0.5) / 22}});
  sim.add_particles(0, x, 1000.0, 2.0 / static_cast<double>(x.size()));
  for (std::int64_t p = 0; p < static_cast<std::int64_t>(x.size()); ++p) {
    auto const at = sim.state().template get<particle::Position>(0, p);
    sim.state().template set<particle::Velocity>(0, p,
                                                 {{at[1] - 0.8f, 0.8f - at[0], 0.1f * at[2]}});
  }
  return sim;
}

template <class Scene, class Material, class Backend>
void run(benchmark::State& state, Backend backend) {
  auto sim = block<Scene, Material>(backend);
  sim.remember();
  for (auto _ : state) {
    sim.step(8e-3);
    state.PauseTiming();
    if (sim.state().template get<environment::Step>(0) > 100) sim.reset();
    state.ResumeTiming();
  }
  double const particles = static_cast<double>(sim.state().template table<Particles>().live(0));
  state.counters["particle_substeps"] = benchmark::Counter(
      particles * substeps * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void single(benchmark::State& state) { run<Single, BranchingNeoHookean>(state, Serial{}); }
void packs(benchmark::State& state) { run<Packs, NeoHookean>(state, Serial{}); }
void threads(benchmark::State& state) {
  run<Packs, NeoHookean>(state, Threads{static_cast<int>(state.range(0))});
}

BENCHMARK(single)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(packs)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(threads)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
