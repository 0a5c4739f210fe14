// Tensor-product B-splines on the grid, from their 1-D values.
//
// Steffen, Kirby, Berzins 2008 (analysis of the kernels); Jiang et al. 2016 (D = dx^2/4 and dx^2/3).
// All arguments are in cells: f is the distance of the particle from the first of its nodes, so node i
// is at i - f. slope = dw/dx * dx; moment = D^-1 w (x_i - x_p) * dx.
#pragma once

#include <mpmpbd/mpm/concepts.hpp>

namespace mpmpbd {

// Limits: its slope jumps at the nodes (grid crossing error, no convergence under refinement) and its
// inertia D depends on the position, so it does not compose with MLS forces.
struct LinearBSpline {
  using Role = role::Shape;
  static constexpr FixedString name = "linear B-spline";
  static constexpr bool branch_free = true;
  static constexpr int width = 2;
  static constexpr double offset = 0.0;
  static constexpr double inverse_inertia = 0.0;

  template <class T> MPMPBD_HD static constexpr T weight(int i, T f) { return i == 0 ? 1 - f : f; }
  template <class T> MPMPBD_HD static constexpr T slope(int i, T) { return i == 0 ? T(-1) : T(1); }
  // With D = f (1 - f) dx^2 per axis, D^-1 w d is the slope itself.
  template <class T> MPMPBD_HD static constexpr T moment(int i, T f) { return slope(i, f); }
};

struct QuadraticBSpline {
  using Role = role::Shape;
  static constexpr FixedString name = "quadratic B-spline";
  static constexpr bool branch_free = true;
  static constexpr int width = 3;
  static constexpr double offset = 0.5;
  static constexpr double inverse_inertia = 4.0;

  template <class T> MPMPBD_HD static constexpr T weight(int i, T f) {
    return i == 0   ? T(0.5) * (T(1.5) - f) * (T(1.5) - f)
           : i == 1 ? multiply_add(T(1) - f, f - T(1), T(0.75))
                    : T(0.5) * (f - T(0.5)) * (f - T(0.5));
  }
  template <class T> MPMPBD_HD static constexpr T slope(int i, T f) {
    return i == 0 ? f - T(1.5) : i == 1 ? 2 - 2 * f : f - T(0.5);
  }
  template <class T> MPMPBD_HD static constexpr T moment(int i, T f) {
    return T(inverse_inertia) * weight(i, f) * (T(i) - f);
  }
};

struct CubicBSpline {
  using Role = role::Shape;
  static constexpr FixedString name = "cubic B-spline";
  static constexpr bool branch_free = true;
  static constexpr int width = 4;
  static constexpr double offset = 1.0;
  static constexpr double inverse_inertia = 3.0;

  template <class T> MPMPBD_HD static constexpr T weight(int i, T f) {
    T const r = i < 2 ? f - T(i) : T(i) - f;  // distance in cells, in [0, 2]
    return i == 1 || i == 2 ? multiply_add(multiply_add(T(0.5), r, T(-1)) * r, r, T(2) / 3)
                            : (2 - r) * (2 - r) * (2 - r) / 6;
  }
  // dw/dx at the particle; x_p - x_i > 0 for the first two nodes.
  template <class T> MPMPBD_HD static constexpr T slope(int i, T f) {
    T const side = i < 2 ? T(1) : T(-1);
    T const r = side * (f - T(i));
    return side * (i == 1 || i == 2 ? (T(1.5) * r - 2) * r : T(-0.5) * (2 - r) * (2 - r));
  }
  template <class T> MPMPBD_HD static constexpr T moment(int i, T f) {
    return T(inverse_inertia) * weight(i, f) * (T(i) - f);
  }
};

}  // namespace mpmpbd
