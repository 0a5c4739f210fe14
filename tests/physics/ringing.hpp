// A damped mode heard at equal intervals: how far it turns and how much of it is left each time.
#pragma once

#include <cmath>

namespace rods {

// Least squares fit of the recurrence x[n+1] = 2 r cos(phi) x[n] - r^2 x[n-1], sample by sample.
class Ringing {
 public:
  void add(double x) {
    if (samples_ >= 2) {
      aa_ += now_ * now_, ab_ += now_ * before_, bb_ += before_ * before_;
      xa_ += x * now_, xb_ += x * before_;
    }
    before_ = now_;
    now_ = x;
    ++samples_;
  }
  double decay() const { return std::sqrt(-second()); }               // r
  double turn() const { return std::acos(first() / (2 * decay())); }  // phi [rad]

 private:
  double first() const { return (xa_ * bb_ - xb_ * ab_) / (aa_ * bb_ - ab_ * ab_); }
  double second() const { return (xb_ * aa_ - xa_ * ab_) / (aa_ * bb_ - ab_ * ab_); }

  double before_ = 0, now_ = 0, aa_ = 0, ab_ = 0, bb_ = 0, xa_ = 0, xb_ = 0;
  int samples_ = 0;
};

}  // namespace rods
