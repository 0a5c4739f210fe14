// A field of two numbers per particle, in memory that somebody else has on a device: what check.py shows to PyTorch and CuPy.
#include "array.hpp"

namespace {
using namespace mpmpbd;
struct Pair : Field<"pair", "1", Numbers<2>, Particles> {};
}  // namespace

PYBIND11_MODULE(arrays, module) {
  python::declare_array(module);
  module.def("pairs",
             [](std::uintptr_t address, int device, std::uintptr_t stream, bool read_only) {
               Place const place{MemorySpace::cuda, device, reinterpret_cast<void*>(stream)};
               Array a = field_array<Pair>(reinterpret_cast<float*>(address), 2, 3, place);
               a.read_only = read_only;
               return python::SharedArray{a, nullptr};
             });
}
