// A named column of numbers of any type: what file formats store per point.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd::io {

static_assert(std::endian::native == std::endian::little,
              "files are written little endian, as in memory");

enum class NumberType { uint8, int32, int64, float32, float64 };

struct NumberTypeInfo {
  NumberType type;
  std::string_view vtk;
  std::string_view ply;
  std::size_t bytes;
};
inline constexpr NumberTypeInfo number_types[] = {
    {NumberType::uint8, "UInt8", "uchar", 1},
    {NumberType::int32, "Int32", "int", 4},
    {NumberType::int64, "Int64", "", 8},  // none in PLY
    {NumberType::float32, "Float32", "float", 4},
    {NumberType::float64, "Float64", "double", 8}};
inline NumberTypeInfo const& info(NumberType type) { return number_types[static_cast<int>(type)]; }

namespace detail {
template <class T> struct Numbers {
  using Scalar = T;
  static constexpr int components = 1;
};
template <class T, int R, int C> struct Numbers<Mat<T, R, C>> {
  using Scalar = T;
  static constexpr int components = R * C;
};
template <class T> constexpr NumberType number_type() {
  if constexpr (std::is_same_v<T, std::uint8_t>)
    return NumberType::uint8;
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return NumberType::int32;
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return NumberType::int64;
  else if constexpr (std::is_same_v<T, float>)
    return NumberType::float32;
  else {
    static_assert(std::is_same_v<T, double>,
                  "mpmpbd: files store uint8, int32, int64, float and double");
    return NumberType::float64;
  }
}
}  // namespace detail

// A view: the numbers must live until the file is written. Shape (rows, components).
struct DataArray {
  std::string name;
  NumberType type;
  int components;
  std::size_t rows;
  std::byte const* data;

  std::size_t row_bytes() const { return std::size_t(components) * info(type).bytes; }
  std::size_t bytes() const { return rows * row_bytes(); }
};

// Of a span or vector of numbers, vectors (Vec3<T>) or matrices.
template <class Range> DataArray data_array(std::string name, Range const& values) {
  auto const view = std::span(values);
  using Numbers = detail::Numbers<std::remove_cv_t<typename decltype(view)::element_type>>;
  return {std::move(name), detail::number_type<typename Numbers::Scalar>(), Numbers::components,
          view.size(), reinterpret_cast<std::byte const*>(view.data())};
}

}  // namespace mpmpbd::io
