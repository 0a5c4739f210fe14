// Particle to grid: mass, momentum and the impulse of internal forces over one substep.
//
// m_i += w m;  (m v)_i += w m (v + C d) - dt V0 tau g,  g = D^-1 w d (MLS) or grad w. Jiang et al.
// 2015; Hu et al. 2018, eq. 16-18. With MLS both terms are one matrix: w (m C - dt V0 D^-1 tau) d.
#pragma once

#include <mpmpbd/core/quad.hpp>
#include <mpmpbd/core/tick.hpp>
#include <mpmpbd/mpm/body.hpp>
#include <mpmpbd/mpm/lattice.hpp>

namespace mpmpbd {

// 1-D weights of a stencil along one axis.
template <class T, int Width> struct AxisWeights {
  T weight[Width];
  T slope[Width];
};

namespace detail {
// Weights, and slopes in 1/cells, along an axis; slopes only where they are used.
template <class Shape, bool Slopes, class T>
MPMPBD_INLINE AxisWeights<T, Shape::width> axis_weights(T f) {
  AxisWeights<T, Shape::width> a{};
  for (int i = 0; i < Shape::width; ++i) {
    a.weight[i] = Shape::weight(i, f);
    if constexpr (Slopes) a.slope[i] = Shape::slope(i, f);
  }
  return a;
}

// The momentum a particle brings to a node at offset d is value + gradient d, d in cells.
template <class T> struct AffineMomentum {
  Quad<T> value;        // at the first node: momentum and mass
  Quad<T> gradient[3];  // per cell along each axis
};
}  // namespace detail

template <class Body> struct Scatter {
  using Shape = typename Body::Shape;
  using Transfer = typename Body::Transfer;
  using Form = typename Body::Form;

  using Reads =
      union_t<Fields<particle::Position, particle::Velocity, particle::Mass, particle::Volume,
                     particle::Stress>,
              std::conditional_t<Transfer::carries_affine, Fields<particle::Affine>, Fields<>>>;
  using Writes = Fields<>;

  // Adds one particle to the grid; `grid.row(i, j, k).add(n, quad)` adds to the n-th node from there
  // along x: floating point on the host, fixed point in a kernel. `add_previous` adds the same without
  // the impulse of the forces, for transfers that ask for the grid before them.
  template <class P, class Grid, class T>
  MPMPBD_INLINE static void run(P const& p, Grid const& grid, Lattice<T> const& lattice, T dt) {
    auto const s = Stencil<T, Shape>::at(lattice, p[particle::Position{}]);
    auto const x = detail::axis_weights<Shape, !Form::uses_moment>(s.f[0]);
    auto const y = detail::axis_weights<Shape, !Form::uses_moment>(s.f[1]);
    auto const z = detail::axis_weights<Shape, !Form::uses_moment>(s.f[2]);
    auto const carried = momentum<Form::uses_moment>(p, s, lattice, dt);
    Mat3<T> impulse{};  // - dt V0 tau per cell: weight gradient form
    if constexpr (!Form::uses_moment)
      impulse = -dt * p[particle::Volume{}] * lattice.inverse_dx * p[particle::Stress{}];

    for (int k = 0; k < Shape::width; ++k) {
      auto const plane = carried.value + T(k) * carried.gradient[2];
      for (int j = 0; j < Shape::width; ++j) {
        auto const row = plane + T(j) * carried.gradient[1];
        T const w_jk = y.weight[j] * z.weight[k];
        auto const nodes = grid.row(s.base[0], s.base[1] + j, s.base[2] + k);
        for (int i = 0; i < Shape::width; ++i) {
          auto sum = (w_jk * x.weight[i]) * (row + T(i) * carried.gradient[0]);
          if constexpr (!Form::uses_moment) {
            Vec3<T> const grad{{x.slope[i] * w_jk, x.weight[i] * y.slope[j] * z.weight[k],
                                x.weight[i] * y.weight[j] * z.slope[k]}};
            sum = sum + quad(impulse * grad, T(0));
          }
          nodes.add(i, sum);
          if constexpr (Transfer::needs_previous_grid)
            nodes.add_previous(i, (w_jk * x.weight[i]) * before_forces(p, s, lattice, i, j, k));
        }
      }
    }
  }

 private:
  // Momentum and mass that a particle brings to node (i, j, k) of its stencil, forces left out.
  template <class P, class T>
  MPMPBD_INLINE static Quad<T> before_forces(P const& p, Stencil<T, Shape> const& s,
                                             Lattice<T> const& lattice, int i, int j, int k) {
    auto const q = momentum<false>(p, s, lattice, T(0));
    return q.value + T(i) * q.gradient[0] + T(j) * q.gradient[1] + T(k) * q.gradient[2];
  }

  template <bool forces, class P, class T>
  MPMPBD_INLINE static detail::AffineMomentum<T> momentum(P const& p, Stencil<T, Shape> const& s,
                                                          Lattice<T> const& lattice,
                                                          [[maybe_unused]] T dt) {
    T const m = p[particle::Mass{}];
    detail::AffineMomentum<T> q;
    q.value = quad(m * p[particle::Velocity{}], m);
    Mat3<T> A{};
    if constexpr (Transfer::carries_affine) A = m * lattice.dx * p[particle::Affine{}];
    if constexpr (forces)
      A -= dt * p[particle::Volume{}] * T(Shape::inverse_inertia) * lattice.inverse_dx *
           p[particle::Stress{}];
    for (int a = 0; a < 3; ++a) {
      q.gradient[a] = quad<T>(A(0, a), A(1, a), A(2, a), T(0));
      q.value = q.value + (-s.f[a]) * q.gradient[a];
    }
    return q;
  }
};

}  // namespace mpmpbd
