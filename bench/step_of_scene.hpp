// What a step of a scene costs on a CUDA device: a block of tissue of 19,866 particles in every environment, as in
// tests/device/forms/resident.cu, and a thread of 20 beads drawn through it where the scene has threads. Needle and surface of a scene
// that knows them are not there.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <span>
#include <vector>

#include <mpmpbd/backend/cuda/simulation.cuh>
#include <mpmpbd/coupling/embedded_fields.hpp>
#include <mpmpbd/mpm/materials/lame.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>

namespace mpmpbd::measured {

inline constexpr int beads = 20, substeps = 4, particles = 43 * 21 * 22;
inline constexpr double step = 0.004;

template <class Scene> SimulationOptions options(std::int64_t environments) {
  SimulationOptions o;
  o.environments = environments;
  o.cell_size = 0.1;
  o.nodes[0] = 26;
  o.nodes[1] = o.nodes[2] = 16;
  o.substeps = substeps;
  for_each_type(
      typename State<float, typename Scene::StateFields>::Domains{},
      [&]<class D>(std::type_identity<D>) {
        if constexpr (!std::is_same_v<D, Environments>)
          o.capacity.push_back({D::name.view(), std::is_same_v<D, Particles> ? particles : beads});
      });
  return o;
}

template <class Run> void add_tissue(Run& run) {
  std::vector<Vec3<double>> x;
  for (int k = 0; k < 22; ++k)
    for (int j = 0; j < 21; ++j)
      for (int i = 0; i < 43; ++i)
        x.push_back({{0.3 + 2.0 * (i + 0.5) / 43, 0.3 + (j + 0.5) / 21, 0.3 + (k + 0.5) / 22}});
  run.add_particles(0, std::span<Vec3<double> const>(x), 1000.0, 2.0 / particles);
}
template <class Run> void add_thread_through(Run& run) {
  std::vector<Vec3<double>> line;
  for (int k = 0; k < beads; ++k) {
    double const s = double(k) / (beads - 1) - 0.5;
    line.push_back({{1.31 + 1.6 * s, 0.82 + 0.07 * s, 1.22 - 0.32 * std::cos(2.4 * s)}});
  }
  RodAssembly<typename Run::Scene::Rods> rod;
  add_thread(rod, std::span<Vec3<double> const>(line), RodMaterial{2e6, 0.006, 1140.0},
             RestShape::as_placed);
  rod.write(run.state(), 0);
  run.state().template table<ContactPoints>().set_live(0, beads);
}

// Wall time [ns].
inline double now() {
  std::timespec t{};
  std::timespec_get(&t, TIME_UTC);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

// Prints nanoseconds per particle and substep, mean and standard deviation of five blocks of steps, for as many environments as
// the program is told. `set` gives environment 0 its parameters.
template <class Scene, class Set> int print_step_time(int argc, char** argv, Set const& set) {
  std::int64_t const environments = argc > 1 ? std::atoll(argv[1]) : 1056;
  constexpr int blocks = 5, steps = 4;
  Simulation<Scene, Cuda, float> run(options<Scene>(environments));
  set(run);
  add_tissue(run);
  if constexpr (Scene::has_rods) add_thread_through(run);
  for (std::int64_t env = 1; env < environments; ++env) run.clone(0, env);
  run.step(step);
  run.wait();
  double mean = 0.0, square = 0.0;
  for (int b = 0; b < blocks; ++b) {
    double const begun = now();
    for (int s = 0; s < steps; ++s) run.step(step);
    run.wait();
    double const ns = (now() - begun) / steps / substeps / double(environments) / particles;
    mean += ns / blocks, square += ns * ns / blocks;
  }
  if (run.status(0) != 0) return std::fprintf(stderr, "status %u\n", run.status(0)), 1;
  std::printf("%.4f %.4f\n", mean, std::sqrt(std::fmax(square - mean * mean, 0.0)));
  return 0;
}

}  // namespace mpmpbd::measured
