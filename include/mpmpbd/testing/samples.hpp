// Random rotations and deformations for law suites: the same numbers on every machine.
#pragma once

#include <cstdint>

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd::testing {

// xorshift64*: the distributions of the standard library differ between implementations.
class Samples {
 public:
  explicit Samples(std::uint64_t seed) : state_(seed * 2654435769u + 88172645463325252u) {}

  double uniform(double low, double high) {
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    auto const bits = (state_ * 2685821657736338717u) >> 11;
    return low + (high - low) * double(bits) * 0x1p-53;
  }
  double log_uniform(double low, double high) {
    return mpmpbd::exp(uniform(mpmpbd::log(low), mpmpbd::log(high)));
  }
  template <int R, int C = 1> Mat<double, R, C> matrix(double low, double high) {
    Mat<double, R, C> a{};
    for (int i = 0; i < R * C; ++i) a.m[i] = uniform(low, high);
    return a;
  }
  Vec3<double> unit_vector() {
    for (;;) {
      auto const v = matrix<3>(-1.0, 1.0);
      double const d = dot(v, v);
      if (d > 0.01 && d < 1.0) return direction(v);
    }
  }
  Mat3<double> rotation() { return rotation_by(unit_vector(), uniform(-pi<double>, pi<double>)); }

  // By Rodrigues' formula; axis a unit vector, angle in rad.
  static Mat3<double> rotation_by(Vec3<double> const& axis, double angle) {
    auto const K = skew(axis);
    return Mat3<double>::identity() + mpmpbd::sin(angle) * K + (1.0 - mpmpbd::cos(angle)) * (K * K);
  }
  static Mat3<double> diagonal(double a, double b, double c) {
    return {{a, 0, 0, 0, b, 0, 0, 0, c}};
  }
  // Random stretches between random rotations; det F > 0.
  Mat3<double> deformation(double least, double most) {
    auto const D =
        diagonal(log_uniform(least, most), log_uniform(least, most), log_uniform(least, most));
    return rotation() * D * rotation();
  }

 private:
  std::uint64_t state_;
};

}  // namespace mpmpbd::testing
