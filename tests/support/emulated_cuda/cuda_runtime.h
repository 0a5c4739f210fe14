// A CUDA device made of plain C++, so that kernels are tested where there is no GPU.
//
// Stands in for the header of the same name when its folder comes first. The threads of a block are fibers on one
// thread of the host; they change places at barriers only, in an order drawn from `emulated::seed`. What depends on
// the order of threads then shows as other bits, and a barrier that not all reach as a deadlock, which is reported.
//
// Races between two barriers are seen where the thread sanitizer is at work (races.hpp).
//
// Not emulated: clusters, more than one block at a time.
#pragma once

#include <atomic>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "fiber.hpp"
#include "races.hpp"

#define __global__
#define __device__
#define __host__
#define __forceinline__ inline
#define __noinline__ __attribute__((noinline))
#define __shared__
#define __grid_constant__
#define __launch_bounds__(...)

struct uint3 {
  unsigned x, y, z;
};
struct dim3 {
  unsigned x, y, z;
  dim3(unsigned x_ = 1, unsigned y_ = 1, unsigned z_ = 1) : x(x_), y(y_), z(z_) {}
};
struct alignas(16) float4 {
  float x, y, z, w;
};
inline float4 make_float4(float x, float y, float z, float w) { return {x, y, z, w}; }

inline uint3 threadIdx{}, blockIdx{};
inline dim3 blockDim{}, gridDim{};

// What `extern __shared__ char dynamic_shared_memory[]` of a kernel names.
namespace mpmpbd::cuda {
alignas(16) inline char dynamic_shared_memory[232448];
}  // namespace mpmpbd::cuda

namespace emulated {

// What tests choose.
inline unsigned seed = 1;
inline int devices = 1;
inline std::size_t free_bytes = std::size_t{1} << 34;
inline int multiprocessors = 2;
inline int shared_bytes_per_block = 232448;
inline int launches = 0, allocations = 0, copies = 0, waits = 0;  // counted
inline int refused_launch = 0;                                    // its number; 0: none
inline int present_device = 0, waited_for = 0;                    // waited_for: the device of the last wait

// Bytes of shared memory that a kernel may have, where more than every device gives unasked has been granted.
inline std::map<void*, std::size_t>& granted() {
  static std::map<void*, std::size_t> bytes;
  return bytes;
}
inline std::size_t most_shared_bytes(void* kernel) {
  auto const asked = granted().find(kernel);
  return asked != granted().end() ? asked->second : std::size_t{48} << 10;
}

// Memory of the device, by address: how many bytes.
inline std::map<void*, std::size_t>& taken() {
  static std::map<void*, std::size_t> bytes;
  return bytes;
}
inline std::size_t taken_bytes() {
  std::size_t sum = 0;
  for (auto const& [memory, bytes] : taken()) sum += bytes;
  return sum;
}

// One block of threads.
class Block {
 public:
  static Block*& running() {
    static Block* block = nullptr;
    return block;
  }

