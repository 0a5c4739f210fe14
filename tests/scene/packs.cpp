// Four particles at a time give the bits of one at a time: packs are a matter of speed alone.
#include "../catch.hpp"

#include <cstring>

#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/flip.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>
#include <mpmpbd/scene/simulation.hpp>

using namespace mpmpbd;

namespace {

// The same material, declared as one that branches: its scenes run one particle at a time.
struct BranchingNeoHookean : NeoHookean {
  static constexpr bool branch_free = false;
};

template <class... Policies> struct InPacks : Scene<Mpm<NeoHookean, Policies...>> {};
template <class... Policies> struct OneByOne : Scene<Mpm<BranchingNeoHookean, Policies...>> {};

template <class Scene, class Material> Simulation<Scene> twisted_block(double squeeze) {
  SimulationOptions options;
  options.cell_size = 4.1e-3;
  for (int& n : options.nodes) n = 16;
  options.capacity = {{"particle", 1400}};
  Simulation<Scene> sim(options);
  sim.template set<Material>(lame(2.7e4, 0.43));
  std::vector<Vec3<double>> x;
  for (int k = 0; k < 11; ++k)
    for (int j = 0; j < 11; ++j)
      for (int i = 0; i < 11; ++i)  // 1331: not a multiple of four
        x.push_back({{0.018 + 2.0e-3 * i, 0.018 + 2.1e-3 * j, 0.018 + 1.9e-3 * k}});
  sim.add_particles(0, x, 1060.0, 8e-9);
  for (std::int64_t p = 0; p < 1331; ++p) {
    auto const at = sim.state().template get<particle::Position>(0, p);
    sim.state().template set<particle::Velocity>(
        0, p, {{-9 * (at[1] - 0.028f), 9 * (at[0] - 0.028f), 3 * at[2]}});
    Mat3<float> F = Mat3<float>::identity();
    F(0, 0) = static_cast<float>(squeeze) + 3 * at[2];
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
  auto packs = twisted_block<InPacks<Policies...>, NeoHookean>(0.93);
  auto single = twisted_block<OneByOne<Policies...>, BranchingNeoHookean>(0.93);
  REQUIRE(same_particles(packs, single));
  for (int s = 0; s < 3; ++s) {
    packs.step(3e-4);
    single.step(3e-4);
    REQUIRE(same_particles(packs, single));
  }
  CHECK(packs.status(0) == single.status(0));
  CHECK(has(packs.status(0), Fault::inversion));
}

}  // namespace

TEST_CASE("packs of particles give the bits of single particles", "[scene][pack]") {
  packs_change_no_bit<>();
  packs_change_no_bit<CubicBSpline>();
  packs_change_no_bit<LinearBSpline>();
  packs_change_no_bit<Tpic, WeightGradient>();
  packs_change_no_bit<Flip>();
  packs_change_no_bit<WeightGradient>();
}
