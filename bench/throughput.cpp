// Particle-substeps per second on a CPU: quadratic MLS-APIC, neo-Hookean, float, about 20,000 particles.
//
// `plain`: one particle at a time, the reference path. `widest`: the kernels that a run takes by default.
// `threads/n`: the same on n threads, scatter included. `paths` takes a step of each in turn, so that what
// else the machine does falls on all of them, and gives the ratios of their fastest steps.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>

namespace {

using namespace mpmpbd;

struct Block : Scene<Mpm<NeoHookean>> {};

constexpr int substeps = 8;
constexpr double step_length = 8e-3;  // [s]
constexpr std::int64_t remembered = 100;

template <class Backend> class Run {
 public:
  explicit Run(Backend backend) : sim_(options(), backend) {
    sim_.template set<NeoHookean>(lame(5e5, 0.4));
    std::vector<Vec3<double>> x;
    for (int k = 0; k < 22; ++k)
      for (int j = 0; j < 21; ++j)
        for (int i = 0; i < 43; ++i)
          x.push_back({{0.3 + 2.0 * (i + 0.5) / 43, 0.3 + (j + 0.5) / 21, 0.3 + (k + 0.5) / 22}});
    sim_.add_particles(0, x, 1000.0, 2.0 / static_cast<double>(x.size()));
    for (std::int64_t p = 0; p < particles(); ++p) {
      auto const at = sim_.state().template get<particle::Position>(0, p);
      sim_.state().template set<particle::Velocity>(0, p,
                                                    {{at[1] - 0.8f, 0.8f - at[0], 0.1f * at[2]}});
    }
    sim_.remember();
  }

  std::int64_t particles() const { return sim_.state().template table<Particles>().live(0); }
  double particle_substeps() const { return static_cast<double>(particles() * substeps); }

  void step() { sim_.step(step_length); }
  // Back to the start before the block has moved far.
  void rewind() {
    if (sim_.state().template get<environment::Step>(0) > remembered) sim_.reset();
  }

 private:
  static SimulationOptions options() {
    SimulationOptions options;
    options.cell_size = 0.1;
    options.nodes[0] = 26;
    options.nodes[1] = options.nodes[2] = 16;
    options.capacity = {{"particle", 20000}};
    options.substeps = substeps;
    return options;
  }

  Simulation<Block, Backend> sim_;
};

template <class Backend> void steps(benchmark::State& state, Backend backend) {
  Run<Backend> run(backend);
  for (auto _ : state) {
    run.step();
    state.PauseTiming();
    run.rewind();
    state.ResumeTiming();
  }
  state.counters["particle_substeps"] =
      benchmark::Counter(run.particle_substeps() * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}
void plain(benchmark::State& state) { steps(state, Serial{Kernels::plain}); }
void widest(benchmark::State& state) { steps(state, Serial{}); }
void threads(benchmark::State& state) { steps(state, Threads{static_cast<int>(state.range(0))}); }

// A run and its fastest step.
template <class Backend> struct Timed {
  Run<Backend> run;
  double best = 1e30;  // [s]

  void step() {
    using Clock = std::chrono::steady_clock;
    auto const start = Clock::now();
    run.step();
    best = std::min(best, std::chrono::duration<double>(Clock::now() - start).count());
    run.rewind();
  }
  double rate() const { return run.particle_substeps() / best; }
};
void paths(benchmark::State& state) {
  Timed<Serial> plain{Run(Serial{Kernels::plain})}, widest{Run(Serial{})};
  Timed<Threads> one{Run(Threads{1})}, two{Run(Threads{2})};
  for (auto _ : state) {
    plain.step();
    widest.step();
    one.step();
    two.step();
  }
  state.counters["plain/s"] = plain.rate();
  state.counters["widest/s"] = widest.rate();
  state.counters["two_threads/s"] = two.rate();
  state.counters["widest:plain"] = widest.rate() / plain.rate();
  state.counters["two_threads:one"] = two.rate() / one.rate();
}

BENCHMARK(paths)->Unit(benchmark::kMillisecond)->UseRealTime()->MinTime(5);
BENCHMARK(plain)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(widest)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(threads)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
