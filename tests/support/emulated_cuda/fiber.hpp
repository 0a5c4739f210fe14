// What one thread of the host carries out in turn: itself, and functions that each have a stack of their own.
//
// The C library begins such a function (setcontext); from then on it is left and entered by jumps. Its swapcontext would ask the
// system for the mask of signals at each change, and under the address sanitizer wipe a whole stack. The jumps are the compiler's:
// at those of the library, the same sanitizer takes what other functions have on their stacks for gone.
#pragma once

#include <ucontext.h>

#include <cstddef>
#include <memory>
#include <utility>

#include "races.hpp"
#if __has_include(<sanitizer/asan_interface.h>)
#include <sanitizer/asan_interface.h>
#else
#define ASAN_UNPOISON_MEMORY_REGION(address, bytes)
#endif

namespace emulated {

class Fiber {
 public:
  // To the thread sanitizer this fiber is `known_as`.
  explicit Fiber(races::Fiber known_as) : known_as_(known_as) {}

  // `function` is called when this fiber is next resumed, and never returns.
  void begin(void (*function)()) {
    if (!stack_) stack_ = std::make_unique_for_overwrite<char[]>(stack_bytes);
    ASAN_UNPOISON_MEMORY_REGION(stack_.get(), stack_bytes);  // left by a function that went before
    getcontext(&beginning_);
    beginning_.uc_stack.ss_sp = stack_.get();
    beginning_.uc_stack.ss_size = stack_bytes;
    makecontext(&beginning_, function, 0);
    begins_ = true;
  }
  // This one, which is at work, rests until another one gives way to it.
  __attribute__((noinline, no_sanitize("address"))) void give_way_to(Fiber& next) {
    if (__builtin_setjmp(here_) != 0) return;
    races::change_to(next.known_as_);
    if (std::exchange(next.begins_, false)) setcontext(&next.beginning_);
    __builtin_longjmp(next.here_, 1);
  }

 private:
  static constexpr std::size_t stack_bytes = std::size_t{1} << 18;
  std::unique_ptr<char[]> stack_;
  ucontext_t beginning_;
  void* here_[5];
  bool begins_ = false;
  races::Fiber known_as_;
};

}  // namespace emulated
