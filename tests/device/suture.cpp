// Threads without tissue on a GPU, driven by plain C++: they fall as on the host, hang as a catenary, and have the same bits
// in company and for any number of threads of a block.
#include <cmath>
#include <cstdio>
#include <limits>
#include <span>
#include <vector>

#include <mpmpbd/backend/cuda.hpp>
#include <mpmpbd/catalog.hpp>

#include "cuda/compare.hpp"
#include "cuda/threads.hpp"
#include "device/report.hpp"

namespace {

using namespace test;
using Scene_ = catalog::Suture;
using OnHost = Simulation<Scene_, Serial, float>;
using OnDevice = Simulation<Scene_, Cuda, float>;

void compare_with_host() {
  constexpr int steps = 10;
  auto host = with_arcs<OnHost>(2);
  auto device = with_arcs<OnDevice>(2);
  step_on(host, steps, step), step_on(device, steps, step);
  auto const apart = difference<bead::Position>(read(device), read(host));
  check(apart < arc_rounding(steps), "a falling thread is where it is on the host [m]", apart);
  for (std::int64_t env : {0, 1})
    check(device.status(env) == host.status(env), "the status is the host's", device.status(env));
}

// 300 environments have a warp each; one alone has a thread for every bead, or 128.
void compare_companies(int steps) {
  auto many = with_arcs<OnDevice>(300), again = with_arcs<OnDevice>(300);
  OnDevice one = with_arcs<OnDevice>(1), narrow = with_arcs<OnDevice>(1, Cuda{.threads = 128});
  auto alone = read(one);
  alone.copy_environment(0, read(many), 217);
  one.restore(alone), narrow.restore(alone);
  step_on(many, steps, step), step_on(again, steps, step), step_on(narrow, steps, step),
      step_on(one, steps, step);
  bool same = true;
  for (std::int64_t env = 0; env < 300; ++env)
    same = same && same_bits(read(many), env, read(again), env);
  check(same, "the same bits again");
  check(same_bits(read(many), 217, read(one), 0), "the same bits alone");
  check(same_bits(read(many), 217, read(narrow), 0), "and with fewer threads");

  again.reset();
  again.state().set<bead::Position>(5, 7, {{std::numeric_limits<float>::quiet_NaN(), 0, 0}});
  step_on(again, steps, step);
  bool unmoved = true;
  for (std::int64_t env = 0; env < 300; ++env)
    unmoved = unmoved && (env == 5 || read(again).get<bead::Position>(env, beads - 1) ==
                                          read(many).get<bead::Position>(env, beads - 1));
  check(has(again.status(5), Fault::not_finite), "a lost thread is frozen");
  check(unmoved, "its neighbours have come back and moved as before");
}

// Between two nails at equal height; it bends so little that it is a catenary, y = a cosh(x/a).
void compare_with_catenary() {
  constexpr int n = 41, steps = 2500;
  constexpr double l = 1.0, span = 0.6, settling = 3.0;
  OnDevice run(thread_options<Scene_>(1));
  double const drop = std::sqrt(square(l / 2) - square(span / 2));
  std::vector<Vec3<double>> const corner{vec(0.0, 0.0, 0.0), vec(span / 2, 0.0, -drop),
                                         vec(span, 0.0, 0.0)};
  RodAssembly<Scene_::Rods> rod;
  add_thread(rod, std::span<Vec3<double> const>(corner), n, RodMaterial{1e7, 1.15e-4, 1140.0});
  rod.prescribe(0), rod.prescribe(n - 1);
  rod.write(run.state(), 0);
  run.set<Gravity>({{0.0, 0.0, -9.81}});
  run.set<Damping>({settling});
  step_on(run, steps, step);

  double low = span / 100, high = 1e3 * l;
  for (int i = 0; i < 100; ++i) {
    double const a = 0.5 * (low + high);
    (2 * a * std::sinh(span / (2 * a)) > l ? low : high) = a;
  }
  double const sag = low * (std::cosh(span / (2 * low)) - 1);
  double const off = -read(run).get<bead::Position>(0, n / 2)[2] / sag - 1;
  check(std::fabs(off) < 1.5e-3, "a thread between two nails sags as a catenary, but for", off);
}

}  // namespace

// With any argument companies are together for two steps, and no thread comes to rest: for compute-sanitizer.
int main(int argc, char**) {
  bool const brief = argc > 1;
  compare_with_host();
  compare_companies(brief ? 2 : 25);
  if (!brief) compare_with_catenary();
  return report.end();
}
