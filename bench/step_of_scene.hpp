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
#include <mpmpbd/testing/worst.hpp>

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

using Points = std::vector<Vec3<double>>;  // [m]
inline Points points_of_tissue() {
  Points x;
  for (int k = 0; k < 22; ++k)
    for (int j = 0; j < 21; ++j)
      for (int i = 0; i < 43; ++i)
        x.push_back({{0.3 + 2.0 * (i + 0.5) / 43, 0.3 + (j + 0.5) / 21, 0.3 + (k + 0.5) / 22}});
  return x;
}
template <class Run> void add_tissue(Run& run) {
  run.add_particles(0, std::span<Vec3<double> const>(points_of_tissue()), 1000.0, 2.0 / particles);
}
template <class Run> void add_thread_through(Run& run) {
  Points line;
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

// As many copies of one environment as are asked for, a step after their start. `set` gives environment 0 its parameters.
template <class Scene, class Scalar = float, class Set>
Simulation<Scene, Cuda, Scalar> started(std::int64_t environments, Set const& set,
                                        Cuda where = {}) {
  Simulation<Scene, Cuda, Scalar> run(options<Scene>(environments), where);
  set(run);
  add_tissue(run);
  if constexpr (Scene::has_rods) add_thread_through(run);
  for (std::int64_t env = 1; env < environments; ++env) run.clone(0, env);
  run.step(step);
  run.wait();
  return run;
}

// Nanoseconds per particle and substep: mean and standard deviation of five blocks of four steps.
struct StepTime {
  double mean, deviation;
};
template <class Run> StepTime time_of_steps(Run& run, std::int64_t environments) {
  constexpr int blocks = 5, steps = 4;
  double mean = 0.0, square = 0.0;
  for (int b = 0; b < blocks; ++b) {
    double const begun = now();
    for (int s = 0; s < steps; ++s) run.step(step);
    run.wait();
    double const ns = (now() - begun) / steps / substeps / double(environments) / particles;
    mean += ns / blocks, square += ns * ns / blocks;
  }
  return {mean, std::sqrt(std::fmax(square - mean * mean, 0.0))};
}

template <class Run> void require_no_fault(Run& run) {
  if (run.status(0) == 0) return;
  std::fprintf(stderr, "status %u\n", run.status(0));
  std::exit(1);
}

// For as many environments as the program is told.
template <class Scene, class Set> int print_step_time(int argc, char** argv, Set const& set) {
  std::int64_t const environments = argc > 1 ? std::atoll(argv[1]) : 1056;
  auto run = started<Scene>(environments, set);
  auto const time = time_of_steps(run, environments);
  require_no_fault(run);
  std::printf("%.4f %.4f\n", time.mean, time.deviation);
  return 0;
}

// What a precision costs, in one form, and where the particles of an environment are after all steps.
struct OfPrecision {
  StepTime few, many;
  Points positions;
};
inline constexpr std::int64_t few = 132, many = 1056;

template <class Scene, class Scalar, class Set>
OfPrecision measure_precision(Cuda::Execution form, Set const& set) {
  OfPrecision found;
  Cuda const where{.execution = form};
  {
    auto run = started<Scene, Scalar>(few, set, where);
    found.few = time_of_steps(run, few);
    require_no_fault(run);
    auto const& state = run.state();
    for (int p = 0; p < particles; ++p) {
      auto const x = state.template get<particle::Position>(0, p);
      found.positions.push_back({{double(x[0]), double(x[1]), double(x[2])}});
    }
  }
  auto run = started<Scene, Scalar>(many, set, where);
  found.many = time_of_steps(run, many);
  require_no_fault(run);
  return found;
}

inline double largest_distance(Points const& a, Points const& b) {  // [m]
  testing::Worst worst;
  for (std::size_t p = 0; p < a.size(); ++p) worst.include(norm(a[p] - b[p]));
  return worst.value();
}

// A line each of float, resident and tiled, and of double: times, and how far a particle is at most from its start and from
// where double has it.
template <class Scene, class Set> int print_precisions(int, char**, Set const& set) {
  using Form = Cuda::Execution;
  auto const exact = measure_precision<Scene, double>(Form::tiled, set);
  auto const print = [&](char const* name, OfPrecision const& of) {
    std::printf("%s,%.4f,%.4f,%.4f,%.4f,%.2g,%.2g\n", name, of.few.mean, of.few.deviation,
                of.many.mean, of.many.deviation, largest_distance(of.positions, points_of_tissue()),
                largest_distance(of.positions, exact.positions));
  };
  print("float,resident", measure_precision<Scene, float>(Form::resident, set));
  print("float,tiled", measure_precision<Scene, float>(Form::tiled, set));
  print("double,tiled", exact);
  return 0;
}

}  // namespace mpmpbd::measured
