// What a step of the suturing scene costs on a CUDA device: 20,000 particles, a needle in tissue, a thread of 20 beads.
//
// A row per number of environments and substeps; with contact, and without (the surface taken away: tissue, needle and
// thread move, and do not meet). Milliseconds per step, mean and standard deviation over blocks of steps, and
// nanoseconds per particle and substep.
// Usage: bench_device_throughput [resident|tiled] [threads=512] [bodies | ENVIRONMENTS...]
//
// bodies: one environment with larger blocks of tissue instead, without contact.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <mpmpbd/backend/cuda.hpp>
#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/catalog.hpp>
#include <mpmpbd/catalog/suturing_hand.hpp>

namespace {

using namespace mpmpbd;

using OnHost = Simulation<Suturing, Threads, float>;
using OnDevice = Simulation<Suturing, Cuda, float>;

// The paper's step sits at the stable limit at a density of 1000; with 4000 two substeps are legal.
// `scale`: of the block's edges, with as many particles per cell.
SuturingConfig config(int substeps, double scale = 1.0) {
  SuturingConfig c;
  for (int a = 0; a < 3; ++a) {
    double const spacing = c.tissue.spacing()[a];
    c.tissue.points[a] = static_cast<int>(std::lround(scale * c.tissue.points[a]));
    c.tissue.size[a] = spacing * c.tissue.points[a];
    c.domain.size[a] =
        c.domain.cell_size * (std::ceil(c.tissue.size[a] / c.domain.cell_size - 1e-6) + 5.0);
  }
  c.tissue.corner = {{0.25, 0.25, 0.25}};
  c.tissue.density = substeps == 2 ? 4000.0 : 1000.0;
  c.time.substeps = substeps;
  return c;
}

// One environment after `steps` of the scripted stitch.
OnHost stitch(SuturingConfig const& c, int steps, bool contact) {
  OnHost run(suturing::options(c));
  suturing::set_up(run, 0, c);
  if (!contact) suturing::uncouple(run, 0);
  suturing::ScriptedHand const hand{c.script()};
  double const h = c.time.step;
  for (int s = 0; s < steps; ++s) {
    hand.command(run, 0, s * h, h);
    run.step(h);
  }
  return run;
}

struct Milliseconds {
  double mean, deviation;
};

Milliseconds time_of_step(OnDevice& run, double h, int blocks, int steps) {
  std::vector<double> ms;
  for (int b = 0; b < blocks; ++b) {
    auto const begun = std::chrono::steady_clock::now();
    for (int s = 0; s < steps; ++s) run.step_where(h, nullptr);
    run.wait();
    std::chrono::duration<double, std::milli> const took = std::chrono::steady_clock::now() - begun;
    ms.push_back(took.count() / steps);
  }
  Milliseconds m{0.0, 0.0};
  for (double t : ms) m.mean += t / blocks;
  for (double t : ms) m.deviation += (t - m.mean) * (t - m.mean) / blocks;
  m.deviation = std::sqrt(m.deviation);
  return m;
}

void measure(SuturingConfig const& c, OnHost const& start, std::int64_t environments, bool contact,
             Cuda where) {
  OnDevice run(suturing::options(c, environments), where);
  for (std::int64_t env = 0; env < environments; ++env)
    run.state().copy_environment(env, start.state(), 0);
  run.remember();
  run.step_where(c.time.step, nullptr);  // the first launch loads the program
  run.reset();
  run.wait();
  auto const m = time_of_step(run, c.time.step, 5, environments > 200 ? 4 : 20);
  auto const particle_substeps = static_cast<double>(environments) * c.tissue.point_count() *
                                 static_cast<double>(c.time.substeps);
  std::printf("| %lld | %d | %d | %.0f | %s | %.4f +- %.4f | %.4f | %u |\n",
              static_cast<long long>(environments), c.tissue.point_count(), c.time.substeps,
              c.tissue.density, contact ? "yes" : "no", m.mean, m.deviation,
              1e6 * m.mean / particle_substeps, run.status(0));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::int64_t> counts;
  Cuda where;
  bool larger_bodies = false;
  for (int i = 1; i < argc; ++i) {
    std::string_view const word = argv[i];
    if (word == "resident")
      where.execution = Cuda::Execution::resident;
    else if (word == "tiled")
      where.execution = Cuda::Execution::tiled;
    else if (word.starts_with("threads="))
      where.threads = std::atoi(argv[i] + 8);
    else if (word == "bodies")
      larger_bodies = true;
    else
      counts.push_back(std::atoll(argv[i]));
  }
  constexpr int steps_to_tissue = 400;
  std::printf(
      "| environments | particles of each | substeps | density [kg/m^3] | contact | ms per step | ns per particle and substep | status |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  if (larger_bodies) {
    // 20 and 160 thousand, 1.3 and 4 million particles, before the needle has come near.
    for (double scale : {1.0, 2.0, 4.0, 5.85}) {
      auto const c = config(4, scale);
      measure(c, stitch(c, 0, false), 1, false, where);
    }
    return 0;
  }
  if (counts.empty()) counts = {1, 10, 132, 264, 528, 1056, 2112, 4224};
  for (int substeps : {2, 4}) {
    auto const c = config(substeps);
    for (bool contact : {true, false}) {
      auto const start = stitch(c, steps_to_tissue, contact);
      for (auto environments : counts) measure(c, start, environments, contact, where);
    }
  }
  return 0;
}
