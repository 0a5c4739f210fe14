// An array of a run where it lies, in memory of the host or of a device: how to find its numbers, not the numbers.
//
// What shows a run to others without a copy - io/dlpack.hpp, the Python module - is made from this.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

#include <mpmpbd/core/field.hpp>

namespace mpmpbd {

// With a sign, without, floating point, and flags: bytes that are 0 or 1.
enum class NumberKind { integer, natural, real, flag };

struct ElementType {
  NumberKind kind = NumberKind::real;
  int bytes = 0;
  bool operator==(ElementType const&) const = default;
};
template <class E>
inline constexpr ElementType element_type{std::is_same_v<E, bool>       ? NumberKind::flag
                                          : std::is_floating_point_v<E> ? NumberKind::real
                                          : std::is_signed_v<E>         ? NumberKind::integer
                                                                        : NumberKind::natural,
                                          static_cast<int>(sizeof(E))};

enum class MemorySpace { host, cuda };

// Where numbers lie, and who writes them there.
struct Place {
  MemorySpace memory = MemorySpace::host;
  int device = 0;
  void* stream =
      nullptr;  // a cudaStream_t in whose order they are written; null: the default stream
};

// Valid as long as what it describes, whose numbers it shows as they are when it is looked at.
struct Array {
  static constexpr int most_axes = 6;

  void* data = nullptr;
  ElementType element;
  bool read_only = false;
  Place place;
  int axes = 0;
  std::int64_t shape[most_axes] = {};
  std::int64_t strides[most_axes] = {};  // [elements]

  std::int64_t size() const {
    std::int64_t n = 1;
    for (int a = 0; a < axes; ++a) n *= shape[a];
    return n;
  }
  // As numbers of their own type, flags as `unsigned char`; throws std::invalid_argument for another.
  template <class E> E* as() const {
    using Element = std::remove_const_t<E>;
    constexpr bool byte = std::is_same_v<Element, unsigned char>;
    if (element_type<Element> != element && !(byte && element == element_type<bool>))
      throw std::invalid_argument("mpmpbd: an array of numbers of " +
                                  std::to_string(element.bytes) +
                                  " bytes was asked for as another type; see `element`");
    return static_cast<E*>(data);
  }
};

struct NamedArray {
  std::string name;
  Array array;
};

// Numbers without gaps, the last axis fastest. Of a `const` element: read-only.
template <class E>
Array contiguous_array(E* data, std::span<std::int64_t const> shape, Place place = {}) {
  if (shape.size() > Array::most_axes)
    throw std::invalid_argument("mpmpbd: an array of " + std::to_string(shape.size()) +
                                " axes asked for; give at most " +
                                std::to_string(Array::most_axes));
  Array all;
  all.data = const_cast<std::remove_const_t<E>*>(data);
  all.element = element_type<std::remove_const_t<E>>;
  all.read_only = std::is_const_v<E>;
  all.place = place;
  all.axes = static_cast<int>(shape.size());
  std::int64_t stride = 1;
  for (int a = all.axes - 1; a >= 0; --a) {
    all.shape[a] = shape[static_cast<std::size_t>(a)];
    all.strides[a] = stride;
    stride *= all.shape[a];
  }
  return all;
}

// A field as tables store it, (env, slot, component): one plane per component, slot fastest.
template <class F, class E>
Array field_array(E* planes, std::int64_t environments, std::int64_t capacity, Place place = {}) {
  Array all = contiguous_array(planes, std::span<std::int64_t const>{}, place);
  all.axes = 3;
  std::int64_t const shape[] = {environments, capacity, F::components};
  std::int64_t const strides[] = {capacity, 1, environments * capacity};
  for (int a = 0; a < 3; ++a) {
    all.shape[a] = shape[a];
    all.strides[a] = strides[a];
  }
  return all;
}

// Domain and name of a field: "particle.x".
template <class F> std::string full_name() {
  return std::string(F::Domain::name.view()) + "." + std::string(F::name.view());
}

// Calls f(F{}) for every field of a list that has a value between steps: scratch of a solver has none.
template <class List, class Function> void for_each_lasting_field(List list, Function&& f) {
  for_each_field(list, [&]<class F>(F field) {
    if constexpr (!requires { F::scratch; }) f(field);
  });
}

// A field of a run by its full name. Throws std::invalid_argument with the names that there are.
template <class Run> Array array_named(Run& run, std::string_view name) {
  Array found;
  std::string known;
  for_each_lasting_field(typename Run::Store::List{}, [&]<class F>(F) {
    auto const own = full_name<F>();
    if (own == name) found = run.template array<F>();
    known += (known.empty() ? "" : ", ") + own;
  });
  if (found.axes == 0)
    throw std::invalid_argument("mpmpbd: no field '" + std::string(name) +
                                "' is stored; there are " + known);
  return found;
}

}  // namespace mpmpbd
