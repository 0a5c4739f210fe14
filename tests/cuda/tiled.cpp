// The tiled form on an emulated device: it gives the bits of the resident form, and moves grids that no block holds.
// seconds: 18
#include <cmath>
#include <limits>

#include "catch.hpp"
#include "cuda/scenes.hpp"
#include "cuda/suturing.hpp"
#include "support/sanitized.hpp"

using namespace test;

namespace {

constexpr Cuda resident{.execution = Cuda::Execution::resident};
constexpr Cuda tiled{.execution = Cuda::Execution::tiled};
constexpr Cuda narrow{.threads = 160, .execution = Cuda::Execution::tiled};

template <class Run> bool same_everywhere(Run const& a, Run const& b) {
  bool same = true;
  for (std::int64_t env = 0; env < a.environments(); ++env)
    same = same && same_bits(read(a), env, read(b), env);
  return same;
}

// A grid far too large for the shared memory of a block, with the tissue of the small one.
template <class Scene> SimulationOptions large() {
  auto o = options<Scene>(2);
  for (int& n : o.nodes) n = 28;
  return o;
}
template <class Run> Run in_large_grid(auto... where) {
  Run run(large<typename Run::Scene>(), where...);
  for (std::int64_t env : {0, 1}) set_up(run, env);
  return run;
}

// The sentence with which a run is refused; empty where it is not.
std::string refusal(SimulationOptions const& o, Cuda where) {
  try {
    Simulation<Alone, Cuda, float> const run(o, where);
    return {};
  } catch (std::exception const& e) { return e.what(); }
}

}  // namespace

using AllScenes = kinds<Projected, Alone, Relaxing, Squeezed>;
TEMPLATE_LIST_TEST_CASE("a scene has the same bits in blocks' memory and in the device's",
                        "[cuda][tiled]", AllScenes) {
  using Run = Simulation<TestType, Cuda, float>;
  auto in_blocks = made<Run>(2, resident), on_device = made<Run>(2, tiled),
       other = made<Run>(2, narrow);
  for (Run* run : {&in_blocks, &on_device, &other}) {  // what is slowed down, held and counted
    run->state().template set<particle::Velocity>(1, 7, {{900.0f, 0.0f, 0.0f}});
    run->state().template set<particle::Position>(1, 11, {{-3.0f, 0.2f, 9.0f}});
  }
  auto const start = read(on_device);
  for (int s = 0; s < 3; ++s) {
    emulated::seed = 1;
    in_blocks.step(step);
    on_device.step(step);
    emulated::seed = 7;
    other.step(step);
  }
  CHECK_FALSE(same_bits(start, 0, read(on_device), 0));
  CHECK(has(on_device.status(1), Fault::speed));
  CHECK(has(on_device.status(1), Fault::escape));
  CHECK(same_everywhere(in_blocks, on_device));
  CHECK(same_everywhere(in_blocks, other));
}

TEST_CASE("needle, thread and tissue have the same bits in blocks' memory and in the device's",
          "[cuda][tiled]") {
  auto const c = config();
  auto in_blocks = device_run(1, resident), on_device = device_run(1, tiled);
  drive(in_blocks, c, steps_to_tissue, 2);
  drive(on_device, c, steps_to_tissue, 2);
  REQUIRE(norm(read(on_device).get<needle::Force>(0, 0)) > 100.0f);
  CHECK(same_everywhere(in_blocks, on_device));
}

// Two multiprocessors are emulated: three environments share them, and each has half of the memory near a block. What of a
// coupling does not fit into it lies in the device's.
TEST_CASE("how much memory a coupling finds near its block changes no bit", "[cuda][tiled]") {
  using Run = Simulation<Squeezed, Cuda, float>;
  auto const moved = [](std::int64_t environments) {
    auto run = made<Run>(environments, tiled);
    for (int s = 0; s < 2; ++s) run.step(step);
    return run;
  };
  emulated::shared_bytes_per_block = 6 << 10;
  auto const little = moved(3);
  emulated::shared_bytes_per_block = 232448;
  auto const shared = moved(3), plenty = moved(1);
  CHECK(same_everywhere(shared, little));
  CHECK(same_bits(read(shared), 0, read(plenty), 0));
}

