// A small task with tissue, for the step loop on a device: a block sticks to a tray that the agent tilts.
#pragma once

#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/rl/parameters.hpp>
#include <mpmpbd/rl/task.hpp>
#include <mpmpbd/rl/vector_env.hpp>

namespace tilt {

using namespace mpmpbd;

struct Jelly : Mpm<NeoHookean> {};
using Floor = Wall<Sticky, 2, Side::low>;
struct Tray : Scene<Jelly, Gravity, Floor> {};

struct Goal : Field<"goal", "m", Number, Environments> {};
struct Start : Field<"start", "m", Number, Environments> {};
struct Furthest : Field<"furthest", "m", Number, Environments> {};

template <class F, class Env> MPMPBD_HD auto mean(Env const& env) {
  using T = typename Env::Scalar;
  std::int64_t const n = env.template live<Particles>();
  Vec3<T> sum{};
  for (std::int64_t i = 0; i < n; ++i) sum += env.template get<F>(i);
  return (T(1) / T(n)) * sum;
}

struct Tilt {
  using Role = role::Action;
  static constexpr FixedString name = "Tilt";
  static constexpr int size = 2;
  using Reads = Fields<>;
  using Writes = Fields<>;
  template <class T> struct Parameters { T most; };  // [m/s^2]
  static constexpr ParameterInfo parameter_info[] = {bound::positive("most", "m/s^2")};
  template <class Env, class Ctx>
  MPMPBD_HD static void apply(Env const& env, Ctx const& context, float const* action, double) {
    using T = typename Env::Scalar;
    T const most = context.template of<Tilt>().most;
    rl::set_parameters<Gravity>(env, {{most * T(action[0]), most * T(action[1]), T(-9.81)}});
  }
};

// How far the middle of the block has been from where it began.
struct Sway {
  using Role = role::Progress;
  static constexpr FixedString name = "Sway";
  using Reads = Fields<particle::Position>;
  using Writes = Fields<Start, Furthest>;
  template <class Env, class Ctx> MPMPBD_HD static void begin(Env const& env, Ctx const&) {
    env.template set<Start>(0, mean<particle::Position>(env)[0]);
    env.template set<Furthest>(0, 0);
  }
  template <class Env, class Ctx> MPMPBD_HD static void decide(Env const&, Ctx const&) {}
  template <class Env, class Ctx> MPMPBD_HD static void advance(Env const& env, Ctx const&) {
    auto const now = mean<particle::Position>(env)[0] - env.template get<Start>(0);
    env.template set<Furthest>(0, max(env.template get<Furthest>(0), now));
  }
};

struct Middle {
  using Role = role::Observation;
  static constexpr FixedString name = "middle";
  static constexpr int size = 4;
  using Reads = Fields<particle::Position, Goal>;
  using Writes = Fields<>;
  template <class Env, class Ctx>
  MPMPBD_HD static void observe(Env const& env, Ctx const&, float* out) {
    auto const x = mean<particle::Position>(env);
    for (int a = 0; a < 3; ++a) out[a] = static_cast<float>(x[a]);
    out[3] = static_cast<float>(env.template get<Goal>(0));
  }
};
struct Heights {
  using Role = role::Observation;
  static constexpr FixedString name = "heights";
  using Each = Particles;
  static constexpr int size = 1;
  using Reads = Fields<particle::Position>;
  using Writes = Fields<>;
  template <class Env, class Ctx>
  MPMPBD_HD static void observe(Env const& env, Ctx const&, float* out) {
    for (std::int64_t i = 0; i < env.template live<Particles>(); ++i)
      out[i] = static_cast<float>(env.template get<particle::Position>(i)[2]);
  }
};

struct Away {
  using Role = role::RewardTerm;
  static constexpr FixedString name = "away";
  using Reads = Fields<particle::Position, Goal>;
  using Writes = Fields<>;
  template <class Env, class Ctx> MPMPBD_HD static auto value(Env const& env, Ctx const&) {
    return -abs(mean<particle::Position>(env)[0] - env.template get<Goal>(0));
  }
};
struct Swing {
  using Role = role::RewardTerm;
  static constexpr FixedString name = "swing";
  using Reads = Fields<particle::Velocity>;
  using Writes = Fields<>;
  template <class Env, class Ctx> MPMPBD_HD static auto value(Env const& env, Ctx const&) {
    return -typename Env::Scalar(0.1) * norm(mean<particle::Velocity>(env));
  }
};
struct TooFar {
  using Role = role::Termination;
  static constexpr FixedString name = "too_far";
  using Reads = Fields<Furthest>;
  using Writes = Fields<>;
  template <class Env, class Ctx> MPMPBD_HD static bool holds(Env const& env, Ctx const&) {
    return env.template get<Furthest>(0) > typename Env::Scalar(0.002);
  }
};
struct Reached {
  using Role = role::Metric;
  static constexpr FixedString name = "reached";
  using Reads = Fields<Furthest>;
  using Writes = Fields<>;
  template <class Env, class Ctx> MPMPBD_HD static auto value(Env const& env, Ctx const&) {
    return env.template get<Furthest>(0);
  }
};

// The goal evenly, the stiffness evenly in its logarithm.
struct Differ {
  using Role = role::Randomisation;
  static constexpr FixedString name = "differ";
  using Reads = Fields<>;
  using Writes = Fields<Goal>;
  template <class Env, class Ctx>
  MPMPBD_HD static void apply(Env const& env, Ctx const& context, rl::Random& random) {
    using T = typename Env::Scalar;
    auto material = context.template of<NeoHookean>();
    T const stiffer = T(random.factor(0.5, 2.0));
    material.mu *= stiffer;
    material.lambda *= stiffer;
    rl::set_parameters<NeoHookean>(env, material);
    env.template set<Goal>(0, T(random.between(0.4, 0.5)));
  }
};

struct Settings {
  rl::EpisodeConfig episode{.decision_interval = 3, .limit = 4, .frames = 2};
  double cell = 0.08, step = 0.004, tilt = 4.0;  // [m], [s], [m/s^2]
  int substeps = 2;
};

struct TiltTask
    : rl::Task<Tray, Tilt, Sway, Middle, Heights, Away, Swing, TooFar, Reached, Differ> {
  using Config = Settings;
  static constexpr int across = 6, high = 4;

  static SimulationOptions options(Config const& c, std::int64_t environments) {
    return {.environments = environments,
            .cell_size = c.cell,
            .nodes = {12, 12, 10},
            .capacity = {{"particle", across * across * high}},
            .substeps = c.substeps};
  }
  static double step_time(Config const& c) { return c.step; }
  template <class Sim> static void set_up(Sim& sim, std::int64_t env, Config const& c) {
    std::vector<Vec3<double>> points;
    for (int k = 0; k < high; ++k)
      for (int j = 0; j < across; ++j)
        for (int i = 0; i < across; ++i)
          points.push_back(c.cell * (vec(4.0, 4.0, 2.0) + 0.5 * vec(i + 0.5, j + 0.5, k + 0.5)));
    sim.template set<NeoHookean>(env, lame(2e4, 0.4));
    sim.template set<Floor>(env, {2 * c.cell});
    sim.template set<Tilt>(env, {c.tilt});
    sim.add_particles(env, points, 1000.0, c.cell * c.cell * c.cell / 8);
  }
};

}  // namespace tilt
