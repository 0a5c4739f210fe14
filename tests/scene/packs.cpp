// Kernels on packs, chosen at run time, give the bits of the plain ones: vectors are a matter of speed alone.
#include "../catch.hpp"

#include <cstring>

#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/flip.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>
#include <mpmpbd/scene/simulation.hpp>

using namespace mpmpbd;

namespace {

template <class... Policies> struct Block : Scene<Mpm<NeoHookean, Policies...>> {};

template <class Scene, class Backend> Simulation<Scene, Backend> twisted_block(Backend backend) {
  SimulationOptions options;
  options.cell_size = 4.1e-3;
  for (int& n : options.nodes) n = 16;
  options.capacity = {{"particle", 1400}};
  Simulation<Scene, Backend> sim(options, backend);
  sim.template set<NeoHookean>(lame(2.7e4, 0.43));
  std::vector<Vec3<double>> x;
  for (int k = 0; k < 11; ++k)
    for (int j = 0; j < 11; ++j)
      for (int i = 0; i < 11; ++i)  // 1331: not a multiple of eight
        x.push_back({{0.018 + 2.0e-3 * i, 0.018 + 2.1e-3 * j, 0.018 + 1.9e-3 * k}});
  sim.add_particles(0, x, 1060.0, 8e-9);
  for (std::int64_t p = 0; p < 1331; ++p) {
    auto const at = sim.state().template get<particle::Position>(0, p);
    sim.state().template set<particle::Velocity>(
        0, p, {{-9 * (at[1] - 0.028f), 9 * (at[0] - 0.028f), 3 * at[2]}});
    Mat3<float> F = Mat3<float>::identity();
    F(0, 0) = 0.93f + 3 * at[2];
    F(0, 1) = 7 * at[1];
    if (p % 97 == 0) F(2, 2) = -0.1f;  // some inverted: the branch of the material
    sim.state().template set<particle::Deformation>(0, p, F);
  }
  return sim;
}

template <class A, class B> bool same_particles(A const& a, B const& b) {
  bool same = true;
  for_each_field(on_t<typename A::Store::List, Particles>{}, [&]<class F>(F) {
    auto const& p = a.state().template table<Particles>().template planes<F>();
    auto const& q = b.state().template table<Particles>().template planes<F>();
    same = same && std::memcmp(p.data(), q.data(), p.size() * sizeof(p[0])) == 0;
  });
  return same;
}

template <class... Policies> void packs_change_no_bit() {
  auto packs = twisted_block<Block<Policies...>>(Serial{});
  auto plain = twisted_block<Block<Policies...>>(Serial{Kernels::plain});
  for (int s = 0; s < 3; ++s) {
    packs.step(3e-4);
    plain.step(3e-4);
    REQUIRE(same_particles(packs, plain));
  }
  CHECK(packs.status(0) == plain.status(0));
  CHECK(has(packs.status(0), Fault::inversion));
}

}  // namespace

TEST_CASE("packs of particles give the bits of single particles", "[scene][pack]") {
  if (!has_wide_vectors())
    WARN("no wide vectors on this machine: both sides run the plain kernels");
  packs_change_no_bit<>();
  packs_change_no_bit<CubicBSpline>();
  packs_change_no_bit<LinearBSpline>();
  packs_change_no_bit<Tpic, WeightGradient>();
  packs_change_no_bit<Flip>();
  packs_change_no_bit<WeightGradient>();
}

TEST_CASE("packs on threads give the bits of single particles", "[scene][pack]") {
  auto packs = twisted_block<Block<>>(Threads{2});
  auto plain = twisted_block<Block<>>(Serial{Kernels::plain});
  packs.step(3e-4);
  plain.step(3e-4);
  CHECK(same_particles(packs, plain));
}

TEST_CASE("a pack holds the one of its particles that leaves", "[scene][pack]") {
  auto const leave = [](Kernels kernels) {
    auto sim = twisted_block<Block<>>(Serial{kernels});
    sim.state().set<particle::Position>(0, 42, {{2.2e-3f, 0.03f, 0.03f}});
    sim.state().set<particle::Velocity>(0, 42, {{-2.0f, 0.0f, 0.0f}});
    sim.step(3e-4);
    return sim;
  };
  auto const packs = leave(Kernels::widest), plain = leave(Kernels::plain);
  CHECK(same_particles(packs, plain));
  CHECK(packs.status(0) == plain.status(0));
  CHECK(has(packs.status(0), Fault::escape));
}