// A resident step scatters while it still looks, in the hope that it will be like the one before; one in tiled form never hopes.
using TwoScenes = kinds<Relaxing, Squeezed>;
TEMPLATE_LIST_TEST_CASE("a step unlike the one before has the bits of one that expects nothing",
                        "[cuda][tiled][time_step]", TwoScenes) {
  using Run = Simulation<TestType, Cuda, float>;
  auto o = options<TestType>(2);
  o.substeps = 0;
  Run in_blocks(o, resident), on_device(o, tiled);
  auto const substeps_after = [&](int steps) {
    for (Run* run : {&in_blocks, &on_device})
      for (int s = 0; s < steps; ++s) run->step(step);
    return read(on_device).template get<environment::Substeps>(1, 0);
  };
  for (Run* run : {&in_blocks, &on_device})
    for (std::int64_t env : {0, 1}) set_up(*run, env);
  auto const few = substeps_after(2);
  for (Run* run : {&in_blocks, &on_device}) {
    run->state().template set<particle::Mass>(
        0, 5, 3.0f * run->state().template get<particle::Mass>(0, 5));
    run->template set<NeoHookean>(1, lame(2e6, 0.4));
  }
  CHECK(substeps_after(1) > few);
  CHECK(same_everywhere(in_blocks, on_device));
  substeps_after(2);
  CHECK(same_everywhere(in_blocks, on_device));
}

// Tissue alone is scattered while it is looked at.
using LostScenes = kinds<Alone, Squeezed>;
TEMPLATE_LIST_TEST_CASE("a particle set to infinity between two steps loses its environment alone",
                        "[cuda][tiled][status]", LostScenes) {
  using Run = Simulation<TestType, Cuda, float>;
  auto in_blocks = made<Run>(3, resident), on_device = made<Run>(3, tiled),
       whole = made<Run>(3, resident);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (Run* run : {&in_blocks, &on_device, &whole}) run->step(step);
  for (Run* run : {&in_blocks, &on_device}) {
    run->state().template set<particle::Position>(1, 7, {{infinity, 0.2f, 0.2f}});
    run->state().template set<particle::Position>(2, 9, {{0.2f, -infinity, std::nanf("")}});
  }
  for (Run* run : {&in_blocks, &on_device, &whole}) run->step(step);
  for (std::int64_t lost : {1, 2}) CHECK(has(in_blocks.status(lost), Fault::not_finite));
  CHECK(same_everywhere(in_blocks, on_device));
  CHECK(same_bits(read(in_blocks), 0, read(whole), 0));
}

// Numbers of a particle are finite, and what it brings to the grid in the third substep is not: no whole number stands for that.
template <int what> struct Broken {
  using Role = role::Effect;
  static constexpr FixedString name = "broken";
  static constexpr Slot slot = Slot::before_scatter;
  using Reads = Fields<particle::Position>;
  using Writes = Fields<particle::Acceleration>;
  template <class T> struct Parameters { T from; };  // [m] along x
  static constexpr std::array<ParameterInfo, 1> parameter_info{{bound::any("from", "m")}};
  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& p, K const& k, Tick<T> const& tick) {
    if (tick.substep != 2 || !(p[particle::Position{}][0] > k.from)) return;
    p[particle::Acceleration{}][1] +=
        what == 0 ? std::nanf("") : std::numeric_limits<T>::infinity();
  }
};
struct BrokenByNan : Scene<Smooth, Broken<0>, Gravity, Floor> {};
struct BrokenByInfinity : Scene<Smooth, Broken<1>, Gravity, Floor> {};
template <class Run> void set_from(Run& run, std::int64_t env, double from) {
  if constexpr (std::is_same_v<typename Run::Scene, BrokenByNan>)
    run.template set<Broken<0>>(env, {from});
  else
    run.template set<Broken<1>>(env, {from});
}
using BrokenScenes = kinds<BrokenByNan, BrokenByInfinity>;
TEMPLATE_LIST_TEST_CASE("a particle that brings no number loses its environment in that substep",
                        "[cuda][tiled][status]", BrokenScenes) {
  auto const moved = [](auto where) {
    Simulation<TestType, Cuda, float> run(options<TestType>(2), where);
    for (std::int64_t env : {0, 1}) {
      add_tissue(run, env);
      run.template set<StableNeoHookean>(env, lame(4e5, 0.4));
      run.template set<Gravity>(env, {{0.0, 0.0, -9.81}});
      set_from(run, env, env == 0 ? 0.5 : 1e9);
    }
    run.step(step);
    return run;
  };
  auto const in_blocks = moved(resident), on_device = moved(tiled);
  CHECK(has(in_blocks.status(0), Fault::not_finite));
  CHECK(read(in_blocks).template get<environment::Step>(0) == 3);
  CHECK(in_blocks.status(1) == 0);
  CHECK(same_everywhere(in_blocks, on_device));
}

