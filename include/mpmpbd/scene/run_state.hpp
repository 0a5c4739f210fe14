// The state of a run of a scene on the host: how it is made, set and cloned. What moves it is a Simulation.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <mpmpbd/core/array.hpp>
#include <mpmpbd/mpm/lattice.hpp>
#include <mpmpbd/pbd/access.hpp>
#include <mpmpbd/scene/scene.hpp>
#include <mpmpbd/scene/step_control.hpp>

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

  SubstepChoice substep_choice() const { return {substeps, most_substeps}; }
};

namespace detail {
[[noreturn]] inline void refuse(std::string const& sentence) {
  throw std::invalid_argument("mpmpbd Simulation: " + sentence);
}
inline void require(bool ok, std::string const& sentence) {
  if (!ok) refuse(sentence);
}
inline void check_step(double h) {
  if (!(h > 0.0 && h - h == 0.0))  // no sentence is made, and no memory taken, where all is well
    refuse("step of " + std::to_string(h) + " s asked for; give a positive time");
}
}  // namespace detail

template <class Scene_, class T> class RunState {
 public:
  using Scene = Scene_;
  using Scalar = T;
  using Store = State<T, typename Scene::StateFields>;

  // Throws std::invalid_argument naming the option, its value and what is allowed.
  explicit RunState(SimulationOptions options)
      : options_(std::move(options)), state_(options_.environments) {
    check_options();
    if constexpr (Scene::has_body)
      lattice_ = Lattice<T>::make(T(options_.cell_size), options_.nodes[0], options_.nodes[1],
                                  options_.nodes[2]);
    for_each_type(typename Store::Domains{}, [&]<class D>(std::type_identity<D>) {
      state_.template table<D>().resize(options_.environments, slots<D>());
    });
    for (std::int64_t e = 0; e < options_.environments; ++e)
      state_.template table<Environments>().set_live(e, 1);
  }

  std::int64_t environments() const { return options_.environments; }
  Lattice<T> const& lattice() const { return lattice_; }
  SimulationOptions const& options() const { return options_; }
  Store& state() { return state_; }
  Store const& state() const { return state_; }

  // A field where it lies, (env, slot, component); of a const run read-only. Valid as long as this run.
  template <class F> Array array() { return array_in<F>(state_); }
  template <class F> Array array() const { return array_in<F>(state_); }

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
      table.clear(env, slot, static_cast<std::int64_t>(positions.size()));
      for (auto const& x : positions) {
        table.template set<particle::Position>(env, slot, cast<T>(x));
        table.template set<particle::Mass>(env, slot, T(density * volume));
        table.template set<particle::Volume>(env, slot, T(volume));
        table.template set<particle::Deformation>(env, slot, Mat3<T>::identity());
        ++slot;
      }
    }
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
    check_environment(env);
    return static_cast<std::uint32_t>(state_.template get<environment::Status>(env));
  }

  // What the policies of an environment are told: its lattice and its parameters.
  Context<T, typename Scene_::Policies> context(std::int64_t env) const {
    check_environment(env);
    return context_of(env);
  }

 protected:
  using Ctx = Context<T, typename Scene::Policies>;

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
    auto& state =
        const_cast<Store&>(state_);  // views of a const table are not built; nothing is written
    return load_context<typename Scene::Policies>(
        access_environment(state, env, typename Store::Domains{}), lattice_);
  }

  template <class F, class State_> static Array array_in(State_& state) {
    auto& table = state.template table<typename F::Domain>();
    return field_array<F>(table.template planes<F>().data(), table.environments(),
                          table.capacity());
  }

  template <class D> std::int64_t slots() const {
    if constexpr (std::is_same_v<D, Environments>) {
      return 1;
    } else {
      for (auto const& c : options_.capacity)
        if (c.domain == D::name.view()) return checked_slots<D>(c);
      throw std::invalid_argument(
          "mpmpbd Simulation: no capacity given for domain '" + std::string(D::name.view()) +
          "'; add {\"" + std::string(D::name.view()) + "\", slots} to SimulationOptions::capacity");
    }
  }

  template <class D> static std::int64_t checked_slots(Capacity const& c) {
    std::int64_t fewest = 0;
    if constexpr (requires { D::fewest_slots; }) fewest = D::fewest_slots;
    detail::require(c.slots >= fewest, "capacity of domain '" + std::string(c.domain) +
                                           "' = " + std::to_string(c.slots) + "; give at least " +
                                           std::to_string(fewest));
    return c.slots;
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
    detail::require(
        options_.most_substeps > 0,
        "most_substeps = " + std::to_string(options_.most_substeps) + "; give at least 1");
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
  Lattice<T> lattice_{};
  Store state_;
};

}  // namespace mpmpbd
