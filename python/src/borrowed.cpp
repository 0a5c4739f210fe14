#include "borrowed.hpp"

#include <mpmpbd/backend/cuda/memory.cuh>

namespace mpmpbd::python {

namespace {

// Of DLPack 1.0 where the lender knows it: numbers that may only be read are lent then, too.
py::object lend(py::object const& lender, Place const& place) {
  cuda::OnDevice const here(
      place.device);  // a lender may know the streams of the present one alone
  auto const ask = lender.attr("__dlpack__");
  auto const stream = stream_number(place);
  try {
    return ask(py::arg("stream") = stream, py::arg("max_version") = py::make_tuple(1, 0));
  } catch (py::error_already_set& e) {
    if (!e.matches(PyExc_TypeError)) throw;
  }
  return ask(py::arg("stream") = stream);
}

template <class Managed> Managed& in(PyObject* capsule) {
  void* const found = PyCapsule_GetPointer(capsule, capsule_name<Managed>);
  if (found == nullptr) throw py::error_already_set();
  return *static_cast<Managed*>(found);
}
DLTensor const& tensor_in(PyObject* capsule) {
  if (!PyCapsule_IsValid(capsule, capsule_name<io::DlpackVersioned>))
    return in<DLManagedTensor>(capsule).dl_tensor;
  auto const& lent = in<io::DlpackVersioned>(capsule);
  if (lent.version.major != 1)
    throw py::buffer_error("mpmpbd: a tensor of DLPack " + std::to_string(lent.version.major) +
                           " is lent; 1 and those before it are known");
  return lent.dl_tensor;
}

// 0 bytes: a type that an array does not have.
ElementType element_of(DLDataType const& type) {
  int const bytes = type.lanes == 1 && type.bits % 8 == 0 ? type.bits / 8 : 0;
  if (type.code == kDLFloat) return {NumberKind::real, bytes};
  if (type.code == kDLInt) return {NumberKind::integer, bytes};
  if (type.code == kDLUInt) return {NumberKind::natural, bytes};
  if (type.code == io::dlpack_bool) return {NumberKind::flag, bytes};
  return {};
}

Array array_of(DLTensor const& t) {
  bool const on_device = t.device.device_type == kDLCUDA || t.device.device_type == kDLCUDAManaged;
  Place const place{on_device ? MemorySpace::cuda : MemorySpace::host, t.device.device_id, {}};
  Array all = contiguous_array(static_cast<char*>(t.data) + t.byte_offset,
                               {t.shape, static_cast<std::size_t>(t.ndim)}, place);
  all.element = element_of(t.dtype);
  for (int axis = 0; t.strides != nullptr && axis < t.ndim; ++axis)
    all.strides[axis] = t.strides[axis];
  return all;
}

}  // namespace

// The last that holds an array may be a thread that Python does not know.
void Borrowed::GiveBack::operator()(PyObject* capsule) const {
  if (!Py_IsInitialized()) return;
  py::gil_scoped_acquire const interpreter;
  Py_DECREF(capsule);
}

Borrowed::Borrowed(py::object const& lender, Place const& place)
    : capsule_(lend(lender, place).release().ptr()), array_(array_of(tensor_in(capsule_.get()))) {}

}  // namespace mpmpbd::python
