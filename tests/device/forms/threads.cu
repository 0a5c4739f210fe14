// Threads without tissue on a GPU with solvers that the catalogue's scene has not: they fall as on the host, with the same bits
// for any number of threads of a block.
#include <cstdio>

#include "cuda/compare.hpp"
#include "cuda/threads.hpp"
#include "device/report.hpp"

#include <mpmpbd/backend/cuda/simulation.cuh>

namespace {

using namespace test;

template <class Scene> void compare(char const* scene) {
  constexpr int steps = 6;
  auto host = with_arcs<Simulation<Scene, Serial, float>>(2);
  auto device = with_arcs<Simulation<Scene, Cuda, float>>(2),
       narrow = with_arcs<Simulation<Scene, Cuda, float>>(2, Cuda{.threads = 128});
  for (int s = 0; s < steps; ++s) host.step(step), device.step(step), narrow.step(step);
  auto const x = difference<bead::Position>(read(device), read(host));
  check(x < arc_rounding(steps), scene, "where it is on the host [m]", x);
  for (std::int64_t env : {0, 1}) {
    check(device.status(env) == host.status(env), scene, "the host's status", device.status(env));
    check(same_bits(read(device), env, read(narrow), env), scene, "the same bits",
          narrow.status(env));
  }
}

}  // namespace

int main() {
  compare<Swept>("Gauss-Seidel");
  compare<Averaged>("Jacobi");
  compare<Framed>("frames");
  return report.end();
}
