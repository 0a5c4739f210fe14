// A small task of its own, for the tutorial "write a task" and for tests of the step loop: whoever
// holds one end of a thread is to bring the other end to a place.
#pragma once

#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/pbd/solvers/direct_banded.hpp>
#include <mpmpbd/rl/task.hpp>
#include <mpmpbd/rl/vector_env.hpp>

namespace carry {

using namespace mpmpbd;

struct Thread : Pbd<Constraints<Distance>, DirectBanded<>> {};
struct HangingThread : Scene<Thread, Gravity, Damping> {};

// What the task remembers: where the free end is to go.
struct Goal : Field<"goal", "m", Vector, Environments> {};

template <class Env> MPMPBD_HD auto free_end(Env const& env) {
  return env.template get<bead::Position>(env.template live<Beads>() - 1);
}

// Velocity of the held end, at most `speed`.
struct MoveHeldEnd {
  using Role = role::Action;
  static constexpr FixedString name = "MoveHeldEnd";
  static constexpr int size = 3;
  using Reads = Fields<>;
  using Writes = Fields<bead::Velocity>;
  template <class T> struct Parameters { T speed; };
  static constexpr ParameterInfo parameter_info[] = {bound::positive("speed", "m/s")};

  template <class Env, class Ctx>
  MPMPBD_HD static void apply(Env const& env, Ctx const& context, float const* action, double) {
    using T = typename Env::Scalar;
    T const speed = context.template of<MoveHeldEnd>().speed;
    env.template set<bead::Velocity>(0, speed * vec(T(action[0]), T(action[1]), T(action[2])));
  }
};

struct Ends {
  using Role = role::Observation;
  static constexpr FixedString name = "ends";
  static constexpr int size = 9;
  using Reads = Fields<bead::Position, Goal>;
  using Writes = Fields<>;
  template <class Env, class Ctx>
  MPMPBD_HD static void observe(Env const& env, Ctx const&, float* out) {
    Vec3<typename Env::Scalar> const all[] = {env.template get<bead::Position>(0), free_end(env),
                                              env.template get<Goal>(0)};
    for (auto const& x : all)
      for (int a = 0; a < 3; ++a) *out++ = static_cast<float>(x[a]);
  }
};

// A group with a row for every bead.
struct Heights {
  using Role = role::Observation;
  static constexpr FixedString name = "heights";
  using Each = Beads;
  static constexpr int size = 1;
  using Reads = Fields<bead::Position>;
  using Writes = Fields<>;
  template <class Env, class Ctx>
  MPMPBD_HD static void observe(Env const& env, Ctx const&, float* out) {
    for (std::int64_t k = 0; k < env.template live<Beads>(); ++k)
      out[k] = static_cast<float>(env.template get<bead::Position>(k)[2]);
  }
};

struct Distance {
  using Role = role::RewardTerm;
  static constexpr FixedString name = "distance";
  using Reads = Fields<bead::Position, Goal>;
  using Writes = Fields<>;
  template <class Env, class Ctx> MPMPBD_HD static auto value(Env const& env, Ctx const&) {
    return -norm(free_end(env) - env.template get<Goal>(0));
  }
};

struct Arrived {
  using Role = role::Termination;
  static constexpr FixedString name = "arrived";
  using Reads = Fields<bead::Position, Goal>;
  using Writes = Fields<>;
  template <class Env, class Ctx> MPMPBD_HD static bool holds(Env const& env, Ctx const& context) {
    return Distance::value(env, context) > -typename Env::Scalar(0.02);
  }
};

struct RandomGoal {
  using Role = role::Randomisation;
  static constexpr FixedString name = "RandomGoal";
  using Reads = Fields<>;
  using Writes = Fields<Goal>;
  template <class Env, class Ctx>
  MPMPBD_HD static void apply(Env const& env, Ctx const&, rl::Random& random) {
    using T = typename Env::Scalar;
    auto any = [&] { return T(random.between(-0.2, 0.2)); };
    T const x = any(), y = any(), z = any();
    env.template set<Goal>(0, vec(x, y, z - T(0.3)));
  }
};

struct Settings {
  rl::EpisodeConfig episode{.decision_interval = 10, .limit = 60};
  double step = 0.002, length = 0.3, speed = 0.5;  // [s], [m], [m/s]
  int segments = 12;
};

struct CarryTask
    : rl::Task<HangingThread, MoveHeldEnd, Ends, Heights, carry::Distance, Arrived, RandomGoal> {
  using Config = Settings;

  static RodAssembly<Thread> thread(Config const& c) {
    RodAssembly<Thread> rod;
    std::vector<Vec3<double>> line;
    for (int k = 0; k <= c.segments; ++k) line.push_back(vec(0.0, 0.0, -c.length * k / c.segments));
    auto const made = add_thread<Thread>(rod, line, RodMaterial{2e9, 0.000115, 1140.0, 1.0});
    rod.prescribe(made.first);
    return rod;
  }
  static SimulationOptions options(Config const& c, std::int64_t environments) {
    SimulationOptions o;
    o.environments = environments;
    o.capacity = thread(c).capacity();
    return o;
  }
  static double step_time(Config const& c) { return c.step; }
  template <class Sim> static void set_up(Sim& sim, std::int64_t env, Config const& c) {
    thread(c).write(sim.state(), env);
    sim.template set<Gravity>(env, {{0.0, 0.0, -9.81}});
    sim.template set<Damping>(env, {2.0});
    sim.template set<MoveHeldEnd>(env, {c.speed});
  }
};

}  // namespace carry
