#include "borrowed.hpp"

#include <mpmpbd/io/dlpack.hpp>

namespace mpmpbd::python {

namespace {

std::string text_of(DLDevice const& device) {
  return "(" + std::to_string(static_cast<int>(device.device_type)) + ", " +
         std::to_string(device.device_id) + ")";
}
std::string text_of(DLDataType const& type) {
  char const kind = type.code == kDLFloat          ? 'f'
                    : type.code == kDLInt          ? 'i'
                    : type.code == kDLUInt         ? 'u'
                    : type.code == io::dlpack_bool ? 'b'
                                                   : '?';
  return kind + std::to_string(type.bits / 8);
}

bool same_type(DLDataType const& given, ElementType wanted) {
  auto const of = io::detail::dlpack_type(wanted);
  bool const flags = of.code == kDLUInt && of.bits == 8 && given.code == io::dlpack_bool;
  return (given.code == of.code || flags) && given.bits == of.bits && given.lanes == 1;
}

DLTensor const& tensor_in(PyObject* capsule) {
  auto* const managed =
      static_cast<DLManagedTensor*>(PyCapsule_GetPointer(capsule, capsule_name<DLManagedTensor>));
  if (managed == nullptr) throw py::error_already_set();
  return managed->dl_tensor;
}

}  // namespace

Borrowed::Borrowed(py::object const& lender, Place const& place) : place_(place) {
  py::object lent = lender.attr("__dlpack__")(py::arg("stream") = stream_number(place));
  // The last that holds it may be a thread that Python does not know.
  capsule_ = {lent.release().ptr(), [](PyObject* capsule) {
                if (!Py_IsInitialized()) return;
                py::gil_scoped_acquire const interpreter;
                Py_DECREF(capsule);
              }};
}

void const* Borrowed::checked(ElementType element, std::vector<py::ssize_t> const& shape,
                              std::string const& wanted) const {
  DLTensor const& t = tensor_in(capsule_.get());
  auto const here = io::dlpack_device(place_);
  if (t.device.device_type != here.device_type || t.device.device_id != here.device_id)
    throw std::invalid_argument("mpmpbd VectorEnv: " + wanted + " needed on device " +
                                text_of(here) + "; given are some on " + text_of(t.device));
  std::vector<py::ssize_t> const given(t.shape, t.shape + t.ndim);
  bool fits = same_type(t.dtype, element) && given == shape;
  std::int64_t stride = 1;
  for (std::size_t a = shape.size(); fits && t.strides != nullptr && a-- > 0; stride *= shape[a])
    fits = shape[a] == 1 || t.strides[a] == stride;
  if (!fits)
    throw std::invalid_argument("mpmpbd VectorEnv: " + wanted +
                                " needed, without gaps; given are " + shape_text(given) + " of '" +
                                text_of(t.dtype) + "'");
  return static_cast<char const*>(t.data) + t.byte_offset;
}

}  // namespace mpmpbd::python
