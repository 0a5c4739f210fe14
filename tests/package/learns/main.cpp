// A block that an agent may push upwards: all that a task needs.
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/rl/vector_env.hpp>

namespace school {
using namespace mpmpbd;

struct Block : Scene<Mpm<NeoHookean>> {};

struct Push {
  using Role = role::Action;
  static constexpr FixedString name = "push";
  static constexpr int size = 1;
  using Reads = Fields<>;
  using Writes = Fields<particle::Velocity>;
  template <class Env, class Ctx>
  MPMPBD_HD static void apply(Env const& env, Ctx const&, float const* action, double h) {
    using T = typename Env::Scalar;
    for (std::int64_t i = 0; i < env.template live<Particles>(); ++i)
      env.template set<particle::Velocity>(
          i, env.template get<particle::Velocity>(i) + T(h) * vec(T(0), T(0), T(action[0])));
  }
};
template <class Env> MPMPBD_HD auto height(Env const& env) {
  return env.template get<particle::Position>(0)[2];
}
struct Height {
  using Role = role::Observation;
  static constexpr FixedString name = "height";
  static constexpr int size = 1;
  using Reads = Fields<particle::Position>;
  using Writes = Fields<>;
  template <class Env, class Ctx>
  MPMPBD_HD static void observe(Env const& env, Ctx const&, float* out) {
    *out = static_cast<float>(height(env));
  }
};
struct Up {
  using Role = role::RewardTerm;
  static constexpr FixedString name = "up";
  using Reads = Fields<particle::Position>;
  using Writes = Fields<>;
  template <class Env, class Ctx> MPMPBD_HD static auto value(Env const& env, Ctx const&) {
    return height(env);
  }
};

struct Lift : rl::Task<Block, Push, Height, Up> {
  struct Config {
    rl::EpisodeConfig episode;
  };
  static SimulationOptions options(Config const&, std::int64_t environments) {
    return {.environments = environments,
            .cell_size = 0.1,
            .nodes = {11, 11, 11},
            .capacity = {{"particle", 8}}};
  }
  static double step_time(Config const&) { return 0.002; }
  template <class Sim> static void set_up(Sim& sim, std::int64_t env, Config const&) {
    std::vector<Vec3<double>> points;
    for (int i = 0; i < 8; ++i)
      points.push_back(vec(0.5, 0.5, 0.4) + 0.05 * vec<double>(i % 2, i / 2 % 2, i / 4));
    sim.template set<NeoHookean>(env, lame(1e4, 0.3));
    sim.add_particles(env, points, 1000.0, 1.25e-4);
  }
};

}  // namespace school

int main() {
  mpmpbd::rl::VectorEnv<school::Lift> envs({}, {.num_envs = 2});
  std::vector<float> const up{1.0f, 0.0f};
  float const before = envs.newest<school::Height>(0)[0];
  for (int i = 0; i < 3; ++i) envs.step(up);
  bool const lifted = envs.newest<school::Height>(0)[0] > before + 1e-3f;
  bool const still = std::abs(envs.newest<school::Height>(1)[0] - before) < 1e-3f;
  return lifted && still ? 0 : 1;
}
