// The catalogue's tissue without needle and thread on a GPU, driven by plain C++: a block that falls on its floor moves as on the
// host, and has the same bits in company, alone, and in tiled form.
#include <cmath>
#include <cstdio>
#include <vector>

#include <mpmpbd/backend/cuda.hpp>
#include <mpmpbd/catalog.hpp>

#include "cuda/compare.hpp"
#include "cuda/fixed_point_noise.hpp"
#include "device/report.hpp"

namespace {

using namespace mpmpbd;
using test::check;
using test::difference;
using test::read;
using test::same_bits;
using test::step_on;
using OnHost = Simulation<catalog::Tissue, Serial, float>;
using OnDevice = Simulation<catalog::Tissue, Cuda, float>;

constexpr double dx = 3.7e-3, step = 4e-4;
constexpr int substeps = 4, across = 12;  // particles along each edge, two per cell

// Environments that fall at different speeds.
template <class Run> Run falling(std::int64_t environments, auto... where) {
  Run run({.environments = environments,
           .cell_size = dx,
           .nodes = {13, 13, 13},
           .capacity = {{"particle", across * across * across}},
           .substeps = substeps},
          where...);
  run.template set<NeoHookean>(lame(1e4, 0.4));
  run.template set<Gravity>({{0.0, 0.0, -9.81}});
  run.template set<Viscosity>({2e-3});
  run.template set<catalog::Bottom>({3 * dx});
  std::vector<Vec3<double>> x;
  for (int k = 0; k < across; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i)
        x.push_back(dx * vec(3.25 + 0.5 * i, 3.25 + 0.5 * j, 3.25 + 0.5 * k));
  for (std::int64_t env = 0; env < environments; ++env) {
    run.add_particles(env, x, 1050.0, dx * dx * dx / 8);
    for (std::int64_t p = 0; p < static_cast<std::int64_t>(x.size()); ++p)
      run.state().template set<particle::Velocity>(env, p,
                                                   {{0.02f, 0.0f, -0.01f * float(env % 7)}});
  }
  return run;
}
void compare_with_host() {
  constexpr int steps = 10;
  auto host = falling<OnHost>(2);
  auto device = falling<OnDevice>(2);
  step_on(host, steps, step), step_on(device, steps, step);
  double const v = test::fixed_point_noise(dx, step / substeps, steps * substeps);
  double const off = difference<particle::Velocity>(read(device), read(host));
  check(off < v, "velocities are the host's, of what is allowed", off / v);
  double const apart = difference<particle::Position>(read(device), read(host));
  check(apart < v * steps * step, "positions", apart / (v * steps * step));
  for (std::int64_t env : {0, 1})
    check(device.status(env) == host.status(env), "the status is the host's", device.status(env));
}

void compare_companies() {
  auto many = falling<OnDevice>(150);
  auto one = falling<OnDevice>(1),
       tiled = falling<OnDevice>(1, Cuda{.execution = Cuda::Execution::tiled});
  auto alone = read(one);
  alone.copy_environment(0, read(many), 117);
  one.restore(alone), tiled.restore(alone);
  step_on(many, 5, step), step_on(one, 5, step), step_on(tiled, 5, step);
  check(same_bits(read(many), 117, read(one), 0), "the same bits alone");
  check(same_bits(read(many), 117, read(tiled), 0), "and in tiled form");
}

}  // namespace

int main() {
  compare_with_host();
  compare_companies();
  return test::report.end();
}