TEST_CASE("what a particle brings is rounded to the nearest count", "[cuda][tiled]") {
  using Numbers = mpmpbd::cuda::NumbersOf<float>;
  for (float const a :
       {0.0f, 0.49f, 0.5f, 0.51f, 1.5f, 2.5f, 1234.5f, 99999.75f, 4194303.5f, Numbers::scale}) {
    CHECK(Numbers::nearest(a, 1.0f) == std::lrint(a));
    CHECK(Numbers::nearest(0.5f, -2 * a) == std::lrint(-a));
  }
}

// Four environments: one as it comes, one that is stiff and so takes more substeps, one that is lost in the middle of a
// step, one that a mask leaves out.
TEST_CASE("environments in tiled form do not feel each other", "[cuda][tiled][batch]") {
  using Run = Simulation<Squeezed, Cuda, float>;
  auto o = options<Squeezed>(4);
  o.substeps = 0;
  Run in_blocks(o, resident), on_device(o, tiled);
  std::vector<unsigned char> const mask{1, 1, 1, 0};
  for (Run* run : {&in_blocks, &on_device}) {
    for (std::int64_t env = 0; env < 4; ++env) set_up(*run, env);
    run->remember();
    run->set<NeoHookean>(1, lame(4e6, 0.4));
    run->state().set<bead::Velocity>(2, 4, {{1e30f, 0.0f, 0.0f}});
    for (int s = 0; s < 2; ++s) run->step(step, mask);
  }
  auto const start = made<Run>(4, tiled);
  CHECK(same_everywhere(in_blocks, on_device));
  CHECK(same_bits(read(start), 3, read(on_device), 3));
  auto const& state = read(on_device);
  CHECK(state.get<environment::Substeps>(1) > state.get<environment::Substeps>(0));
  CHECK(has(on_device.status(2), Fault::not_finite));
  CHECK(state.get<environment::Step>(2) > 0);
  CHECK(state.get<environment::Step>(2) < state.get<environment::Substeps>(2));

  // Nothing of the lost one is left in its grid.
  for (Run* run : {&in_blocks, &on_device}) {
    run->reset(mask);
    run->step(step);
  }
  CHECK(on_device.status(2) == 0);
  CHECK(same_everywhere(in_blocks, on_device));
}

using LargeScenes = kinds<Squeezed, Alone>;
TEMPLATE_LIST_TEST_CASE("a grid that no block holds moves on a device as it does on the host",
                        "[cuda][tiled]", LargeScenes) {
  auto host = in_large_grid<Simulation<TestType, Serial, float>>();
  auto device = in_large_grid<Simulation<TestType, Cuda, float>>();
  CHECK(device.execution().find("tiled: the grid of an environment takes ") == 0);
  int const steps = 3;
  for (int s = 0; s < steps; ++s) host.step(step), device.step(step);
  double const v = rounding<TestType>(steps);
  CHECK(difference<particle::Velocity>(read(device), read(host)) < v);
  CHECK(difference<particle::Position>(read(device), read(host)) < v * steps * step);
  if constexpr (TestType::has_rods) CHECK(difference<bead::Velocity>(read(device), read(host)) < v);
  for (std::int64_t env : {0, 1}) CHECK(device.status(env) == host.status(env));
}

