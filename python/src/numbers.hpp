// Numbers of somebody else: what they have to be, and where they lie.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>
#include <vector>

#include <mpmpbd/core/array.hpp>

namespace mpmpbd::python {

namespace py = pybind11;

struct Wanted {
  std::string what;  // "actions of float32 and shape (2, 3) are"
  ElementType element;
  std::vector<std::int64_t> shape;
  Place place;
};

// (2, 3)
std::string text_of(std::vector<std::int64_t> const& shape);

// Of memory of the host.
Array array_of(py::buffer_info const& given);

// Throws std::invalid_argument unless `given` is what is wanted, without gaps. Flags will do for bytes.
void require(Array const& given, Wanted const& wanted);

}  // namespace mpmpbd::python
