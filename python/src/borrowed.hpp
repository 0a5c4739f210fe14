// Numbers that another library has in the memory of a device, lent to us by DLPack: nothing is copied.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "array.hpp"

namespace mpmpbd::python {

// Alive as long as this.
class Borrowed {
 public:
  Borrowed() = default;
  // The lender sees to it that work on the stream of `place` finds them written.
  Borrowed(py::object const& lender, Place const& place);

  // Their address, where they are of this type and shape and have no gaps; else std::invalid_argument says what is wanted.
  template <class E>
  E const* contiguous(std::vector<py::ssize_t> const& shape, std::string const& wanted) const {
    return static_cast<E const*>(checked(element_type<E>, shape, wanted));
  }

 private:
  void const* checked(ElementType element, std::vector<py::ssize_t> const& shape,
                      std::string const& wanted) const;

  std::shared_ptr<PyObject>
      capsule_;  // of its first name still: it gives the numbers back when it goes
  Place place_;
};

}  // namespace mpmpbd::python
