// Scalar functions for host and device, overloaded on float and double.
//
// The std:: functions are not used in code that a kernel may see: with nvcc 13 some of them compile
// to an empty kernel without a diagnostic.
#pragma once

#include <math.h>

#include <mpmpbd/core/config.hpp>

namespace mpmpbd {

MPMPBD_HD inline float sqrt(float a) { return ::sqrtf(a); }
MPMPBD_HD inline double sqrt(double a) { return ::sqrt(a); }
MPMPBD_HD inline float exp(float a) { return ::expf(a); }
MPMPBD_HD inline double exp(double a) { return ::exp(a); }
MPMPBD_HD inline float expm1(float a) { return ::expm1f(a); }
MPMPBD_HD inline double expm1(double a) { return ::expm1(a); }
MPMPBD_HD inline float log(float a) { return ::logf(a); }
MPMPBD_HD inline double log(double a) { return ::log(a); }
MPMPBD_HD inline float pow(float a, float b) { return ::powf(a, b); }
MPMPBD_HD inline double pow(double a, double b) { return ::pow(a, b); }
MPMPBD_HD inline float floor(float a) { return ::floorf(a); }
MPMPBD_HD inline double floor(double a) { return ::floor(a); }
MPMPBD_HD inline float ceil(float a) { return ::ceilf(a); }
MPMPBD_HD inline double ceil(double a) { return ::ceil(a); }
MPMPBD_HD inline float sin(float a) { return ::sinf(a); }
MPMPBD_HD inline double sin(double a) { return ::sin(a); }
MPMPBD_HD inline float cos(float a) { return ::cosf(a); }
MPMPBD_HD inline double cos(double a) { return ::cos(a); }
MPMPBD_HD inline float atan2(float y, float x) { return ::atan2f(y, x); }
MPMPBD_HD inline double atan2(double y, double x) { return ::atan2(y, x); }
MPMPBD_HD inline float abs(float a) { return ::fabsf(a); }
MPMPBD_HD inline double abs(double a) { return ::fabs(a); }
MPMPBD_HD inline bool is_finite(float a) { return a - a == 0.0f; }
MPMPBD_HD inline bool is_finite(double a) { return a - a == 0.0; }

template <class T> MPMPBD_HD constexpr T min(T a, T b) { return b < a ? b : a; }
template <class T> MPMPBD_HD constexpr T max(T a, T b) { return a < b ? b : a; }
template <class T> MPMPBD_HD constexpr T clamp(T a, T low, T high) {
  return min(max(a, low), high);
}
template <class T> MPMPBD_HD constexpr T square(T a) { return a * a; }

// Machine precision: the distance from 1 to the next number.
template <class T> inline constexpr T epsilon = T(0);
template <> inline constexpr float epsilon<float> = 1.1920929e-07f;
template <> inline constexpr double epsilon<double> = 2.220446049250313e-16;

template <class T> inline constexpr T pi = T(3.141592653589793238462643383279502884L);

}  // namespace mpmpbd
