// Whether a sanitizer is at work. It looks for errors of memory and of threads, not of numbers: what only repeats
// itself may then do so less often.
#pragma once

#include <tuple>
#include <type_traits>

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define MPMPBD_SANITIZED
#endif
#if __has_feature(thread_sanitizer)
#define MPMPBD_THREADS_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MPMPBD_SANITIZED
#endif

namespace test {
#if defined(MPMPBD_SANITIZED)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

// How often this run repeats what is repeated `count` times without a sanitizer.
constexpr int repeats(int count) { return sanitized ? (count + 9) / 10 : count; }

// Types for TEMPLATE_LIST_TEST_CASE: a sanitizer sees the first alone.
template <class First, class... Others>
using kinds = std::conditional_t<sanitized, std::tuple<First>, std::tuple<First, Others...>>;
}  // namespace test
