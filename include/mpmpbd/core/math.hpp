// Scalar functions for host and device, overloaded on float and double.
//
// The std:: functions are not used in code that a kernel may see: with nvcc 13 some of them compile
// to an empty kernel without a diagnostic.
#pragma once

// What is not finite is found by a - a == 0, and the order of sums decides bits: fast-math breaks both silently.
#if defined(__FAST_MATH__) || defined(__USE_FAST_MATH__)
#error "mpmpbd does not support -ffast-math (or --use_fast_math): compile without it"
#endif

#include <math.h>

#include <bit>
#include <concepts>

#include <mpmpbd/core/config.hpp>

namespace mpmpbd {

template <class T> concept Real = std::same_as<T, float> || std::same_as<T, double>;

// Templates, so that after `using namespace mpmpbd` the C library's own functions stay preferred.
template <Real T> MPMPBD_HD T sqrt(T a) {
  if constexpr (sizeof(T) == sizeof(float))
    return ::sqrtf(a);
  else
    return ::sqrt(a);
}
template <Real T> MPMPBD_HD T exp(T a) {
  if constexpr (sizeof(T) == sizeof(float))
    return ::expf(a);
  else
    return ::exp(a);
}
template <Real T> MPMPBD_HD T expm1(T a) {
  if constexpr (sizeof(T) == sizeof(float))
    return ::expm1f(a);
  else
    return ::expm1(a);
}
template <Real T> MPMPBD_HD T log(T a) {
  if constexpr (sizeof(T) == sizeof(float))
    return ::logf(a);
  else
    return ::log(a);
}
template <Real T> MPMPBD_HD T floor(T a) {
  if constexpr (sizeof(T) == sizeof(float))
    return ::floorf(a);
  else
    return ::floor(a);
}
template <Real T> MPMPBD_HD T ceil(T a) {
  if constexpr (sizeof(T) == sizeof(float))
    return ::ceilf(a);
  else
    return ::ceil(a);
}
template <Real T> MPMPBD_HD T sin(T a) {
  if constexpr (sizeof(T) == sizeof(float))
    return ::sinf(a);
  else
    return ::sin(a);
}
template <Real T> MPMPBD_HD T cos(T a) {
  if constexpr (sizeof(T) == sizeof(float))
    return ::cosf(a);
  else
    return ::cos(a);
}
template <Real T> MPMPBD_HD T abs(T a) {
  if constexpr (sizeof(T) == sizeof(float))
    return ::fabsf(a);
  else
    return ::fabs(a);
}
template <Real T> MPMPBD_HD T pow(T a, T b) {
  if constexpr (sizeof(T) == sizeof(float))
    return ::powf(a, b);
  else
    return ::pow(a, b);
}
template <Real T> MPMPBD_HD T atan2(T y, T x) {
  if constexpr (sizeof(T) == sizeof(float))
    return ::atan2f(y, x);
  else
    return ::atan2(y, x);
}
// 1 / a to an ulp. On a device without the branches of a division: of a float below 2^-126 or above 2^126 it is not finite
// or 0, and NaN for 0 and infinity.
template <Real T> MPMPBD_HD T reciprocal(T a) {
#if defined(__CUDA_ARCH__)
  if constexpr (sizeof(T) == sizeof(float)) {
    float near;
    asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(near) : "f"(a));
    return ::fmaf(near, ::fmaf(-a, near, 1.0f), near);
  }
#endif
  return T(1) / a;
}
// a b + c. A device rounds it once, and nothing else: its compiler, left to join products with sums as it likes, decides by
// what is around, and one text gets other bits in another kernel (decision 32). In constant expressions, and of numbers that
// are neither float nor double, it is the host's.
template <class T> MPMPBD_HD constexpr T multiply_add(T a, T b, T c) {
#if defined(__CUDA_ARCH__)
  if constexpr (Real<T>)
    if (!__builtin_is_constant_evaluated()) return ::fma(a, b, c);
#endif
  return a * b + c;
}
template <Real T> MPMPBD_HD bool is_finite(T a) { return a - a == T(0); }

template <class T> MPMPBD_HD constexpr T min(T a, T b) { return b < a ? b : a; }
template <class T> MPMPBD_HD constexpr T max(T a, T b) { return a < b ? b : a; }
template <class T> MPMPBD_HD constexpr T clamp(T a, T low, T high) {
  return min(max(a, low), high);
}
template <class T> MPMPBD_HD constexpr T square(T a) { return a * a; }
MPMPBD_HD inline int count_ones(unsigned bits) {
#if defined(__CUDA_ARCH__)
  return __popc(bits);
#else
  return std::popcount(bits);
#endif
}

// Machine precision: the distance from 1 to the next number.
template <class T> inline constexpr T epsilon = T(0);
template <> inline constexpr float epsilon<float> = 1.1920929e-07f;
template <> inline constexpr double epsilon<double> = 2.220446049250313e-16;

template <class T> inline constexpr T infinity = static_cast<T>(__builtin_huge_val());

// Four times the smallest normal number: everything from here on has a finite inverse.
template <class T> inline constexpr T least_invertible = T(0);
template <> inline constexpr float least_invertible<float> = 0x1p-124f;
template <> inline constexpr double least_invertible<double> = 0x1p-1020;

template <class T> inline constexpr T pi = T(3.141592653589793238462643383279502884L);

}  // namespace mpmpbd