  Block(unsigned threads, std::function<void()> kernel)
      : kernel_(std::move(kernel)), state_(seed), left_(threads), threads_(threads) {
    for (unsigned t = 0; t < threads; ++t) {
      fiber(t).begin(&Block::enter);
      ready_.push_back(t);
    }
  }
  void run() {
    running() = this;
    races::arrive(&begun_);
    {
      races::Ignored const bookkeeping;
      while (left_ > 0) resume(next());
    }
    races::leave(&ended_);
    running() = nullptr;
  }
  // The present thread waits until `count` threads have come to barrier `id`.
  void wait(unsigned id, unsigned count) {
    races::Ignored const bookkeeping;
    Barrier& b = barriers_[id];
    // Two meetings that follow one another are told apart: who is late at the first one knows nothing of the second.
    char* const meeting = &b.meetings[b.number % 2];
    races::arrive(meeting);
    b.waiting.push_back(threadIdx.x);
    if (b.waiting.size() == count) {
      ++b.number;
      ready_.insert(ready_.end(), b.waiting.begin(), b.waiting.end());
      b.waiting.clear();
    }
    rest();
    races::leave(meeting);
  }
  // Whether any thread brings something else than 0.
  bool any(bool value) {
    races::Ignored const bookkeeping;
    auto const all_are_here = [this] { wait(0, static_cast<unsigned>(threads_.size())); };
    all_are_here();
    any_ = any_ || value;
    all_are_here();
    bool const result = any_;
    all_are_here();
    any_ = false;
    return result;
  }
  // What all lanes of the present warp bring, by lane. Who is here a second time knows that all have read what
  // was there the time before, so two lists that take turns are enough.
  template <class T> auto gather(T value) {
    static_assert(sizeof(T) <= 8);
    races::Ignored const bookkeeping;
    unsigned const warp = threadIdx.x / 32, lane = threadIdx.x % 32;
    bool const turn = threads_[threadIdx.x].turn = !threads_[threadIdx.x].turn;
    auto* values = warps_[warp].bytes[turn ? 1 : 0];
    std::memcpy(values[lane], &value, sizeof value);
    wait(first_warp_barrier + warp, 32);
    return [values](unsigned of) {
      T from;
      std::memcpy(&from, values[of], sizeof from);
      return from;
    };
  }
  // A copy of the present thread is made at once or when it waits for it, by lot; where races are sought, both times.
  void promise(void* to, void const* from, std::size_t bytes) {
    bool const at_once = draws_lot();
    if (at_once || races::sought) copy({to, from, bytes});
    if (at_once && !races::sought) return;
    races::Ignored const bookkeeping;
    threads_[threadIdx.x].promised.push_back({to, from, bytes});
  }
  void keep_promises() {
    races::ignore(true);
    auto const all = std::exchange(threads_[threadIdx.x].promised, {});
    races::ignore(false);
    for (Copy const& c : all) copy(c);
  }

 private:
  static constexpr unsigned first_warp_barrier = 1000;
  struct Copy {
    void* to;
    void const* from;
    std::size_t bytes;
  };
  // Whole words. Each is one that the sanitizer sees, where it may be told to pass over the C library.
  static void copy(Copy const& c) {
    auto* const to = static_cast<unsigned volatile*>(c.to);
    auto const* const from = static_cast<unsigned const volatile*>(c.from);
    for (std::size_t i = 0; i < c.bytes / sizeof(unsigned); ++i) to[i] = from[i];
  }
  struct Thread {
    std::vector<Copy> promised;
    bool turn = false;
  };
  struct WarpValues {
    unsigned char bytes[2][32][8];
  };
  struct Barrier {
    unsigned number = 0;
    char meetings[2] = {};
    std::vector<unsigned> waiting;
  };

  // Blocks run one after the other, on the same fibers: those begin with bookkeeping.
  static Fiber& fiber(unsigned t) {
    static std::vector<std::unique_ptr<Fiber>> all;
    while (all.size() <= t) all.push_back(std::make_unique<Fiber>(races::another()));
    return *all[t];
  }
  // Bookkeeping at its end goes on at the beginning of the thread in the next block.
  static void enter() {
    Block& block = *running();
    races::leave(&block.begun_);
    races::ignore(false);
    block.kernel_();
    races::ignore(true);
    if (!block.threads_[threadIdx.x].promised.empty()) {
      std::fprintf(stderr, "emulated CUDA: thread %u ends with copies that it has not waited for\n",
                   threadIdx.x);
      std::abort();
    }
    --block.left_;
    races::arrive(&block.ended_);
    block.rest();
  }
  // One of those that no barrier holds, by lot.
  unsigned next() {
    if (ready_.empty()) {
      std::fprintf(stderr, "emulated CUDA: %u threads wait at barriers that not all reach:", left_);
      for (auto const& [id, b] : barriers_)
        if (!b.waiting.empty()) std::fprintf(stderr, " barrier %u: %zu;", id, b.waiting.size());
      std::fprintf(stderr, "\n");
      std::abort();
    }
    advance_lot();
    std::swap(ready_[(state_ >> 8) % ready_.size()], ready_.back());
    unsigned const t = ready_.back();
    ready_.pop_back();
    return t;
  }
  void advance_lot() { state_ = state_ * 1664525u + 1013904223u; }
  bool draws_lot() {
    races::Ignored const bookkeeping;
    advance_lot();
    return (state_ >> 16) % 2 == 0;
  }
  void resume(unsigned t) {
    threadIdx = {t, 0, 0};
    scheduler_.give_way_to(fiber(t));
  }
  // The present thread does, until it is resumed.
  void rest() { fiber(threadIdx.x).give_way_to(scheduler_); }

