// Arrays as DLPack tensors: what other libraries read of them, and how long the memory lives.
#include <mpmpbd/io/dlpack.hpp>

#include "../catch.hpp"

#include <cstddef>
#include <vector>

using namespace mpmpbd;
using Catch::Matchers::Contains;

#if defined(MPMPBD_HAS_DLPACK)

namespace {

struct Temperature : Field<"T", "K", Numbers<2>, Particles> {};

// (env, slot, component) = (2, 3, 2), counted up in memory.
std::shared_ptr<std::vector<float>> twelve() {
  auto numbers = std::make_shared<std::vector<float>>(12);
  for (std::size_t i = 0; i < 12; ++i) (*numbers)[i] = 0.5f * float(i);
  return numbers;
}

}  // namespace

TEST_CASE("a field as a tensor is the same memory", "[io][dlpack]") {
  auto const numbers = twelve();
  auto* const tensor = io::to_dlpack(field_array<Temperature>(numbers->data(), 2, 3), numbers);
  DLTensor const& t = tensor->dl_tensor;
  CHECK(t.data == numbers->data());
  CHECK(t.byte_offset == 0);
  CHECK(t.device.device_type == kDLCPU);
  CHECK(t.device.device_id == 0);
  CHECK(t.dtype.code == kDLFloat);
  CHECK(t.dtype.bits == 32);
  CHECK(t.dtype.lanes == 1);
  REQUIRE(t.ndim == 3);
  CHECK(std::vector<std::int64_t>(t.shape, t.shape + 3) == std::vector<std::int64_t>{2, 3, 2});
  auto const* data = static_cast<float const*>(t.data);
  // Component 1 of the last slot of environment 1 is the last number in memory.
  CHECK(data[t.strides[0] + 2 * t.strides[1] + t.strides[2]] == 5.5f);
  CHECK(data[t.strides[0]] == 1.5f);
  tensor->deleter(tensor);
}

TEST_CASE("a tensor keeps its memory alive until it is given back", "[io][dlpack]") {
  auto numbers = twelve();
  std::weak_ptr<std::vector<float>> const watch = numbers;
  auto* const tensor = io::to_dlpack(field_array<Temperature>(numbers->data(), 2, 3), numbers);
  auto* const other =
      io::to_dlpack<io::DlpackVersioned>(field_array<Temperature>(numbers->data(), 2, 3), numbers);
  numbers.reset();
  tensor->deleter(tensor);
  CHECK_FALSE(watch.expired());
  other->deleter(other);
  CHECK(watch.expired());
}

TEST_CASE("flags are of the type that DLPack has for them", "[io][dlpack]") {
  std::vector<unsigned char> flags{0, 1, 1};
  std::int64_t const shape[] = {3};
  auto array = contiguous_array(flags.data(), shape);
  array.element = element_type<bool>;
  auto* const tensor = io::to_dlpack(array, nullptr);
  CHECK(tensor->dl_tensor.dtype.code == 6);  // kDLBool of DLPack 0.8
  CHECK(tensor->dl_tensor.dtype.bits == 8);
  tensor->deleter(tensor);
  CHECK(array.as<unsigned char>() == flags.data());
  CHECK_THROWS_AS(array.as<float>(), std::invalid_argument);
}

TEST_CASE("read-only is said by DLPack 1.0, and refused to those before", "[io][dlpack]") {
  std::vector<std::int64_t> const numbers(6);
  std::int64_t const shape[] = {2, 3};
  auto const array = contiguous_array(numbers.data(), shape);
  CHECK_THROWS_WITH(io::to_dlpack(array, nullptr),
                    Contains("read-only") && Contains("ask for version 1.0, or copy it"));
  auto* const tensor = io::to_dlpack<io::DlpackVersioned>(array, nullptr);
  CHECK(tensor->version.major == 1);
  CHECK(tensor->flags == 1);
  CHECK(tensor->dl_tensor.dtype.code == kDLInt);
  CHECK(tensor->dl_tensor.dtype.bits == 64);
  tensor->deleter(tensor);

  std::vector<unsigned char> bytes(6);
  auto* const writable =
      io::to_dlpack<io::DlpackVersioned>(contiguous_array(bytes.data(), shape), nullptr);
  CHECK(writable->flags == 0);
  CHECK(writable->dl_tensor.dtype.code == kDLUInt);
  CHECK(writable->dl_tensor.dtype.bits == 8);
  writable->deleter(writable);
}

// The standard (dlpack.h of 1.0) fixes where consumers look.
TEST_CASE("the tensor of DLPack 1.0 is laid out as consumers expect", "[io][dlpack]") {
  using V = io::DlpackVersioned;
  CHECK(offsetof(V, version) == 0);
  CHECK(offsetof(V, manager_ctx) == 8);
  CHECK(offsetof(V, deleter) == 16);
  CHECK(offsetof(V, flags) == 24);
  CHECK(offsetof(V, dl_tensor) == 32);
  CHECK(sizeof(V) == 32 + sizeof(DLTensor));
}

TEST_CASE("an array on a device says which", "[io][dlpack]") {
  float* const there = reinterpret_cast<float*>(std::uintptr_t{0x7f00'0000'1000});
  auto const array = field_array<Temperature>(there, 2, 3, {MemorySpace::cuda, 1, nullptr});
  auto* const tensor = io::to_dlpack(array, nullptr);
  CHECK(tensor->dl_tensor.data == there);
  CHECK(tensor->dl_tensor.device.device_type == kDLCUDA);
  CHECK(tensor->dl_tensor.device.device_id == 1);
  tensor->deleter(tensor);
}

#endif
