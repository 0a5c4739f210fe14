// Wide vectors: kernels of eight floats an instruction, chosen at run time; no flag is asked of users.
//
// x86-64 alone promises four. What needs eight (AVX2) is compiled for AVX2 by attributes and called only
// where the machine has it. Elsewhere (other processors, -mavx2) a pack is what the compiler makes of it.
//
// MPMPBD_WIDE_KERNEL stands before a function with a loop over packs, MPMPBD_WIDE before every function
// that computes with one: g++ splits a vector that its function's target does not have before it inlines
// the function, so inlining them into a kernel would come too late. Templates between the two, policies
// first of all, need nothing: flatten inlines them.
#pragma once

#include <mpmpbd/core/config.hpp>

#if defined(__GNUC__) && !defined(__CUDACC__) && !defined(MPMPBD_SCALAR_ONLY)
#define MPMPBD_HAS_PACKS 1
#if defined(__x86_64__) && !defined(__AVX2__)
#define MPMPBD_CHOOSES_AVX2 1
#endif
#endif

#if defined(MPMPBD_CHOOSES_AVX2) && defined(__clang__)
#define MPMPBD_WIDE MPMPBD_INLINE
#define MPMPBD_WIDE_KERNEL __attribute__((target("avx2"), flatten, noinline))
#elif defined(MPMPBD_CHOOSES_AVX2)
#define MPMPBD_WIDE inline __attribute__((target("avx2")))
// A clone of a kernel would be made before it is flattened.
#define MPMPBD_WIDE_KERNEL __attribute__((target("avx2"), flatten, noinline, noclone))
#else
#define MPMPBD_WIDE MPMPBD_INLINE
#define MPMPBD_WIDE_KERNEL
#endif

namespace mpmpbd {

// Which kernels a host back end runs. Both give the same bits.
enum class Kernels {
  widest,  // the widest vectors that the machine has
  plain    // one particle at a time: the reference
};

// Whether this machine runs kernels on packs.
inline bool has_wide_vectors() {
#if defined(MPMPBD_CHOOSES_AVX2)
  return __builtin_cpu_supports("avx2");
#elif defined(MPMPBD_HAS_PACKS)
  return true;
#else
  return false;
#endif
}

}  // namespace mpmpbd
