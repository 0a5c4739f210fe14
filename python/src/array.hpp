// An array of the library as Python sees it: where it lies, and what keeps it alive. No numbers are copied.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <mpmpbd/io/dlpack.hpp>

#if !defined(MPMPBD_HAS_DLPACK)
#error \
    "mpmpbd: the Python module needs the header of DLPack: scripts/setup.sh python installs it (libdlpack-dev)"
#endif

namespace mpmpbd::python {

namespace py = pybind11;

// It speaks by where its memory is: __array_interface__ on the host, __cuda_array_interface__ on a device, __dlpack__ on both.
struct SharedArray {
  Array array;
  std::shared_ptr<void const> owner;
};

void declare_array(py::module_& module);

// "the host", "CUDA device 0"
std::string text_of(Place const& place);

// What the capsule of a tensor is called until somebody takes the tensor.
template <class Managed> inline constexpr char const* capsule_name = "dltensor";
template <> inline constexpr char const* capsule_name<io::DlpackVersioned> = "dltensor_versioned";

// Streams as the array protocols number them: 1 is the default stream, which CUDA writes as a null pointer.
std::int64_t stream_number(Place const& place);
void* stream_of(std::uintptr_t number);

// {name: array}
inline py::dict dict_of(std::vector<NamedArray> const& all,
                        std::shared_ptr<void const> const& owner) {
  py::dict named;
  for (auto const& one : all) named[one.name.c_str()] = SharedArray{one.array, owner};
  return named;
}

}  // namespace mpmpbd::python
