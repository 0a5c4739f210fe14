// A step loop as Python sees it: what the loops of all back ends have in common. mpmpbd/vector_env.py gives it Gymnasium's words.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <mutex>
#include <optional>
#include <span>

#include <mpmpbd/io/config.hpp>
#include <mpmpbd/rl/arrays.hpp>

#include "array.hpp"
#include "numbers.hpp"

namespace mpmpbd::python {

// TOML documents, the later ones over the earlier ones, each with the name that messages give it.
using Documents = std::vector<std::pair<std::string, std::string>>;

template <class Config> Config config_of(Documents const& documents) {
  std::vector<io::ConfigSource> sources;
  for (auto const& [text, name] : documents) sources.push_back({text, name});
  return io::parse_config<Config>(sources);
}

inline rl::Autoreset autoreset_named(std::string const& name) {
  if (name == "same_step") return rl::Autoreset::same_step;
  if (name == "next_step") return rl::Autoreset::next_step;
  if (name == "disabled") return rl::Autoreset::disabled;
  throw std::invalid_argument("mpmpbd VectorEnv: autoreset = '" + name +
                              "'; give 'same_step', 'next_step' or 'disabled'");
}

// Environments that threads of Python may share: they run without the interpreter's lock, one call at a time.
template <class Envs_> class StepLoop {
 public:
  using Envs = Envs_;
  template <class... Arguments>
  explicit StepLoop(Arguments&&... arguments) : envs_(std::forward<Arguments>(arguments)...) {}

  Envs& envs() { return envs_; }

  void reset(std::optional<std::int64_t> seed) {
    alone([&] { seed ? envs_.reset(*seed) : envs_.reset(); });
  }
  void reset_where(py::buffer const& mask) {
    auto const given = mask.request();
    require(array_of(given), wanted_mask());
    std::span const where(static_cast<unsigned char const*>(given.ptr), of_all(1));
    alone([&] { envs_.reset(where); });
  }
  void start(std::int64_t env, std::int64_t episode, std::optional<std::int64_t> as) {
    alone([&] { as ? envs_.start(env, episode, *as) : envs_.start(env, episode); });
  }
  void step(py::buffer const& actions) {
    auto const numbers = actions_in(actions.request());
    alone([&] { envs_.step(numbers); });
  }

  // No objects of Python in f.
  template <class Function> auto alone(Function&& f) {
    py::gil_scoped_release const others_run;
    std::scoped_lock const one_at_a_time(busy_);
    return f();
  }

 protected:
  Wanted wanted_actions(Place const& place = {}) const {
    std::vector<std::int64_t> const shape{envs_.num_envs(), Envs::action_size};
    return {"actions of float32 and shape " + text_of(shape) + " are", element_type<float>, shape,
            place};
  }
  Wanted wanted_mask(Place const& place = {}) const {
    std::vector<std::int64_t> const shape{envs_.num_envs()};
    return {"a mask of bool or uint8 and shape " + text_of(shape) + " is",
            element_type<unsigned char>, shape, place};
  }
  std::span<float const> actions_in(py::buffer_info const& given) const {
    require(array_of(given), wanted_actions());
    return {static_cast<float const*>(given.ptr), of_all(Envs::action_size)};
  }

 private:
  std::size_t of_all(int numbers) const {
    return static_cast<std::size_t>(envs_.num_envs() * numbers);
  }

  Envs envs_;
  std::mutex busy_;
};

// Without a seed it is that of the settings. Other threads of Python run meanwhile; the object of Python is made after it.
template <class Loop, class Where>
std::shared_ptr<Loop> make_loop(Documents const& documents, rl::VectorEnvOptions options,
                                std::optional<std::int64_t> seed, Where const& where) {
  py::gil_scoped_release const others_run;
  auto const config = config_of<typename Loop::Envs::Config>(documents);
  options.seed = seed.value_or(config.scene.seed);
  return std::make_shared<Loop>(config, options, where);
}

// The settings of what runs: with the seed that it has.
template <class Envs> std::string config_text(Envs const& envs) {
  auto config = envs.config();
  config.scene.seed = envs.options().seed;
  return io::config_text(config);
}

// How many slots of a domain each environment uses.
template <class Envs> std::vector<std::int64_t> live(Envs& envs, std::string const& domain) {
  auto const& state = std::as_const(envs.simulation()).state();
  std::vector<std::int64_t> counts;
  std::string known;
  for_each_type(typename Envs::Sim::Store::Domains{}, [&]<class D>(std::type_identity<D>) {
    known += (known.empty() ? "" : ", ") + std::string(D::name.view());
    if (domain != D::name.view()) return;
    for (std::int64_t env = 0; env < state.environments(); ++env)
      counts.push_back(state.template table<D>().live(env));
  });
  if (counts.empty())
    throw std::invalid_argument("mpmpbd: no domain '" + domain + "'; there are " + known);
  return counts;
}

// {name: unit} of everything that state() finds.
template <class Envs> py::dict field_units() {
  py::dict units;
  for_each_lasting_field(typename Envs::Sim::Store::List{}, [&]<class F>(F) {
    units[full_name<F>().c_str()] = std::string(F::unit.view());
  });
  return units;
}

template <class Names> py::tuple names_of(Names const& names) {
  py::tuple all(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) all[i] = std::string(names[i]);
  return all;
}

template <class Loop> using LoopClass = py::class_<Loop, std::shared_ptr<Loop>>;

// All but how it is made, which is its back end's.
template <class Loop> LoopClass<Loop> declare_loop(py::module_& module, char const* name) {
  using Envs = typename Loop::Envs;
  using Shared = std::shared_ptr<Loop>;
  LoopClass<Loop> loop(module, name);
  loop.def("reset", &Loop::reset)
      .def("reset_where", &Loop::reset_where)
      .def("start", &Loop::start)
      .def("step", &Loop::step)
      .def("observations",
           [](Shared const& self) { return dict_of(rl::observation_arrays(self->envs()), self); })
      .def("final_observations",
           [](Shared const& self) {
             return dict_of(rl::final_observation_arrays(self->envs()), self);
           })
      .def("outcome",
           [](Shared const& self) { return dict_of(rl::outcome_arrays(self->envs()), self); })
      .def("state",
           [](Shared const& self, std::string const& field) {
             auto& envs = self->envs();
             Array found = self->alone([&] { return array_named(envs.simulation(), field); });
             found.read_only = true;  // the next step starts from it
             return SharedArray{found, self};
           })
      .def("live",
           [](Loop& self, std::string const& domain) {
             return self.alone([&] { return live(self.envs(), domain); });
           })
      .def("config",
           [](Loop& self) { return self.alone([&] { return config_text(self.envs()); }); })
      .def_property_readonly("decision_time",
                             [](Loop& self) { return self.envs().decision_time(); });
  loop.attr("action_size") = int{Envs::action_size};
  loop.attr("term_names") = names_of(Envs::term_names());
  loop.attr("metric_names") = names_of(Envs::metric_names());
  loop.attr("fields") = field_units<Envs>();
  return loop;
}

}  // namespace mpmpbd::python
