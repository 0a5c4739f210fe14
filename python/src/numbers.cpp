#include "numbers.hpp"

#include <stdexcept>
#include <string_view>

#include "array.hpp"

namespace mpmpbd::python {

namespace {

std::string text_of(ElementType const& element) {
  if (element.bytes == 0) return "another type";
  if (element == element_type<bool>) return "bool";
  std::string const kind = element.kind == NumberKind::real      ? "float"
                           : element.kind == NumberKind::integer ? "int"
                                                                 : "uint";
  return kind + std::to_string(8 * element.bytes);
}

// By the letter of the buffer protocol; 0 bytes: none that an array has.
ElementType element_of(std::string const& format, py::ssize_t bytes) {
  auto const is_one_of = [&](std::string_view letters) {
    return !format.empty() && letters.find(format.back()) != std::string_view::npos;
  };
  auto const size = static_cast<int>(bytes);
  if (is_one_of("efdg")) return {NumberKind::real, size};
  if (is_one_of("bhilqn")) return {NumberKind::integer, size};
  if (is_one_of("BHILQN")) return {NumberKind::natural, size};
  if (is_one_of("?")) return {NumberKind::flag, size};
  return {};
}

bool has_gaps(Array const& a) {
  std::int64_t stride = 1;
  for (int axis = a.axes; axis-- > 0; stride *= a.shape[axis])
    if (a.shape[axis] != 1 && a.strides[axis] != stride) return true;
  return false;
}

bool same_place(Place const& a, Place const& b) {
  return a.memory == b.memory && (a.memory == MemorySpace::host || a.device == b.device);
}

}  // namespace

std::string text_of(std::vector<std::int64_t> const& shape) {
  std::string text = "(";
  for (auto n : shape) text += (text.size() > 1 ? ", " : "") + std::to_string(n);
  return text + ")";
}

Array array_of(py::buffer_info const& given) {
  Array all = contiguous_array(static_cast<char*>(given.ptr), given.shape);
  all.element = element_of(given.format, given.itemsize);
  for (int axis = 0; axis < all.axes; ++axis) {
    auto const bytes = given.strides[static_cast<std::size_t>(axis)];
    all.strides[axis] = bytes % given.itemsize == 0 ? bytes / given.itemsize : 0;
  }
  return all;
}

void require(Array const& given, Wanted const& wanted) {
  std::string const needed = "mpmpbd VectorEnv: " + wanted.what + " needed";
  if (!same_place(given.place, wanted.place))
    throw std::invalid_argument(needed + " on " + text_of(wanted.place) + "; given are some on " +
                                text_of(given.place));
  std::vector<std::int64_t> const shape(given.shape, given.shape + given.axes);
  bool const flags =
      wanted.element == element_type<unsigned char> && given.element == element_type<bool>;
  if (shape != wanted.shape || (given.element != wanted.element && !flags))
    throw std::invalid_argument(needed + "; given are " + text_of(shape) + " of " +
                                text_of(given.element));
  if (has_gaps(given))
    throw std::invalid_argument(needed + ", without gaps; given are some with gaps");
}

}  // namespace mpmpbd::python
