#include "on_device.hpp"

#include <mpmpbd/catalog/suturing_task.hpp>
#include <mpmpbd/rl/cuda/vector_env.hpp>

#include "borrowed.hpp"
#include "step_loop.hpp"

namespace mpmpbd::python {

namespace {

// Takes actions and masks from the memory of the device too, and keeps them until the next ones have come.
template <class Envs> class StepLoopOnDevice : public StepLoop<Envs> {
  using Base = StepLoop<Envs>;

 public:
  using Base::Base;
  using Base::envs;

  void step_from(py::object const& actions) {
    Borrowed given(actions, envs().place());
    auto const* const numbers =
        given.contiguous<float>(Base::actions_shape(), Base::actions_wanted());
    Base::alone([&] { envs().step_from(numbers); });
    actions_ = std::move(given);
  }
  void reset_from(py::object const& mask) {
    Borrowed given(mask, envs().place());
    auto const* const where =
        given.contiguous<unsigned char>(Base::mask_shape(), Base::mask_wanted());
    Base::alone([&] { envs().reset_where(where); });
    mask_ = std::move(given);
  }

 private:
  Borrowed actions_, mask_;
};

using Suturing = StepLoopOnDevice<rl::VectorEnv<rl::SuturingTask, Cuda>>;

std::shared_ptr<Suturing> suturing(Documents const& documents, std::int64_t num_envs,
                                   std::int64_t seed, std::string const& autoreset,
                                   std::int64_t first_environment, int device,
                                   std::uintptr_t stream) {
  rl::VectorEnvOptions const options{num_envs, seed, autoreset_named(autoreset), first_environment};
  return std::make_shared<Suturing>(config_of<rl::SuturingTask::Config>(documents), options,
                                    Cuda{.device = device, .stream = stream_of(stream)});
}

}  // namespace

void declare_suturing_on_device(py::module_& module) {
  declare_loop<Suturing>(module, "SuturingLoopOnDevice")
      .def(py::init(&suturing), py::arg("documents"), py::kw_only(), py::arg("num_envs"),
           py::arg("seed"), py::arg("autoreset"), py::arg("first_environment"), py::arg("device"),
           py::arg("stream"), py::call_guard<py::gil_scoped_release>())
      .def("step_from", &Suturing::step_from)
      .def("reset_from", &Suturing::reset_from);
}

}  // namespace mpmpbd::python
