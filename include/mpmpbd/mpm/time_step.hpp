// The stable time step of explicit MPM, from the current state.
//
// A single particle is an oscillator of its strain e and the rate C that it carries:
//   C' = C - dt a_C w2 e,   e' = e + dt (C - dt a_F w2 e),   w2 = k / (rho0 dx^2),
// k the largest eigenvalue of dtau/dL; a_F dx^-2: how the forces change the gradient that updates F, a_C:
// the one that is carried (0 for PIC and FLIP). Its determinant is 1 - dt^2 w2 (a_F - a_C), its trace
// 2 - dt^2 w2 a_F, so it is stable for dt^2 w2 (2 a_F - a_C) < 4. By Irons and Fried no assembly of
// particles is stiffer than its stiffest one. 0.65 of dx/c_p for MLS-APIC at nu = 0.4.
#pragma once

#include <mpmpbd/core/status.hpp>
#include <mpmpbd/core/tick.hpp>
#include <mpmpbd/mpm/body.hpp>
#include <mpmpbd/mpm/lattice.hpp>

namespace mpmpbd {

// Share of the limit that is taken, for what the estimate does not see within a step.
inline constexpr double time_step_safety = 0.8;

namespace detail {
// sum (dw/df)^2 / w at f cells from the first node: the weight gradient's stiffness.
template <class Shape> constexpr double slope_stiffness(double f) {
  double sum = 0.0;
  for (int i = 0; i < Shape::width; ++i) {
    double const w = Shape::weight(i, f), s = Shape::slope(i, f);
    if (w > 1e-30) sum += s * s / w;
  }
  return sum;
}

// 2 a_F - a_C at f, of a shape with constant inertia.
template <class Body> constexpr double stiffness_at(double f) {
  using Shape = typename Body::Shape;
  using Transfer = typename Body::Transfer;
  double const slope = slope_stiffness<Shape>(f);
  double const moment = Shape::inverse_inertia;
  double const updates = Body::Form::uses_moment ? moment : slope;
  double const carried = !Transfer::carries_affine ? 0.0
                         : Transfer::needs_moment  ? moment
                                                   : updates;
  return 2.0 * updates - carried;
}
}  // namespace detail

// Whether how stiffly a particle feels the grid has a bound over the cell. That of a linear shape (sum 1/f) has none,
// so it is taken where the particles are: NodeShares.
template <class Body>
inline constexpr bool has_bounded_stiffness = Body::Shape::inverse_inertia > 0.0;

// How stiffly a single particle feels the grid, times dx^2: the largest 2 a_F - a_C of any position. Linear shape:
// (2 a_F - a_C) / a_F, what NodeShares is to be multiplied by.
template <class Body> constexpr double gradient_stiffness() {
  using Shape = typename Body::Shape;
  if constexpr (!has_bounded_stiffness<Body>) return Body::Transfer::carries_affine ? 1.0 : 2.0;
  double largest = 0.0;
  for (int n = 2; n <= 38; ++n)
    largest = max(largest, detail::stiffness_at<Body>(Shape::offset + n / 40.0));
  for (double const end : {1e-9, 1.0 - 1e-9})  // the supremum of the splines lies at the ends
    largest = max(largest, detail::stiffness_at<Body>(Shape::offset + end));
  return largest;
}

namespace detail {
// A constant, because device code may not call a constexpr host function.
template <class Body> inline constexpr double gradient_stiffness_of = gradient_stiffness<Body>();
}  // namespace detail

// What bounds the step of one environment; maxima over its particles, and over the needle as to speed.
template <class T> struct StepBounds {
  T frequency2 = T(0);  // k / rho0 [m^2/s^2]; linear shape: times the stiffness of NodeShares
  T damping = T(0);     // largest eigenvalue of dtau/d(dF/dt) / rho0 [m^2/s]; the same
  T speed2 = T(0);      // |v|^2 [m^2/s^2]
  T rate2 = T(0);       // |C|^2 [1/s^2]

  MPMPBD_HD void include(StepBounds const& b) {
    frequency2 = max(frequency2, b.frequency2);
    damping = max(damping, b.damping);
    speed2 = max(speed2, b.speed2);
    rate2 = max(rate2, b.rate2);
  }
};

// One particle's contribution.
template <class Body, class P, class K>
MPMPBD_HD StepBounds<typename P::Scalar> step_bounds(P const& p, K const& material) {
  using T = typename P::Scalar;
  auto const k = Body::Material::stiffness(p, material);
  StepBounds<T> b;
  b.frequency2 = max(k.longitudinal, k.bulk3) * (p[particle::Volume{}] / p[particle::Mass{}]);
  b.speed2 = dot(p[particle::Velocity{}], p[particle::Velocity{}]);
  if constexpr (Body::Transfer::carries_affine)
    b.rate2 = dot(p[particle::Affine{}], p[particle::Affine{}]);
  return b;
}

// The longest stable step [s] of damped elastic waves, without the safety factor: with omega^2 = G k / rho0
// and b = G c / (2 rho0) it is 2 / (b + sqrt(omega^2 + b^2)).
template <class Body, class T> MPMPBD_HD T elastic_limit(StepBounds<T> const& b, T dx) {
  T const G = T(detail::gradient_stiffness_of<Body>) / (dx * dx);
  T const half = G * b.damping / 2;
  T const rate = half + sqrt(multiply_add(half, half, G * b.frequency2));
  return rate > T(0) ? T(2) / rate : T(1e30);
}

// A longest step [s] and what sets it.
template <class T> struct StepLimit {
  T dt = T(1e30);
  StepBound bound = StepBound::none;

  MPMPBD_HD void lower(T other, StepBound why) {
    if (other < dt) dt = other, bound = why;
  }
};

// The recommended longest step: elastic waves, half a cell of motion, half a unit of strain.
template <class Body, class T> MPMPBD_HD StepLimit<T> step_limit(StepBounds<T> const& b, T dx) {
  StepLimit<T> limit;
  limit.lower(elastic_limit<Body>(b, dx), StepBound::elastic);
  if (b.speed2 > T(0)) limit.lower(T(0.5) * dx / sqrt(b.speed2), StepBound::speed);
  if (b.rate2 > T(0)) limit.lower(T(0.5) / sqrt(b.rate2), StepBound::strain);
  limit.dt *= T(time_step_safety);
  return limit;
}
template <class Body, class T> MPMPBD_HD T suggest_dt(StepBounds<T> const& b, T dx) {
  return step_limit<Body>(b, dx).dt;
}

}  // namespace mpmpbd
