// Counts what a program allocates. It replaces operator new, so one source of a program includes it. Under the thread
// sanitizer, whose own operator new cannot be replaced, nothing is counted.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>

#include "support/sanitized.hpp"

namespace test {
inline std::atomic<std::int64_t> allocations{0};
#if defined(MPMPBD_THREADS_SANITIZED)
inline constexpr bool counts_allocations = false;
#else
inline constexpr bool counts_allocations = true;
#endif
}  // namespace test

#if !defined(MPMPBD_THREADS_SANITIZED)
// Not inlined: the compiler would see malloc in one and delete in the other and warn.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++test::allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
// A sanitizer brings its own of every form that is not replaced, which does not go with this delete.
[[gnu::noinline]] void* operator new(std::size_t size, std::nothrow_t const&) noexcept {
  ++test::allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  ++test::allocations;
  auto const a = static_cast<std::size_t>(alignment);
  if (void* p = std::aligned_alloc(a, (size + a - 1) / a * a)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::nothrow_t const&) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
#endif
