// Arrays for tests of how arrays speak to other libraries: on a device that is not there, and with an owner that is watched.
#include "array.hpp"

#include <cstdint>
#include <numeric>
#include <vector>

namespace {

using namespace mpmpbd;
using python::SharedArray;

struct Pair : Field<"pair", "1", Numbers<2>, Particles> {};

int watched = 0;  // owners that are alive

// (env, slot, component) = (2, 3, 2), counted up in memory.
struct Watched {
  std::vector<double> numbers = std::vector<double>(12);
  Watched() {
    std::iota(numbers.begin(), numbers.end(), 0.0);
    ++watched;
  }
  ~Watched() { --watched; }
};

SharedArray on_host(bool read_only) {
  auto const owner = std::make_shared<Watched>();
  Array array = field_array<Pair>(owner->numbers.data(), 2, 3);
  array.read_only = read_only;
  return {array, owner};
}
SharedArray on_device(std::uintptr_t address, int device, std::uintptr_t stream) {
  Place const place{MemorySpace::cuda, device, reinterpret_cast<void*>(stream)};
  return {field_array<Pair>(reinterpret_cast<float*>(address), 2, 3, place), nullptr};
}

}  // namespace

PYBIND11_MODULE(made_up, module) {
  module.def("on_host", &on_host);
  module.def("on_device", &on_device);
  module.def("watched", [] { return watched; });
}