// Two particles far from the others: their blocks have no tile for so large a box and add to the grid itself. In the other
// order they keep company with others.
TEST_CASE("sums by way of a tile and straight to the grid have the same bits", "[cuda][tiled]") {
  using Run = Simulation<Alone, Cuda, float>;
  std::int64_t const count = 20 * 12 * 10;
  auto run = in_large_grid<Run>(), turned_round = in_large_grid<Run>();
  run.state().set<particle::Position>(0, 5, {{0.97f, 0.98f, 0.9f}});
  run.state().set<particle::Position>(0, 2000, {{0.9f, 0.3f, 0.97f}});
  auto const same = [&]<class F>(F) {
    auto const &a = read(run), &b = read(turned_round);
    bool all = true;
    for (std::int64_t p = 0; p < count; ++p)
      all = all && a.get<F>(0, p) == b.get<F>(0, count - 1 - p);
    return all;
  };
  for (std::int64_t p = 0; p < count; ++p) {
    auto const q = count - 1 - p;
    turned_round.state().set<particle::Position>(0, q, read(run).get<particle::Position>(0, p));
    turned_round.state().set<particle::Velocity>(0, q, read(run).get<particle::Velocity>(0, p));
  }
  for (int s = 0; s < 2; ++s) run.step(step), turned_round.step(step);
  CHECK(run.status(0) == 0);
  CHECK(same(particle::Position{}));
  CHECK(same(particle::Velocity{}));
  CHECK(same(particle::Affine{}));
  CHECK(same(particle::Deformation{}));
}

// Sums of 64 bits leave a 2^22nd of the roundings. A gradient by slopes weighs those of a stencil's outermost nodes by
// slope / weight = 3 / f = 12 times as much with cubic splines at a quarter of a cell, where these particles lie; in float
// such nodes hold less than a count.
using DoubleScenes = kinds<Squeezed, Alone>;
TEMPLATE_LIST_TEST_CASE("a scene in double moves on a device as it does on the host",
                        "[cuda][tiled][double]", DoubleScenes) {
  auto host = made<Simulation<TestType, Serial, double>>(2);
  auto device = made<Simulation<TestType, Cuda, double>>(2);
  CHECK(device.execution().find("tiled: sums of double") == 0);
  int const steps = 3;
  for (int s = 0; s < steps; ++s) host.step(step), device.step(step);
  double const by_slopes = TestType::Body::Form::uses_moment ? 1.0 : 12.0;
  double const v = by_slopes * rounding<TestType>(steps) / double(1 << 22);
  CHECK(difference<particle::Velocity>(read(device), read(host)) < v);
  CHECK(difference<particle::Position>(read(device), read(host)) < v * steps * step);
  if constexpr (TestType::has_rods) CHECK(difference<bead::Velocity>(read(device), read(host)) < v);
  for (std::int64_t env : {0, 1}) CHECK(device.status(env) == host.status(env));
}

// Particles keep what the grid cannot see, so their roundings stay: two grids' in every substep.
using Precisions = kinds<float, double>;
TEMPLATE_LIST_TEST_CASE("FLIP moves on a device as it does on the host", "[cuda][tiled][flip]",
                        Precisions) {
  auto host = made<Simulation<Splashing, Serial, TestType>>(2);
  auto device = made<Simulation<Splashing, Cuda, TestType>>(2),
       other = made<Simulation<Splashing, Cuda, TestType>>(2, narrow);
  for (auto* run : {&device, &other}) CHECK(run->execution().find("tiled: FLIP") == 0);
  int const steps = 3;
  for (int s = 0; s < steps; ++s) host.step(step), device.step(step), other.step(step);
  double const v = std::sqrt(2.0) * rounding<Splashing>(steps) *
                   double(cuda::FixedPoint<float>::scale / cuda::FixedPoint<TestType>::scale);
  CHECK(difference<particle::Velocity>(read(device), read(host)) < v);
  CHECK(difference<particle::Position>(read(device), read(host)) < v * steps * step);
  CHECK(same_everywhere(device, other));
  for (std::int64_t env : {0, 1}) CHECK(device.status(env) == host.status(env));
}