  std::function<void()> kernel_;
  unsigned state_;
  unsigned left_;
  bool any_ = false;
  Fiber scheduler_{races::present()};
  char begun_ = 0, ended_ = 0;  // what the threads know of the host, and it of them
  std::vector<Thread> threads_;
  std::vector<unsigned> ready_;  // who neither is at work nor waits
  std::map<unsigned, Barrier> barriers_;
  std::map<unsigned, WarpValues> warps_;
};

template <class... Args, std::size_t... i>
void call(void (*kernel)(Args...), void** args, std::index_sequence<i...>) {
  kernel(*static_cast<std::remove_cvref_t<Args>*>(args[i])...);
}

}  // namespace emulated

inline void __syncthreads() { emulated::Block::running()->wait(0, blockDim.x); }
inline int __syncthreads_or(int value) { return emulated::Block::running()->any(value != 0); }
inline void __barrier_sync_count(unsigned id, unsigned count) {
  emulated::Block::running()->wait(id, count);
}
inline void __threadfence_block() {}
inline void __syncwarp(unsigned) { emulated::Block::running()->gather(0); }
inline int __shfl_sync(unsigned, int value, int lane) {
  return emulated::Block::running()->gather(value)(static_cast<unsigned>(lane));
}
template <class T> T __shfl_xor_sync(unsigned, T value, int mask) {
  return emulated::Block::running()->gather(value)(threadIdx.x % 32 ^ static_cast<unsigned>(mask));
}
inline int __shfl_up_sync(unsigned, int value, unsigned delta) {
  unsigned const lane = threadIdx.x % 32;
  return emulated::Block::running()->gather(value)(lane >= delta ? lane - delta : lane);
}
inline unsigned __ballot_sync(unsigned, bool value) {
  auto const all = emulated::Block::running()->gather(value);
  unsigned bits = 0;
  for (unsigned lane = 0; lane < 32; ++lane) bits |= static_cast<unsigned>(all(lane)) << lane;
  return bits;
}
inline int __popc(unsigned bits) { return std::popcount(bits); }
inline int __float_as_int(float a) { return std::bit_cast<int>(a); }
inline float __int_as_float(int a) { return std::bit_cast<float>(a); }
// Saturates, and makes 0 of NaN, as the instruction does.
inline int __float2int_rn(float a) {
  if (!(a == a)) return 0;
  if (a >= 2147483648.0f) return 2147483647;
  if (a <= -2147483648.0f) return -2147483647 - 1;
  return static_cast<int>(std::nearbyintf(a));
}
inline long long __double_as_longlong(double a) { return std::bit_cast<long long>(a); }
inline long long __double2ll_rn(double a) {
  if (!(a == a)) return static_cast<long long>(1ull << 63);
  if (a >= 9223372036854775808.0) return 9223372036854775807;
  if (a <= -9223372036854775808.0) return static_cast<long long>(1ull << 63);
  return static_cast<long long>(std::nearbyint(a));
}

namespace emulated {
// f(value before) is the value after; atomic for the sanitizer's sake, since threads take turns at barriers alone.
template <class T, class F> T change(T* number, F const& f) {
  std::atomic_ref<T> const shared(*number);
  T const before = shared.load(std::memory_order_relaxed);
  shared.store(f(before), std::memory_order_relaxed);
  return before;
}
}  // namespace emulated
template <class T> T atomicAdd(T* to, T value) {
  return emulated::change(to, [=](T a) { return static_cast<T>(a + value); });
}
inline unsigned atomicOr(unsigned* to, unsigned value) {
  return emulated::change(to, [=](unsigned a) { return a | value; });
}
template <class T> T atomicMax(T* to, T value) {
  return emulated::change(to, [=](T a) { return value > a ? value : a; });
}
template <class T> T atomicMin(T* to, T value) {
  return emulated::change(to, [=](T a) { return value < a ? value : a; });
}
inline int atomicCAS(int* to, int expected, int value) {
  return emulated::change(to, [=](int a) { return a == expected ? value : a; });
}

