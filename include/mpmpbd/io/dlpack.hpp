// Arrays handed to other libraries without a copy, by DLPack, where its header is present (Debian: libdlpack-dev).
//
//   DLManagedTensor* tensor = io::to_dlpack(run->array<bead::Position>(), run);   // run: a shared_ptr
//
// The consumer calls tensor->deleter(tensor) when it is done; until then the pointer that is given keeps the memory alive.
// NumPy, PyTorch, CuPy and JAX take such a tensor in a capsule; the Python module makes them.
#pragma once

#include <mpmpbd/core/array.hpp>

#if __has_include(<dlpack/dlpack.h>)
#define MPMPBD_HAS_DLPACK 1
#include <dlpack/dlpack.h>

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <utility>

namespace mpmpbd::io {

// The tensor of DLPack 1.0 and later, which knows its version and whether it may be written to. Debian 12 has the header of
// 0.6: what it lacks is declared here as the standard has it.
#if defined(DLPACK_MAJOR_VERSION)
using DlpackVersioned = DLManagedTensorVersioned;
inline constexpr std::uint64_t dlpack_read_only = DLPACK_FLAG_BITMASK_READ_ONLY;
#else
struct DlpackVersioned {
  struct {
    std::uint32_t major, minor;
  } version;
  void* manager_ctx;
  void (*deleter)(DlpackVersioned* self);
  std::uint64_t flags;
  DLTensor dl_tensor;
};
inline constexpr std::uint64_t dlpack_read_only = 1;
#endif
inline constexpr int dlpack_bool = 6;  // kDLBool, since 0.8

namespace detail {

template <class Managed> struct DlpackHolder {
  Managed tensor{};
  std::int64_t shape[Array::most_axes], strides[Array::most_axes];
  std::shared_ptr<void const> keep_alive;
};

inline DLDataType dlpack_type(ElementType element) {
  int const code = element.kind == NumberKind::real      ? kDLFloat
                   : element.kind == NumberKind::integer ? kDLInt
                   : element.kind == NumberKind::flag    ? dlpack_bool
                                                         : kDLUInt;
  return {static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(8 * element.bytes), 1};
}

}  // namespace detail

inline DLDevice dlpack_device(Place const& place) {
  DLDevice device{};
  device.device_type = place.memory == MemorySpace::cuda ? kDLCUDA : kDLCPU;
  device.device_id = place.memory == MemorySpace::cuda ? place.device : 0;
  return device;
}

// As `Managed`: DLManagedTensor, which every consumer takes, or DlpackVersioned. Throws std::invalid_argument for a read-only
// array as the former, which cannot say so.
//
// Nothing waits: on a device the consumer works after the array's writer, in the order of array.place.stream.
template <class Managed = DLManagedTensor>
Managed* to_dlpack(Array const& array, std::shared_ptr<void const> keep_alive) {
  constexpr bool versioned = std::is_same_v<Managed, DlpackVersioned>;
  if (array.read_only && !versioned)
    throw std::invalid_argument(
        "mpmpbd: a read-only array is asked for by DLPack before 1.0, which cannot say read-only; ask for version 1.0, or copy it");
  auto holder = std::make_unique<detail::DlpackHolder<Managed>>();
  for (int a = 0; a < array.axes; ++a) {
    holder->shape[a] = array.shape[a];
    holder->strides[a] = array.strides[a];
  }
  holder->keep_alive = std::move(keep_alive);
  Managed& tensor = holder->tensor;
  if constexpr (versioned) {
    tensor.version = {1, 0};
    tensor.flags = array.read_only ? dlpack_read_only : 0;
  }
  tensor.dl_tensor.data = array.data;
  tensor.dl_tensor.device = dlpack_device(array.place);
  tensor.dl_tensor.ndim = array.axes;
  tensor.dl_tensor.dtype = detail::dlpack_type(array.element);
  tensor.dl_tensor.shape = holder->shape;
  tensor.dl_tensor.strides = holder->strides;
  tensor.manager_ctx = holder.get();
  tensor.deleter = [](Managed* self) {
    delete static_cast<detail::DlpackHolder<Managed>*>(self->manager_ctx);
  };
  return &holder.release()->tensor;
}

}  // namespace mpmpbd::io
#endif
