// The largest of several errors. A NaN is the largest of all and stays.
#pragma once

namespace mpmpbd::testing {

class Worst {
 public:
  void include(double error) {
    if (worst_ == worst_ && !(error <= worst_)) worst_ = error;
  }
  double value() const { return worst_; }

 private:
  double worst_ = 0.0;
};

// Rounding of one transfer: sums of up to 64 products of three weights, each right to a few units.
// Relative to the scale that each law names.
template <class T> inline constexpr double rounding_limit = sizeof(T) == 8 ? 1e-12 : 5e-6;

}  // namespace mpmpbd::testing