// Neither grid wraps: a particle brings no more than a cell per substep to both, and FLIP leaves it 0.95 of what is beyond.
TEST_CASE("FLIP of what is far too fast stays whole on a device", "[cuda][tiled][flip]") {
  auto run = made<Simulation<Splashing, Cuda, float>>(1);
  auto const cell = float(dx * substeps / step);  // [m/s]
  for (std::int64_t p = 0; p < 20 * 12 * 10; ++p)
    run.state().set<particle::Velocity>(0, p, {{200.0f * cell, 0.0f, 0.0f}});
  run.step(step);
  CHECK(has(run.status(0), Fault::speed));
  CHECK_FALSE(has(run.status(0), Fault::not_finite));
  double const left = 1.0 + std::pow(0.95, substeps) * 199.0;  // [cells per substep]
  float least = 1e9f, most = 0.0f;
  for (std::int64_t p = 0; p < 20 * 12 * 10; ++p) {
    auto const v = read(run).get<particle::Velocity>(0, p);
    least = std::min(least, v[0] / cell);
    most = std::max(most, v[0] / cell);
  }
  CHECK(least > left - 4.0);
  CHECK(most < left + 4.0);
}

TEST_CASE("a step in tiled form is a row of launches and takes no memory",
          "[cuda][tiled][resources]") {
  auto run = made<Simulation<Alone, Cuda, float>>(2, tiled);
  run.step(step);
  int const launches = emulated::launches, allocations = emulated::allocations;
  int const waits = emulated::waits;
  for (int s = 0; s < 2; ++s) run.step_where(step, nullptr);
  CHECK(emulated::launches == launches + 2 * (5 + 3 * substeps));
  CHECK(emulated::allocations == allocations);
  CHECK(emulated::waits == waits);
}

TEST_CASE("a row of launches that is broken off leaves nothing after a reset",
          "[cuda][tiled][refusal]") {
  auto run = made<Simulation<Alone, Cuda, float>>(2, tiled);
  auto whole = made<Simulation<Alone, Cuda, float>>(2, tiled);
  for (auto* one : {&run, &whole}) one->remember();
  for (int refused : {1, 5, 6, 8}) {  // sums are under way before the nodes of a substep
    emulated::refused_launch = emulated::launches + refused;
    CHECK_THROWS_WITH(run.step(step), Catch::Contains("launching a step"));
  }
  for (auto* one : {&run, &whole}) {
    one->reset();
    one->step(step);
  }
  CHECK(same_everywhere(run, whole));
}

TEST_CASE("the form of execution follows from the device, unless it is asked for",
          "[cuda][tiled][refusal]") {
  using Run = Simulation<Alone, Cuda, float>;
  auto const small = options<Alone>(2);
  CHECK(Run(small).execution().find("resident: ") == 0);
  CHECK(Run(small, tiled).execution().find("tiled, as asked for: ") == 0);
  emulated::multiprocessors = 5;
  auto const of_particles = [](std::int64_t environments, std::int64_t particles) {
    auto o = options<Alone>(environments);
    for (auto& c : o.capacity)
      if (c.domain == Particles::name.view()) c.slots = particles;
    return o;
  };
  CHECK_THAT(Run(of_particles(2, 16001)).execution(),
             Catch::Contains("tiled: with a block for each environment 2 of 5 multiprocessors"));
  CHECK(Run(of_particles(2, 16001), resident).execution().find("resident: ") == 0);
  CHECK(Run(of_particles(2, 16000)).execution().find("resident: ") == 0);
  CHECK(Run(of_particles(3, 99999)).execution().find("resident: ") == 0);
  emulated::multiprocessors = 2;
  emulated::shared_bytes_per_block = 65536;  // as on sm_75
  CHECK(Run(small).execution().find("tiled: ") == 0);
  int const allocations = emulated::allocations;
  CHECK(refusal(small, resident).find("65536 of shared memory") != std::string::npos);
  emulated::shared_bytes_per_block = 232448;
  CHECK(refusal(large<Alone>(), resident).find("or tiled execution") != std::string::npos);
  auto vast = small;
  for (int& n : vast.nodes) n = 1024;
  CHECK(refusal(vast, {}).find("1073741824 nodes") != std::string::npos);
  // States and grids are asked for at once: more than there is for all of them takes nothing.
  CHECK_THROWS_WITH((Simulation<Alone, Cuda, double>(small, resident)),
                    Catch::Contains("resident execution asked for"));
  emulated::free_bytes = 2 * 32 * 28 * 28 * 28;
  CHECK(refusal(large<Alone>(), {}).find("MiB needed") != std::string::npos);
  emulated::free_bytes = std::size_t{1} << 34;
  CHECK(emulated::allocations == allocations);
}
