// A run of a scene: N environments that equal N separate runs, bit for bit.
#pragma once

#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <mpmpbd/backend/host.hpp>
#include <mpmpbd/mpm/time_step.hpp>
#include <mpmpbd/scene/held_limit.hpp>

namespace mpmpbd {

// What is fixed when a simulation is made.
struct SimulationOptions {
  std::int64_t environments = 1;
  double cell_size = 0.0;    // [m]
  int nodes[3] = {0, 0, 0};  // per axis; the domain reaches from (0,0,0) to (nodes-1) cell_size
  std::vector<Capacity> capacity{};  // slots per environment by domain name
  // Substeps of a step: 0 chooses them per environment from the stable limit, else exactly this many.
  int substeps = 0;
  int most_substeps = 1000;  // more needed than this sets Fault::time_step
  // Refuse a step whose substeps would be longer than the stable limit of any environment, before anything
  // moves, instead of setting Fault::time_step.
  bool strict = false;
};

namespace detail {
[[noreturn]] inline void refuse(std::string const& sentence) {
  throw std::invalid_argument("mpmpbd Simulation: " + sentence);
}
inline void require(bool ok, std::string const& sentence) {
  if (!ok) refuse(sentence);
}
}  // namespace detail

template <class Scene_, class Backend = Serial, class T = float> class Simulation {
 public:
  using Scene = Scene_;
  using Scalar = T;
  using Store = State<T, typename Scene::StateFields>;

  // Throws std::invalid_argument naming the option, its value and what is allowed.
  explicit Simulation(SimulationOptions options, Backend backend = {})
      : options_(std::move(options)), backend_(backend), state_(options_.environments) {
    check_options();
    if constexpr (Scene::has_body)
      lattice_ = Lattice<T>::make(T(options_.cell_size), options_.nodes[0], options_.nodes[1],
                                  options_.nodes[2]);
    for_each_type(typename Store::Domains{}, [&]<class D>(std::type_identity<D>) {
      state_.template table<D>().resize(options_.environments, slots<D>());
    });
    for (std::int64_t e = 0; e < options_.environments; ++e)
      state_.template table<Environments>().set_live(e, 1);
    initial_ = state_;
  }

  std::int64_t environments() const { return options_.environments; }
  Lattice<T> const& lattice() const { return lattice_; }
  SimulationOptions const& options() const { return options_; }
  Store& state() { return state_; }
  Store const& state() const { return state_; }

  // Sets the parameters of policy P in all environments, or in one. Refused values change nothing.
  template <class P> void set(parameters_t<P, double> const& k) {
    for (std::int64_t e = 0; e < environments(); ++e) set<P>(e, k);
  }
  template <class P> void set(std::int64_t env, parameters_t<P, double> const& k) {
    check_environment(env);
    check_parameters<P, double>(k);
    state_.template set_parameters<P>(env, cast_parameters<P, T, double>(k));
  }

  // Adds material points at rest, F = 1: positions [m] in environment coordinates, density [kg/m^3],
  // volume of each [m^3]. Refuses positions outside the domain and more points than the capacity.
  void add_particles(std::int64_t env, std::span<Vec3<double> const> positions, double density,
                     double volume) requires(Scene_::has_body) {
    if constexpr (Scene::has_body) {  // clang 14 instantiates it in spite of the requirement
      check_environment(env);
      check_parameter("Simulation::add_particles", bound::positive("density", "kg/m^3"), density);
      check_parameter("Simulation::add_particles", bound::positive("volume", "m^3"), volume);
      for (auto const& x : positions) check_position<typename Scene::Body>(x);
      auto& table = state_.template table<Particles>();
      std::int64_t slot = table.live(env);
      table.set_live(env, slot + static_cast<std::int64_t>(positions.size()));
      for (auto const& x : positions) {
        table.template set<particle::Position>(env, slot, cast<T>(x));
        table.template set<particle::Mass>(env, slot, T(density * volume));
        table.template set<particle::Volume>(env, slot, T(volume));
        table.template set<particle::Deformation>(env, slot, Mat3<T>::identity());
        ++slot;
      }
    }
  }

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
  // Replaces the state of all environments, for example by one read from a file. Another number of
  // environments or another capacity is refused and changes nothing.
  void restore(Store const& source) {
    detail::require(source.environments() == environments(),
                    "a state of " + std::to_string(source.environments()) +
                        " environments given; this run has " + std::to_string(environments()));
    for_each_type(typename Store::Domains{}, [&]<class D>(std::type_identity<D>) {
      detail::require(
          source.template table<D>().capacity() == state_.template table<D>().capacity(),
          "a state with another capacity of domain '" + std::string(D::name.view()) + "' given");
    });
    state_ = source;
  }
  // Makes environment `to` an exact copy of `from`.
  void clone(std::int64_t from, std::int64_t to) {
    check_environment(from);
    check_environment(to);
    state_.copy_environment(to, state_, from);
  }

  std::uint32_t status(std::int64_t env) const {
    return static_cast<std::uint32_t>(state_.template get<environment::Status>(env));
  }

  // Advances every environment by h [s], each with its own number of substeps; with a mask, those where it is not 0.
  void step(double h, std::span<unsigned char const> mask = {});

  // What the policies of an environment are told: its lattice and its parameters.
  auto context(std::int64_t env) const { return context_of(env); }

  // The longest recommended substep [s] of an environment in its present state.
  double suggest_dt(std::int64_t env) requires(Scene_::has_body);

 private:
  using Ctx = Context<T, typename Scene::Policies>;
  using Work = Workspace<T, typename Scene::NodeFields>;

  template <class Lanes>
  void step_environment(std::int64_t env, double h, Work& work, Lanes const& lanes) {
    auto status = status_of(env);
    if (has(status, Fault::not_finite)) return;  // frozen
    auto const meet = [&](std::uint32_t faults) {
      status |= faults;
      count(env, faults);
    };
    HostEnvironment<Scene, T, Lanes> run(state_, env, context_of(env), work, lanes);
    int substeps = 0;
    meet(hold_particles(env) | run.lost_bodies());
    meet(choose_substeps(run, env, h, substeps));
    T const dt = T(h / substeps);
    T previous = state_.template get<environment::Dt>(env);
    for (int s = 0; s < substeps && !has(status, Fault::not_finite); ++s) {
      auto const step = state_.template get<environment::Step>(env);
      auto const time = state_.template get<environment::Time>(env);
      meet(run.substep(
          {dt, previous > T(0) ? previous : dt, step, T(1e-12 * double(time)), s, substeps}));
      previous = dt;
      state_.template set<environment::Step>(env, step + 1);
      state_.template set<environment::Time>(env, time + std::llround(1e12 * h / substeps));
    }
    state_.template set<environment::Dt>(env, dt);
    state_.template set<environment::Substeps>(env, substeps);
    state_.template set<environment::Status>(env, static_cast<std::int64_t>(status));
  }

  // The state may have been set from outside: a particle beyond the border would write beyond the grid,
  // so it is held there as one that moves out is. Infinity and NaN are left to the step bounds.
  std::uint32_t hold_particles([[maybe_unused]] std::int64_t env) {
    std::uint32_t faults = 0;
    if constexpr (Scene::has_body) {
      using Shape = typename Scene::Body::Shape;
      auto& table = state_.template table<Particles>();
      auto const view = table.view();
      for (int a = 0; a < 3; ++a) {
        T const low = lowest_cell<Shape, T>() * lattice_.dx;
        T const high = highest_cell<Shape, T>(lattice_.nodes[a]) * lattice_.dx;
        auto* x = view.template plane<particle::Position>(a) + env * table.capacity();
        for (std::int64_t slot = 0; slot < table.live(env); ++slot)
          if (is_finite(x[slot]) && (x[slot] < low || x[slot] > high)) {
            faults |= static_cast<std::uint32_t>(Fault::escape);
            x[slot] = x[slot] > high ? high : low;
          }
      }
    }
    return faults;
  }

  void count(std::int64_t env, std::uint32_t faults) {
    if (faults == 0) return;
    auto met = state_.template get<environment::FaultCount>(env);
    for (int f = 0; f < fault_count; ++f)
      met[f] += has(faults, fault_table[static_cast<std::size_t>(f)].fault);
    state_.template set<environment::FaultCount>(env, met);
  }

  // Substeps of this step and the faults of choosing them.
  template <class Run>
  std::uint32_t choose_substeps(Run& run, std::int64_t env, double h, int& substeps) {
    std::uint32_t faults = 0;
    StepLimit<T> limit{T(h), StepBound::none};
    if constexpr (Scene::has_body)
      limit = step_limit<typename Scene::Body>(run.bounds(faults), lattice_.dx);
    state_.template set<environment::DtLimit>(env, limit.dt);
    state_.template set<environment::DtBound>(env, static_cast<std::int64_t>(limit.bound));
    substeps = substeps_of(h, double(hold(env, limit)));
    if (too_long(h / substeps, double(limit.dt)))
      faults |= static_cast<std::uint32_t>(Fault::time_step);
    return faults;
  }
  // The limit that chosen substeps keep. How fast something moves does not swing with the strain, so it holds nothing.
  T hold(std::int64_t env, StepLimit<T> const& now) {
    auto const lengths = state_.template get<environment::HeldLimits>(env);
    HeldLimit<T> held{lengths[0], lengths[1], state_.template get<environment::CalmSteps>(env)};
    if (now.bound != StepBound::speed) held.meet(now.dt);
    state_.template set<environment::HeldLimits>(env, {{held.limit, held.longer}});
    state_.template set<environment::CalmSteps>(env, held.calm);
    return held.limit > T(0) ? min(held.limit, now.dt) : now.dt;
  }
  int substeps_of(double h, double suggested) const {
    if (options_.substeps > 0) return options_.substeps;
    double const needed = h / suggested;
    if (!(needed <= options_.most_substeps)) return options_.most_substeps;
    return needed > 1.0 ? static_cast<int>(::ceil(needed - 1e-9)) : 1;
  }
  // The suggestion holds a margin; only beyond the limit itself is a step at fault.
  static bool too_long(double dt, double suggested) { return dt > suggested / time_step_safety; }

  // What a strict run asks before a step, of every environment that is about to move.
  template <class Acts> void check_limits(double h, Acts const& acts) {
    if constexpr (Scene::has_body)
      for (std::int64_t env = 0; env < environments(); ++env) {
        if (!acts(env) || has(status_of(env), Fault::not_finite)) continue;
        double const suggested = suggest_dt(env), dt = h / substeps_of(h, suggested);
        detail::require(
            !too_long(dt, suggested),
            "a substep of " + std::to_string(1e6 * dt) +
                " us is longer than the stable limit of environment " + std::to_string(env) + ", " +
                std::to_string(1e6 * suggested / time_step_safety) +
                " us; nothing has moved. Give a shorter step or more substeps, or options.strict = false");
      }
  }

  std::uint32_t status_of(std::int64_t env) const { return status(env); }

  void check_environment(std::int64_t env) const {
    if (env < 0 || env >= environments())
      detail::refuse("environment " + std::to_string(env) + " given; this run has 0 to " +
                     std::to_string(environments() - 1));
  }

  void check_mask(std::span<unsigned char const> mask) const {
    if (static_cast<std::int64_t>(mask.size()) != environments())
      detail::refuse("a mask of " + std::to_string(mask.size()) + " entries given; this run has " +
                     std::to_string(environments()) + " environments");
  }

  Ctx context_of(std::int64_t env) const {
    Ctx c{};
    c.lattice = lattice_;
    for_each_type(typename Scene::Policies{}, [&]<class P>(std::type_identity<P>) {
      c.parameters.template get<P>() = state_.template parameters<P>(env);
    });
    return c;
  }

  template <class D> std::int64_t slots() const {
    if constexpr (std::is_same_v<D, Environments>) {
      return 1;
    } else {
      for (auto const& c : options_.capacity)
        if (c.domain == D::name.view()) return c.slots;
      throw std::invalid_argument(
          "mpmpbd Simulation: no capacity given for domain '" + std::string(D::name.view()) +
          "'; add {\"" + std::string(D::name.view()) + "\", slots} to SimulationOptions::capacity");
    }
  }

  void check_options() const {
    detail::require(
        options_.environments > 0,
        "environments = " + std::to_string(options_.environments) + "; give at least 1");
    if constexpr (Scene::has_body) {
      check_parameter("SimulationOptions", bound::positive("cell_size", "m"), options_.cell_size);
      for (int n : options_.nodes)
        detail::require(n >= 4, "nodes per axis = " + std::to_string(n) + "; give at least 4");
    }
    detail::require(options_.substeps >= 0, "substeps = " + std::to_string(options_.substeps) +
                                                "; give 0 (automatic) or a positive number");
  }

  template <class Body> void check_position(Vec3<double> const& x) const {
    using Shape = typename Body::Shape;
    for (int a = 0; a < 3; ++a) {
      double const low = lowest_cell<Shape, double>() * options_.cell_size;
      double const high = highest_cell<Shape, double>(options_.nodes[a]) * options_.cell_size;
      detail::require(x[a] >= low && x[a] <= high,
                      "a particle at " + std::to_string(x[a]) + " m on axis " + std::to_string(a) +
                          "; the domain holds particles in [" + std::to_string(low) + ", " +
                          std::to_string(high) + "] m");
    }
  }

  SimulationOptions options_;
  Backend backend_;
  Lattice<T> lattice_{};
  Store state_;
  Store initial_;
  std::vector<Work> workspaces_;
};

// Defined outside of the class: a catalogue compiles them once (extern template), users then do not.
template <class Scene_, class Backend, class T>
void Simulation<Scene_, Backend, T>::step(double h, std::span<unsigned char const> mask) {
  if (!(h > 0.0 && h - h == 0.0))
    detail::refuse("step of " + std::to_string(h) + " s asked for; give a positive time");
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
  if constexpr (Scene::has_body) {
    workspaces_.resize(workspaces_.empty() ? 1 : workspaces_.size());
    HostEnvironment<Scene, T, Serial> run(state_, env, context_of(env), workspaces_[0], Serial{});
    std::uint32_t faults = 0;
    return double(mpmpbd::suggest_dt<typename Scene::Body>(run.bounds(faults), lattice_.dx));
  } else {
    return static_cast<void>(env), 0.0;
  }
}

}  // namespace mpmpbd
