#include "array.hpp"

namespace mpmpbd::python {

namespace {

std::string text_of(py::handle object) { return py::str(object); }

// A consumer that has taken a tensor renames its capsule and calls its deleter when it is done.
template <class Managed> py::object capsule(SharedArray const& a) {
  auto* const tensor = io::to_dlpack<Managed>(a.array, a.owner);
  PyObject* const made = PyCapsule_New(tensor, capsule_name<Managed>, [](PyObject* self) {
    if (!PyCapsule_IsValid(self, capsule_name<Managed>)) return;
    auto* const left = static_cast<Managed*>(PyCapsule_GetPointer(self, capsule_name<Managed>));
    left->deleter(left);
  });
  if (made == nullptr) {
    tensor->deleter(tensor);
    throw py::error_already_set();
  }
  return py::reinterpret_steal<py::object>(made);
}

// Nothing is waited for: the consumer has to work on the stream that writes the array, or say by -1 that it keeps order itself.
void check_stream(Place const& place, py::object const& stream) {
  if (place.memory == MemorySpace::host) {
    if (!stream.is_none())
      throw py::buffer_error("mpmpbd: an array of the host has no stream; give stream=None");
    return;
  }
  auto const wanted = stream.is_none() ? 1 : stream.cast<std::int64_t>();
  auto const own = stream_number(place);
  if (wanted != -1 && wanted != own)
    throw py::buffer_error("mpmpbd: this array is written on stream " + std::to_string(own) +
                           " and asked for on stream " + std::to_string(wanted) +
                           "; work on its stream, or give stream=-1 and keep the order yourself");
}

py::object to_capsule(SharedArray const& a, py::object const& stream, py::object const& max_version,
                      py::object const& dl_device, py::object const& copy) {
  auto const here = io::dlpack_device(a.array.place);
  auto const place = py::make_tuple(static_cast<int>(here.device_type), here.device_id);
  if (!dl_device.is_none() && !py::tuple(dl_device).equal(place))
    throw py::buffer_error("mpmpbd: this array lies on device " + text_of(place) +
                           " and is not moved to " + text_of(dl_device));
  if (!copy.is_none() && copy.cast<bool>())
    throw py::buffer_error("mpmpbd: arrays are handed out without copies; copy what you get");
  check_stream(a.array.place, stream);
  bool const versioned = !max_version.is_none() && py::tuple(max_version)[0].cast<int>() >= 1;
  if (versioned) return capsule<io::DlpackVersioned>(a);
  if (a.array.read_only)
    throw py::buffer_error(
        "mpmpbd: a read-only array is asked for by DLPack before 1.0, which cannot say read-only; "
        "use " +
        std::string(a.array.place.memory == MemorySpace::host
                        ? "numpy.asarray"
                        : "a library that asks for 1.0, or cupy.asarray") +
        ", or copy it");
  return capsule<DLManagedTensor>(a);
}

py::tuple tuple_of(std::int64_t const* numbers, int count, std::int64_t factor = 1) {
  py::tuple all(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) all[static_cast<std::size_t>(i)] = factor * numbers[i];
  return all;
}

std::string type_string(ElementType element) {
  char const kind = element.kind == NumberKind::real      ? 'f'
                    : element.kind == NumberKind::integer ? 'i'
                    : element.kind == NumberKind::flag    ? 'b'
                                                          : 'u';
  return std::string(element.bytes == 1 ? "|" : "<") + kind + std::to_string(element.bytes);
}

// What both dictionaries have in common (version 3 of either).
py::dict interface(Array const& a, MemorySpace memory, char const* name) {
  if (a.place.memory != memory)
    throw py::attribute_error(std::string("mpmpbd: an array ") +
                              (memory == MemorySpace::cuda ? "of the host" : "on a CUDA device") +
                              " has no " + name);
  py::dict said;
  said["shape"] = tuple_of(a.shape, a.axes);
  said["typestr"] = type_string(a.element);
  said["strides"] = tuple_of(a.strides, a.axes, a.element.bytes);
  auto const address = a.size() == 0 ? 0 : reinterpret_cast<std::uintptr_t>(a.data);
  said["data"] = py::make_tuple(address, a.read_only);
  said["version"] = 3;
  return said;
}

}  // namespace

std::string text_of(Place const& place) {
  return place.memory == MemorySpace::host ? "the host"
                                           : "CUDA device " + std::to_string(place.device);
}

std::int64_t stream_number(Place const& place) {
  auto const handle = static_cast<std::int64_t>(reinterpret_cast<std::intptr_t>(place.stream));
  return handle == 0 ? 1 : handle;
}
void* stream_of(std::uintptr_t number) {
  return number == 1 ? nullptr : reinterpret_cast<void*>(number);
}

void declare_array(py::module_& module) {
  py::class_<SharedArray>(
      module, "Array",
      "Numbers of a run where they lie, on the host or on a device; numpy.asarray, "
      "torch.from_dlpack, cupy.asarray and their like take it without a copy.")
      .def("__dlpack__", &to_capsule, py::kw_only(), py::arg("stream") = py::none(),
           py::arg("max_version") = py::none(), py::arg("dl_device") = py::none(),
           py::arg("copy") = py::none())
      .def("__array__",
           [](py::object const& self, py::args const&, py::kwargs const&) -> py::object {
             auto const& place = self.cast<SharedArray const&>().array.place;
             if (place.memory == MemorySpace::cuda)
               throw py::type_error(
                   "mpmpbd: this array lies on " + text_of(place) +
                   " and is not copied; give it to torch.from_dlpack, cupy.asarray or the like");
             return py::module_::import("numpy").attr("asarray")(self);
           })
      .def("__dlpack_device__",
           [](SharedArray const& a) {
             auto const here = io::dlpack_device(a.array.place);
             return py::make_tuple(static_cast<int>(here.device_type), here.device_id);
           })
      .def_property_readonly("__array_interface__",
                             [](SharedArray const& a) {
                               return interface(a.array, MemorySpace::host, "__array_interface__");
                             })
      .def_property_readonly("__cuda_array_interface__",
                             [](SharedArray const& a) {
                               auto said = interface(a.array, MemorySpace::cuda,
                                                     "__cuda_array_interface__");
                               said["stream"] = stream_number(a.array.place);
                               return said;
                             })
      .def_property_readonly(
          "shape", [](SharedArray const& a) { return tuple_of(a.array.shape, a.array.axes); })
      .def_property_readonly("typestr",
                             [](SharedArray const& a) { return type_string(a.array.element); })
      .def_property_readonly("read_only", [](SharedArray const& a) { return a.array.read_only; })
      .def("__repr__", [](SharedArray const& a) {
        auto const shape = tuple_of(a.array.shape, a.array.axes);
        return "<mpmpbd.Array " + text_of(shape) + " of '" + type_string(a.array.element) +
               "' on " + text_of(a.array.place) + ">";
      });
}

}  // namespace mpmpbd::python
