// Decisions per second of the suturing task: environments, material points, pictures.
//
// The expert sews, in as many threads as there are cores; a decision is 20 steps of the scene (0.08 s).
#include <benchmark/benchmark.h>

#include <filesystem>

#include <mpmpbd/catalog/suturing_task.hpp>
#include <mpmpbd/io/config.hpp>
#include <mpmpbd/rl/suturing/expert.hpp>

namespace {

using namespace mpmpbd;

struct Pictured : rl::SuturingWith<rl::NeedlePose, rl::TipAndMarkers, rl::StitchState,
                                   rl::CameraPicture, rl::RandomLook> {};

rl::SuturingTaskConfig config(std::string const& preset) {
  auto const scenes =
      std::filesystem::path(__FILE__).parent_path().parent_path() / "examples" / "scenes";
  return io::read_config<rl::SuturingTaskConfig>(
      std::vector<io::Path>{scenes / (preset + ".toml"), scenes / "suturing_task.toml"});
}

template <class Task> void decisions(benchmark::State& state, std::string const& preset) {
  auto const c = config(preset);
  rl::VectorEnv<Task, Threads> envs(c, {.num_envs = state.range(0)});
  rl::SuturingExperts experts(envs);
  for (auto _ : state) envs.step(experts.act(envs));
  state.counters["decisions"] = benchmark::Counter(
      static_cast<double>(envs.num_envs() * state.iterations()), benchmark::Counter::kIsRate);
  state.counters["points"] = static_cast<double>(c.scene.tissue.point_count());
}

void states(benchmark::State& state, std::string const& preset) {
  decisions<rl::SuturingTask>(state, preset);
}
void pictures(benchmark::State& state, std::string const& preset) {
  decisions<Pictured>(state, preset);
}

// A fixed number, so that all see the same: needle in the air, in tissue, thread behind it.
BENCHMARK_CAPTURE(states, coarse, "coarse")
    ->RangeMultiplier(2)
    ->Range(1, 32)
    ->Iterations(200)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pictures, coarse, "coarse")
    ->RangeMultiplier(4)
    ->Range(2, 8)
    ->Iterations(200)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(states, paper, "paper")
    ->RangeMultiplier(2)
    ->Range(1, 2)
    ->Iterations(100)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
