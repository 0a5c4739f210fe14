// The step loop of the suturing task on a CUDA device.
#include <mpmpbd/catalog/suturing_task.hpp>
#include <mpmpbd/rl/cuda/vector_env.hpp>

#include "step_loop.hpp"
// After what reads TOML, which knows words that an emulated device defines.
#include "borrowed.hpp"

namespace mpmpbd::python {

namespace {

// Takes actions and masks from the memory of the device too, and keeps them until the next ones have come.
template <class Envs> class StepLoopOnDevice : public StepLoop<Envs> {
  using Base = StepLoop<Envs>;

 public:
  using Base::Base;
  using Base::envs;

  // Nobody looks at the host's copy of what comes of it.
  void step(py::buffer const& actions) {
    auto const numbers = Base::actions_in(actions.request());
    Base::alone([&] { envs().step_from(envs().send(numbers)); });
  }
  void step_from(py::object const& actions) {
    Borrowed given(actions, envs().place());
    require(given.array(), Base::wanted_actions(envs().place()));
    Base::alone([&] {
      std::swap(actions_, given);
      envs().step_from(static_cast<float const*>(actions_.array().data));
    });
  }
  void reset_where_from(py::object const& mask) {
    Borrowed given(mask, envs().place());
    require(given.array(), Base::wanted_mask(envs().place()));
    Base::alone([&] {
      std::swap(mask_, given);
      envs().reset_where(static_cast<unsigned char const*>(mask_.array().data));
    });
  }

 private:
  Borrowed actions_, mask_;
};

Cuda::Execution execution_named(std::string const& name) {
  if (name == "automatic") return Cuda::Execution::automatic;
  if (name == "resident") return Cuda::Execution::resident;
  if (name == "tiled") return Cuda::Execution::tiled;
  throw std::invalid_argument("mpmpbd VectorEnv: execution = '" + name +
                              "'; give 'automatic', 'resident' or 'tiled'");
}

using Suturing = StepLoopOnDevice<rl::VectorEnv<rl::SuturingTask, Cuda>>;

std::shared_ptr<Suturing> suturing(Documents const& documents, std::int64_t num_envs,
                                   std::optional<std::int64_t> seed, std::string const& autoreset,
                                   std::int64_t first_environment, int device,
                                   std::uintptr_t stream, std::string const& execution) {
  return make_loop<Suturing>(
      documents,
      {.num_envs = num_envs,
       .autoreset = autoreset_named(autoreset),
       .first_environment = first_environment},
      seed,
      Cuda{.device = device, .stream = stream_of(stream), .execution = execution_named(execution)});
}

}  // namespace

void declare_suturing_on_device(py::module_& module) {
  declare_loop<Suturing>(module, "SuturingLoopOnDevice")
      .def(py::init(&suturing), py::arg("documents"), py::kw_only(), py::arg("num_envs"),
           py::arg("seed"), py::arg("autoreset"), py::arg("first_environment"), py::arg("device"),
           py::arg("stream"), py::arg("execution"))
      .def("step_from", &Suturing::step_from)
      .def("reset_where_from", &Suturing::reset_where_from);
}

}  // namespace mpmpbd::python
