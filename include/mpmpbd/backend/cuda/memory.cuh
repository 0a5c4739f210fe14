// Device memory, launches, and the errors of the CUDA run-time as sentences.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace mpmpbd::cuda {

// Throws std::runtime_error: what was tried, and what CUDA says.
inline void require(cudaError_t e, std::string const& what) {
  if (e == cudaSuccess) return;
  cudaGetLastError();  // so that the next call does not report it again
  throw std::runtime_error("mpmpbd Cuda: " + what + " failed: " + cudaGetErrorString(e));
}

// Calls on another device than the thread's present one.
class OnDevice {
 public:
  explicit OnDevice(int device) : now_(device) {
    require(cudaGetDevice(&before_), "asking for the present device");
    if (before_ != now_) require(cudaSetDevice(now_), "going to device " + std::to_string(now_));
  }
  ~OnDevice() {
    if (before_ != now_) cudaSetDevice(before_);
  }
  OnDevice(OnDevice const&) = delete;
  OnDevice& operator=(OnDevice const&) = delete;

 private:
  int now_, before_ = 0;
};

// Refuses what the present device has no memory for, before anything is taken.
inline void require_free(std::size_t bytes) {
  std::size_t free = 0, all = 0;
  require(cudaMemGetInfo(&free, &all), "asking for the free memory");
  if (bytes > free)
    throw std::runtime_error("mpmpbd Cuda: " + std::to_string(bytes >> 20) + " MiB needed, " +
                             std::to_string(free >> 20) +
                             " MiB of the device are free; use fewer environments");
}

// Copies bytes in the order of a stream.
inline void copy(cudaStream_t stream, void* to, void const* from, std::size_t bytes,
                 cudaMemcpyKind way) {
  if (bytes > 0) require(cudaMemcpyAsync(to, from, bytes, way, stream), "copying");
}

// Lets each block of a kernel have so many bytes of shared memory on the present device.
template <class... Args> void reserve_shared(void (*kernel)(Args...), std::int64_t bytes) {
  require(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                               static_cast<int>(bytes)),
          "reserving shared memory for a program of this architecture");
}

// Starts a kernel; `bytes` of shared memory for each of its blocks. What cannot be started throws, and says `what` it
// was.
template <class... Args>
void start(cudaStream_t stream, char const* what, void (*kernel)(Args...), std::int64_t blocks,
           int threads, std::size_t bytes, std::remove_cvref_t<Args>... args) {
  void* list[] = {const_cast<void*>(static_cast<void const*>(&args))...};
  auto const e = cudaLaunchKernel(kernel, dim3(static_cast<unsigned>(blocks)),
                                  dim3(static_cast<unsigned>(threads)), list, bytes, stream);
  if (e != cudaSuccess) require(e, std::string("launching ") + what);
}

// Bytes on the present device.
class Memory {
 public:
  Memory() = default;
  // Refused before anything is allocated when there is not enough.
  explicit Memory(std::size_t bytes) : bytes_(bytes) {
    if (bytes == 0) return;
    require_free(bytes);
    require(cudaMalloc(&data_, bytes), "allocating " + std::to_string(bytes) + " bytes");
  }
  Memory(Memory&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}
  Memory& operator=(Memory&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  ~Memory() { cudaFree(data_); }

  std::size_t bytes() const { return bytes_; }
  template <class U = char> U* as(std::size_t offset = 0) const {
    return reinterpret_cast<U*>(static_cast<char*>(data_) + offset);
  }

 private:
  void* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace mpmpbd::cuda
