// A run of a scene: N environments that equal N separate runs, bit for bit.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <mpmpbd/backend/host.hpp>
#include <mpmpbd/scene/run_state.hpp>

namespace mpmpbd {

template <class Scene_, class Backend = Serial, class T = float>
class Simulation : public RunState<Scene_, T> {
  using Base = RunState<Scene_, T>;

 public:
  using Scene = Scene_;
  using Scalar = T;
  using Store = typename Base::Store;

  // Throws std::invalid_argument naming the option, its value and what is allowed.
  explicit Simulation(SimulationOptions options, Backend backend = {})
      : Base(std::move(options)), backend_(backend), initial_(state_) {}

  using Base::environments;

  // Makes the present state the one that reset() returns to.
  void remember() { initial_ = state_; }
  // Puts environments (all of them, or those with a non-zero mask) back to the remembered state, exactly.
  void reset() {
    for (std::int64_t e = 0; e < environments(); ++e) reset(e);
  }
  void reset(std::span<unsigned char const> mask) {
    check_mask(mask);
    for (std::int64_t e = 0; e < environments(); ++e)
      if (mask[static_cast<std::size_t>(e)]) reset(e);
  }
  void reset(std::int64_t env) {
    check_environment(env);
    auto const episode = state_.template get<environment::Episode>(env);
    state_.copy_environment(env, initial_, env);
    state_.template set<environment::Episode>(env, episode + 1);
  }
  // Advances every environment by h [s], each with its own number of substeps; with a mask, those where it is not 0.
  void step(double h, std::span<unsigned char const> mask = {});

  // The longest recommended substep [s] of an environment in its present state.
  double suggest_dt(std::int64_t env) requires(Scene_::has_body);

 private:
  using Base::check_environment;
  using Base::check_mask;
  using Base::context_of;
  using Base::lattice_;
  using Base::options_;
  using Base::state_;
  using Work = Workspace<T, typename Scene::NodeFields>;

  template <class Lanes>
  void step_environment(std::int64_t env, double h, Work& work, Lanes const& lanes) {
    StepControl const control{access(env)};
    if (control.frozen()) return;
    HostEnvironment<Scene, T, Lanes> run(state_, env, context_of(env), work, lanes);
    control.meet(run.hold_particles() | run.lost_bodies());
    std::uint32_t faults = 0;
    auto const limit = run.limit(faults);
    control.meet(faults);
    auto const clock = control.begin(limit, h, options_.substep_choice());
    int done = 0;
    try {
      for (; done < clock.substeps && !control.frozen(); ++done)
        control.meet(run.substep(clock.tick(done)));
    } catch (...) {  // memory has run out: the clock tells which substeps are done
      if (done > 0) control.finish(clock, done);
      throw;
    }
    control.finish(clock, done);
  }
  auto access(std::int64_t env) {
    return access_environment(state_, env, typename Store::Domains{});
  }

  // What a strict run asks before a step, of every environment that is about to move.
  template <class Acts> void check_limits(double h, Acts const& acts) {
    if constexpr (Scene::has_body)
      for (std::int64_t env = 0; env < environments(); ++env) {
        if (!acts(env) || has(this->status(env), Fault::not_finite)) continue;
        double const suggested = suggest_dt(env);
        double const dt = h / options_.substep_choice().of(h, suggested);
        detail::require(
            !longer_than_limit(dt, suggested),
            "a substep of " + std::to_string(1e6 * dt) +
                " us is longer than the stable limit of environment " + std::to_string(env) + ", " +
                std::to_string(1e6 * suggested / time_step_safety) +
                " us; nothing has moved. Give a shorter step or more substeps, or options.strict = false");
      }
  }

  Backend backend_;
  Store initial_;
  std::vector<Work> workspaces_;
};

// Defined outside of the class: a catalogue compiles them once (extern template), users then do not.
template <class Scene_, class Backend, class T>
void Simulation<Scene_, Backend, T>::step(double h, std::span<unsigned char const> mask) {
  detail::check_step(h);
  if (!mask.empty()) check_mask(mask);
  auto const acts = [&](std::int64_t env) {
    return mask.empty() || mask[static_cast<std::size_t>(env)] != 0;
  };
  if (options_.strict) check_limits(h, acts);
  bool const outer = environments() >= backend_.lanes() && backend_.lanes() > 1;
  workspaces_.resize(static_cast<std::size_t>(outer ? backend_.lanes() : 1));
  if (outer) {
    backend_.for_each(environments(), [&](std::int64_t env, int lane) {
      if (!acts(env)) return;
      step_environment(env, h, workspaces_[static_cast<std::size_t>(lane)],
                       Serial{backend_.kernels});
    });
  } else {
    for (std::int64_t env = 0; env < environments(); ++env)
      if (acts(env)) step_environment(env, h, workspaces_[0], backend_);
  }
}

template <class Scene_, class Backend, class T>
double Simulation<Scene_, Backend, T>::suggest_dt(std::int64_t env) requires(Scene_::has_body) {
  this->check_environment(env);
  if constexpr (Scene::has_body) {
    workspaces_.resize(workspaces_.empty() ? 1 : workspaces_.size());
    HostEnvironment<Scene, T, Serial> run(state_, env, context_of(env), workspaces_[0], Serial{});
    std::uint32_t faults = 0;
    return double(run.limit(faults).dt);
  } else {
    return 0.0;
  }
}

}  // namespace mpmpbd
