// The stable time step of explicit MPM, from the current state.
//
// A single particle is an oscillator: with L the velocity gradient, dL/dt = -(V0/m) G dtau, where G is
// D^-1 (MLS) or the largest sum (dw/dx)^2 / w over positions (weight gradient). Symplectic Euler is
// stable for dt < 2/omega, omega^2 = G k / rho0, k the largest eigenvalue of dtau/dL: stricter than
// dx/c_p by 0.65 at nu = 0.4.
#pragma once

#include <mpmpbd/core/tick.hpp>
#include <mpmpbd/mpm/body.hpp>
#include <mpmpbd/mpm/lattice.hpp>

namespace mpmpbd {

// Share of the limit that is taken, for what the estimate does not see within a step.
inline constexpr double time_step_safety = 0.8;

// G dx^2 of a shape function and force form: how stiffly a single particle feels the grid.
// Linear shape: unbounded at a node (sum 1/f); the value is that of a particle 1/20 cell from a node,
// so a lone particle nearer than that is not covered.
template <class Shape, class Form> constexpr double gradient_stiffness() {
  if (Form::uses_moment) return Shape::inverse_inertia;
  double largest = 0.0;
  for (int n = 1; n < 40; ++n) {
    double const f = Shape::offset + n / 40.0;
    double sum = 0.0;
    for (int i = 0; i < Shape::width; ++i) {
      double const w = Shape::weight(i, f), s = Shape::slope(i, f);
      if (w > 0.0) sum += s * s / w;
    }
    if (sum > largest && (Shape::inverse_inertia > 0.0 || (n >= 2 && n <= 38))) largest = sum;
  }
  if constexpr (Shape::inverse_inertia > 0.0) {
    for (double const end : {1e-9, 1.0 - 1e-9}) {  // the supremum of the splines lies at the ends
      double sum = 0.0;
      for (int i = 0; i < Shape::width; ++i) {
        double const f = Shape::offset + end;
        double const w = Shape::weight(i, f), s = Shape::slope(i, f);
        if (w > 1e-30) sum += s * s / w;
      }
      if (sum > largest) largest = sum;
    }
  }
  return largest;
}

namespace detail {
// A constant, because device code may not call a constexpr host function.
template <class Shape, class Form>
inline constexpr double gradient_stiffness_of = gradient_stiffness<Shape, Form>();
}  // namespace detail

// What bounds the step of one environment; maxima over its particles.
template <class T> struct StepBounds {
  T frequency2 = T(0);  // k / rho0 [m^2/s^2]
  T speed = T(0);       // |v| [m/s]
  T rate = T(0);        // |C| [1/s]

  MPMPBD_HD void include(StepBounds const& b) {
    frequency2 = max(frequency2, b.frequency2);
    speed = max(speed, b.speed);
    rate = max(rate, b.rate);
  }
};

// One particle's contribution.
template <class Body, class P, class K>
MPMPBD_HD StepBounds<typename P::Scalar> step_bounds(P const& p, K const& material) {
  using T = typename P::Scalar;
  auto const k = Body::Material::stiffness(p, material);
  StepBounds<T> b;
  b.frequency2 = max(k.longitudinal, k.bulk3) * p[particle::Volume{}] / p[particle::Mass{}];
  b.speed = norm(p[particle::Velocity{}]);
  if constexpr (Body::Transfer::carries_affine) b.rate = norm(p[particle::Affine{}]);
  return b;
}

// The longest stable step [s] of elastic waves, without the safety factor.
template <class Body, class T> MPMPBD_HD T elastic_limit(StepBounds<T> const& b, T dx) {
  constexpr double G =
      detail::gradient_stiffness_of<typename Body::Shape, typename Body::Form>;
  return b.frequency2 > T(0) ? T(2) * dx / sqrt(T(G) * b.frequency2) : T(1e30);
}

// The recommended longest step [s]: elastic waves, half a cell of motion, half a unit of strain.
template <class Body, class T> MPMPBD_HD T suggest_dt(StepBounds<T> const& b, T dx) {
  T limit = elastic_limit<Body>(b, dx);
  if (b.speed > T(0)) limit = min(limit, T(0.5) * dx / b.speed);
  if (b.rate > T(0)) limit = min(limit, T(0.5) / b.rate);
  return T(time_step_safety) * limit;
}

}  // namespace mpmpbd
