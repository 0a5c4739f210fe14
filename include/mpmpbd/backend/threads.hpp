// The threads back end (OpenMP): the same stages, the same fixed pieces of work, the same bits.
//
// Work is cut into pieces that do not depend on the number of threads, and every sum is taken over
// pieces in their order; so a thread count changes who computes a number, never the number.
#pragma once

#include <cstdint>
#include <exception>

#if defined(_OPENMP)
#include <omp.h>
#endif

#include <mpmpbd/core/fixed_string.hpp>
#include <mpmpbd/core/wide.hpp>

namespace mpmpbd {

struct Threads {
  static constexpr FixedString name = "threads";
  static constexpr int grids = 1;  // of an environment, kept at a time

  int count = 0;  // 0: as many as the machine offers
  Kernels kernels = Kernels::widest;

  int lanes() const {
#if defined(_OPENMP)
    return count > 0 ? count : omp_get_max_threads();
#else
    return 1;
#endif
  }

  template <class Function> void for_each(std::int64_t n, Function&& f) const {
#if defined(_OPENMP)
    int const threads = n < lanes() ? static_cast<int>(n) : lanes();
    if (threads > 1) {
      std::exception_ptr
          thrown;  // must not leave the parallel region; one of them goes on from here
#pragma omp parallel for schedule(static) num_threads(threads)
      for (std::int64_t i = 0; i < n; ++i) {
        try {
          f(i, omp_get_thread_num());
        } catch (...) {
#pragma omp critical(mpmpbd_thrown)
          thrown = std::current_exception();
        }
      }
      if (thrown) std::rethrow_exception(thrown);
      return;
    }
#endif
    for (std::int64_t i = 0; i < n; ++i) f(i, 0);
  }
};

}  // namespace mpmpbd
