// Tells the thread sanitizer that the threads of an emulated block are threads, though one thread of the host carries them
// out. It then sees races between two barriers, in shared memory and in that of the device.
//
// Without the sanitizer nothing here does anything.
#pragma once

#if defined(__SANITIZE_THREAD__)
#define EMULATED_RACES 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define EMULATED_RACES 1
#endif
#endif

#ifdef EMULATED_RACES
#include <sanitizer/tsan_interface.h>
extern "C" {
void AnnotateIgnoreReadsBegin(char const* file, int line);
void AnnotateIgnoreReadsEnd(char const* file, int line);
void AnnotateIgnoreWritesBegin(char const* file, int line);
void AnnotateIgnoreWritesEnd(char const* file, int line);
}
#endif

namespace emulated::races {

#ifdef EMULATED_RACES
inline constexpr bool sought = true;
using Fiber = void*;
inline Fiber present() { return __tsan_get_current_fiber(); }
// Right before the change itself. Who is left and who goes on know nothing of each other by it.
inline void change_to(Fiber fiber) {
  __tsan_switch_to_fiber(fiber, __tsan_switch_to_fiber_no_sync);
}
// What comes before `arrive` at a place is known to who leaves it later.
inline void arrive(void* place) { __tsan_release(place); }
inline void leave(void* place) { __tsan_acquire(place); }
inline void ignore(bool from_now_on) {
  (from_now_on ? AnnotateIgnoreReadsBegin : AnnotateIgnoreReadsEnd)(__FILE__, __LINE__);
  (from_now_on ? AnnotateIgnoreWritesBegin : AnnotateIgnoreWritesEnd)(__FILE__, __LINE__);
}
// Another one, which ignores what it does.
inline Fiber another() {
  Fiber const host = present(), fiber = __tsan_create_fiber(0);
  __tsan_switch_to_fiber(fiber, 0);
  ignore(true);
  __tsan_switch_to_fiber(host, 0);
  return fiber;
}
#else
inline constexpr bool sought = false;
using Fiber = void*;
inline Fiber present() { return nullptr; }
inline Fiber another() { return nullptr; }
inline void change_to(Fiber) {}
inline void arrive(void*) {}
inline void leave(void*) {}
inline void ignore(bool) {}
#endif

// The emulator's own bookkeeping, which all fibers share.
struct Ignored {
  Ignored() { ignore(true); }
  ~Ignored() { ignore(false); }
  Ignored(Ignored const&) = delete;
  Ignored& operator=(Ignored const&) = delete;
};

}  // namespace emulated::races
