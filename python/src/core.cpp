// mpmpbd._core: arrays, and the step loop of the suturing task.
#include <mpmpbd/catalog/suturing_task.hpp>
#include <mpmpbd/version.hpp>

#include "step_loop.hpp"

namespace mpmpbd::python {

void declare_suturing_on_device(py::module_& module);  // on_device.cpp, where CUDA is

namespace {

using Suturing = StepLoop<rl::VectorEnv<rl::SuturingTask, Threads>>;

std::shared_ptr<Suturing> suturing(Documents const& documents, std::int64_t num_envs,
                                   std::optional<std::int64_t> seed, std::string const& autoreset,
                                   std::int64_t first_environment, int threads) {
  if (threads < 0)
    throw std::invalid_argument("mpmpbd VectorEnv: threads = " + std::to_string(threads) +
                                "; give 0 for as many as the machine has, or a positive number");
  return make_loop<Suturing>(documents,
                             {.num_envs = num_envs,
                              .autoreset = autoreset_named(autoreset),
                              .first_environment = first_environment},
                             seed, Threads{threads});
}

}  // namespace

}  // namespace mpmpbd::python

PYBIND11_MODULE(_core, module) {
  using namespace mpmpbd::python;
  module.attr("__version__") = MPMPBD_VERSION_STRING;
  declare_array(module);
  declare_loop<Suturing>(module, "SuturingLoop")
      .def(py::init(&suturing), py::arg("documents"), py::kw_only(), py::arg("num_envs"),
           py::arg("seed"), py::arg("autoreset"), py::arg("first_environment"), py::arg("threads"));
#if defined(MPMPBD_PYTHON_ON_DEVICE)
  declare_suturing_on_device(module);
#endif
}
