// What the compiler is told before anything else: where a function may run.
#pragma once

#if defined(__CUDACC__)
#define MPMPBD_HD __host__ __device__
#else
#define MPMPBD_HD
#endif

// Functions of the particle loops have to be inlined whatever their size: a call per node costs more
// than the node itself.
#if defined(__CUDACC__)
#define MPMPBD_INLINE __host__ __device__ __forceinline__
#elif defined(__GNUC__)
#define MPMPBD_INLINE inline __attribute__((always_inline))
#else
#define MPMPBD_INLINE inline
#endif
// A long function that a kernel calls and does not inline. Left to itself, nvcc decides by the lengths of all functions
// around it, and a few instructions in one of them move the cut (decision 32).
#if defined(__CUDACC__)
#define MPMPBD_APART __host__ __device__ __noinline__
#else
#define MPMPBD_APART
#endif
// MPMPBD_INLINE as a plain attribute, for lambdas (after the parameter list) and host functions.
#if defined(__GNUC__)
#define MPMPBD_ALWAYS_INLINE __attribute__((always_inline))
#else
#define MPMPBD_ALWAYS_INLINE
#endif

// Before a short loop of constant length, so that its arrays lie in registers.
#if defined(__CUDA_ARCH__) || (defined(__clang__) && !defined(__CUDACC__))
#define MPMPBD_UNROLL _Pragma("unroll")
#elif defined(__GNUC__) && !defined(__CUDACC__)
#define MPMPBD_UNROLL _Pragma("GCC unroll 16")
#else
#define MPMPBD_UNROLL
#endif

// Before a loop of which a device is to have no copies: a coupling waits for its code, and the longer that is the longer.
#if defined(__CUDA_ARCH__)
#define MPMPBD_NO_UNROLL _Pragma("unroll 1")
#else
#define MPMPBD_NO_UNROLL
#endif
