// An array of the library as Python sees it: where it lies, and what keeps it alive. No numbers are copied.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <utility>
#include <vector>

#include <mpmpbd/core/array.hpp>

namespace mpmpbd::python {

namespace py = pybind11;

// It speaks by where its memory is: __array_interface__ on the host, __cuda_array_interface__ on a device, __dlpack__ on both.
struct SharedArray {
  Array array;
  std::shared_ptr<void const> owner;
};

void declare_array(py::module_& module);

// {name: array}
inline py::dict dict_of(std::vector<NamedArray> const& all,
                        std::shared_ptr<void const> const& owner) {
  py::dict named;
  for (auto const& one : all) named[one.name.c_str()] = SharedArray{one.array, owner};
  return named;
}

}  // namespace mpmpbd::python
