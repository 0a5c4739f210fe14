// The step loop of the suturing task on a CUDA device, where the module was built with CUDA; else nothing.
#pragma once

#include <pybind11/pybind11.h>

namespace mpmpbd::python {

#if defined(MPMPBD_PYTHON_ON_DEVICE)
void declare_suturing_on_device(pybind11::module_& module);
#else
inline void declare_suturing_on_device(pybind11::module_&) {}
#endif

}  // namespace mpmpbd::python