// The run-time, as far as the library uses it.
enum cudaError_t { cudaSuccess, cudaErrorMemoryAllocation, cudaErrorInvalidValue };
enum cudaMemcpyKind { cudaMemcpyHostToDevice, cudaMemcpyDeviceToHost, cudaMemcpyDeviceToDevice };
enum cudaDeviceAttr {
  cudaDevAttrMaxSharedMemoryPerBlockOptin,
  cudaDevAttrMultiProcessorCount
};
enum cudaFuncAttribute { cudaFuncAttributeMaxDynamicSharedMemorySize };
using cudaStream_t = struct EmulatedStream*;

inline char const* cudaGetErrorString(cudaError_t) { return "an emulated error"; }
inline cudaError_t cudaGetLastError() { return cudaSuccess; }
inline cudaError_t cudaGetDeviceCount(int* count) { return *count = emulated::devices, cudaSuccess; }
inline cudaError_t cudaGetDevice(int* device) {
  return *device = emulated::present_device, cudaSuccess;
}
inline cudaError_t cudaSetDevice(int device) {
  return emulated::present_device = device, cudaSuccess;
}
inline cudaError_t cudaStreamSynchronize(cudaStream_t) {
  emulated::waited_for = emulated::present_device;
  return ++emulated::waits, cudaSuccess;
}
inline cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr which, int) {
  *value = which == cudaDevAttrMultiProcessorCount ? emulated::multiprocessors
                                                   : emulated::shared_bytes_per_block;
  return cudaSuccess;
}
inline cudaError_t cudaMemGetInfo(std::size_t* free, std::size_t* all) {
  return *free = *all = emulated::free_bytes, cudaSuccess;
}
// Memory is not zero at first: what is read before it is written shows.
inline cudaError_t cudaMalloc(void** memory, std::size_t bytes) {
  ++emulated::allocations;
  *memory = std::malloc(bytes);
  emulated::taken()[*memory] = bytes;
  std::memset(*memory, 0xcd, bytes);
  return cudaSuccess;
}
inline cudaError_t cudaFree(void* memory) {
  emulated::taken().erase(memory);
  return std::free(memory), cudaSuccess;
}
inline cudaError_t cudaMemcpyAsync(void* to, void const* from, std::size_t bytes, cudaMemcpyKind,
                                   cudaStream_t) {
  return ++emulated::copies, std::memcpy(to, from, bytes), cudaSuccess;
}
inline cudaError_t cudaMemsetAsync(void* to, int value, std::size_t bytes, cudaStream_t) {
  return std::memset(to, value, bytes), cudaSuccess;
}
template <class Kernel>
cudaError_t cudaFuncSetAttribute(Kernel* kernel, cudaFuncAttribute, int bytes) {
  if (bytes > emulated::shared_bytes_per_block) return cudaErrorInvalidValue;
  emulated::granted()[reinterpret_cast<void*>(kernel)] = static_cast<std::size_t>(bytes);
  return cudaSuccess;
}
template <class... Args>
cudaError_t cudaLaunchKernel(void (*kernel)(Args...), dim3 grid, dim3 block, void** args,
                             std::size_t shared_bytes, cudaStream_t) {
  if (shared_bytes > emulated::most_shared_bytes(reinterpret_cast<void*>(kernel)))
    return cudaErrorInvalidValue;
  if (++emulated::launches == emulated::refused_launch) return cudaErrorInvalidValue;
  gridDim = grid;
  blockDim = block;
  for (unsigned b = 0; b < grid.x; ++b) {
    blockIdx = {b, 0, 0};
    if (shared_bytes > 0)
      std::memset(mpmpbd::cuda::dynamic_shared_memory, 0xcd,
                  sizeof mpmpbd::cuda::dynamic_shared_memory);
    emulated::Block(block.x, [&] {
      emulated::call(kernel, args, std::index_sequence_for<Args...>{});
    }).run();
  }
  return cudaSuccess;
}
