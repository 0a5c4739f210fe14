// Grid to particle: velocity, its gradient, the new position and deformation gradient.
//
// v = sum w v_i;  L = D^-1 sum w v_i d^T (MLS) or sum v_i grad w^T;  x += dt v;  F <- (I + dt L) F.
#pragma once

#include <mpmpbd/core/status.hpp>
#include <mpmpbd/mpm/scatter.hpp>

namespace mpmpbd {

template <class Body> struct Gather {
  using Shape = typename Body::Shape;
  using Transfer = typename Body::Transfer;
  using Form = typename Body::Form;
  using Material = typename Body::Material;

  using Reads =
      union_t<typename Transfer::Reads, Fields<particle::Position, particle::Deformation>>;
  using Writes = union_t<Fields<particle::Position>, typename Transfer::Writes,
                         Fields<particle::Deformation, particle::Gradient>>;

  // Moves one particle; `grid.row(i, j, k)[n]` is the velocity of the
  // n-th node from there along x. Returns the fault bits it met.
  template <class P, class Grid, class K, class T>
  MPMPBD_INLINE static std::uint32_t run(P& p, Grid const& grid, K const& transfer_parameters,
                                         Lattice<T> const& lattice, T dt) {
    Gathered<T> const g =
        collect(Stencil<T, Shape>::at(lattice, p[particle::Position{}]), grid, lattice);
    Transfer::finish(p, g, transfer_parameters);
    p[particle::Gradient{}] = Form::uses_moment ? g.moment : g.slope;
    p[particle::Deformation{}] += (dt * p[particle::Gradient{}]) * p[particle::Deformation{}];
    p[particle::Position{}] += dt * g.velocity;
    return keep_inside(p[particle::Position{}], g.velocity, lattice, dt);
  }

  // Interpolates what the composition needs; also how tracers and laws read the grid.
  template <class Grid, class T>
  MPMPBD_INLINE static Gathered<T> collect(Stencil<T, Shape> const& s, Grid const& grid,
                                           Lattice<T> const& lattice) {
    auto const x = detail::axis_weights<Shape, Body::needs_slope>(s.f[0]);
    auto const y = detail::axis_weights<Shape, Body::needs_slope>(s.f[1]);
    auto const z = detail::axis_weights<Shape, Body::needs_slope>(s.f[2]);
    constexpr bool moments = Body::needs_moment && Shape::inverse_inertia > 0.0;
    auto const zero = quad<T>(0, 0, 0, 0);
    Quad<T> v = zero, previous = zero, moment[3] = {zero, zero, zero},
            slope[3] = {zero, zero, zero};
    for (int k = 0; k < Shape::width; ++k) {
      for (int j = 0; j < Shape::width; ++j) {
        auto const nodes = grid.row(s.base[0], s.base[1] + j, s.base[2] + k);
        Quad<T> row = zero, row_i = zero, row_slope = zero;
        for (int i = 0; i < Shape::width; ++i) {
          Quad<T> const wv = x.weight[i] * nodes[i];
          row = row + wv;
          if constexpr (moments) row_i = row_i + (T(i) - s.f[0]) * wv;
          if constexpr (Body::needs_slope) row_slope = row_slope + x.slope[i] * nodes[i];
          if constexpr (Transfer::needs_previous_grid)
            previous = previous + (x.weight[i] * y.weight[j] * z.weight[k]) *
                                      grid.previous_row(s.base[0], s.base[1] + j, s.base[2] + k)[i];
        }
        T const w = y.weight[j] * z.weight[k];
        v = v + w * row;
        if constexpr (moments) {
          moment[0] = moment[0] + w * row_i;
          moment[1] = moment[1] + (w * (T(j) - s.f[1])) * row;
          moment[2] = moment[2] + (w * (T(k) - s.f[2])) * row;
        }
        if constexpr (Body::needs_slope) {
          slope[0] = slope[0] + w * row_slope;
          slope[1] = slope[1] + (y.slope[j] * z.weight[k]) * row;
          slope[2] = slope[2] + (y.weight[j] * z.slope[k]) * row;
        }
      }
    }
    Gathered<T> g{};
    g.velocity = vector_part(v);
    g.previous_velocity = vector_part(previous);
    for (int a = 0; a < 3; ++a) {
      if constexpr (moments)
        set_column(g.moment, a,
                   T(Shape::inverse_inertia) * lattice.inverse_dx * vector_part(moment[a]));
      if constexpr (Body::needs_slope)
        set_column(g.slope, a, lattice.inverse_dx * vector_part(slope[a]));
    }
    if constexpr (Body::needs_moment && !moments) g.moment = g.slope;
    return g;
  }

 private:
  template <class T>
  MPMPBD_INLINE static void set_column(Mat3<T>& a, int column, Vec3<T> const& v) {
    for (int i = 0; i < 3; ++i) a(i, column) = v[i];
  }

  // A particle that would lose a node of its stencil is held at the border of the domain.
  template <class T>
  MPMPBD_INLINE static std::uint32_t keep_inside(Vec3<T>& x, Vec3<T> const& v,
                                                 Lattice<T> const& lattice, T dt) {
    std::uint32_t faults = 0;
    for (int a = 0; a < 3; ++a) {
      T const low = lowest_cell<Shape, T>() * lattice.dx;
      T const high = highest_cell<Shape, T>(lattice.nodes[a]) * lattice.dx;
      if (!(x[a] >= low && x[a] <= high)) {
        faults |= static_cast<std::uint32_t>(is_finite(x[a]) ? Fault::escape : Fault::not_finite);
        x[a] = x[a] > high ? high : low;  // NaN goes to the low side; the environment is frozen
      }
      if (!(abs(v[a]) * dt <= lattice.dx)) faults |= static_cast<std::uint32_t>(Fault::speed);
    }
    return faults;
  }
};

}  // namespace mpmpbd
