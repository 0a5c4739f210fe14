// Numbers that another library has in the memory of a device, lent to us by DLPack: nothing is copied.
#pragma once

#include <memory>

#include "array.hpp"

namespace mpmpbd::python {

// Alive as long as this.
class Borrowed {
 public:
  Borrowed() = default;
  // The lender sees to it that work on the stream of `place`, begun from now on, finds them written.
  Borrowed(py::object const& lender, Place const& place);

  Array const& array() const { return array_; }

 private:
  struct GiveBack {
    void operator()(PyObject* capsule) const;
  };
  std::unique_ptr<PyObject, GiveBack> capsule_;  // keeps its name: whoever destroys it gives back
  Array array_;
};

}  // namespace mpmpbd::python
