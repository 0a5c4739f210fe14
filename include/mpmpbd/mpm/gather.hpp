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

  // Moves one particle, or a pack of them; `grid.row(i, j, k)[n]` is the velocity of the n-th node from
  // there along x. Returns the fault bits it met.
  template <class P, class Grid, class K, class S>
  MPMPBD_INLINE static std::uint32_t run(P& p, Grid const& grid, K const& transfer_parameters,
                                         Lattice<S> const& lattice, S dt) {
    using T = typename P::Scalar;
    auto const g = collect<T>(p[particle::Position{}], grid, lattice);
    Transfer::finish(p, g, transfer_parameters);
    p[particle::Gradient{}] = Form::uses_moment ? g.moment : g.slope;
    p[particle::Deformation{}] += (T(dt) * p[particle::Gradient{}]) * p[particle::Deformation{}];
    p[particle::Position{}] += T(dt) * g.velocity;
    return keep_inside(p[particle::Position{}], g.velocity, lattice, dt);
  }

  // Interpolates at x [m] what the composition needs; also how tracers and laws read the grid.
  template <class T, class Grid, class S>
  MPMPBD_INLINE static Gathered<T> collect(Vec3<T> const& x, Grid const& grid,
                                           Lattice<S> const& lattice) {
    auto const s = Stencils<T, Shape>::at(lattice, x);
    auto const w = Weights<T>::at(s.f);
    Quads<S> lane_sums[lanes<T>];
    for (int l = 0; l < lanes<T>; ++l) lane_sums[l] = sum(grid, s.of_lane(l), w.of_lane(l));
    Gathered<T> g{};
    g.velocity = vector_of(lane_sums, [](Quads<S> const& q) { return q.velocity; });
    if constexpr (Transfer::needs_previous_grid)
      g.previous_velocity = vector_of(lane_sums, [](Quads<S> const& q) { return q.previous; });
    for (int a = 0; a < 3; ++a) {
      if constexpr (moments)
        set_column(g.moment, a,
                   T(S(Shape::inverse_inertia) * lattice.inverse_dx) *
                       vector_of(lane_sums, [a](Quads<S> const& q) { return q.moment[a]; }));
      if constexpr (Body::needs_slope)
        set_column(g.slope, a, T(lattice.inverse_dx) * vector_of(lane_sums, [a](Quads<S> const& q) {
                                 return q.slope[a];
                               }));
    }
    if constexpr (Body::needs_moment && !moments) g.moment = g.slope;
    return g;
  }

 private:
  static constexpr bool moments = Body::needs_moment && Shape::inverse_inertia > 0.0;
  template <class T> using Weights = StencilWeights<T, Shape, Body::needs_slope>;

  // The sums of one particle, four numbers an instruction.
  template <class S> struct Quads {
    Quad<S> velocity, previous;
    Quad<S> moment[moments ? 3 : 1];           // sum w v d, per axis of d in cells
    Quad<S> slope[Body::needs_slope ? 3 : 1];  // sum v grad w, in 1/cells
  };

  template <class Grid, class S>
  MPMPBD_INLINE static Quads<S> sum(Grid const& grid, Stencil<S, Shape> const& s,
                                    Weights<S> const& w) {
    auto const zero = quad<S>(0, 0, 0, 0);
    Quads<S> q;
    q.velocity = q.previous = zero;
    for (auto& m : q.moment) m = zero;
    for (auto& m : q.slope) m = zero;
    for (int k = 0; k < Shape::width; ++k) {
      for (int j = 0; j < Shape::width; ++j) {
        auto const nodes = grid.row(s.base[0], s.base[1] + j, s.base[2] + k);
        S const w_jk = w.y.weight[j] * w.z.weight[k];
        Quad<S> row = zero, row_moment = zero, row_slope = zero;
        for (int i = 0; i < Shape::width; ++i) {
          Quad<S> const wv = w.x.weight[i] * nodes[i];
          row = row + wv;
          if constexpr (moments) row_moment = row_moment + (S(i) - s.f[0]) * wv;
          if constexpr (Body::needs_slope) row_slope = row_slope + w.x.slope[i] * nodes[i];
          if constexpr (Transfer::needs_previous_grid)
            q.previous =
                q.previous + (w.x.weight[i] * w_jk) *
                                 grid.previous_row(s.base[0], s.base[1] + j, s.base[2] + k)[i];
        }
        q.velocity = q.velocity + w_jk * row;
        if constexpr (moments) {
          q.moment[0] = q.moment[0] + w_jk * row_moment;
          q.moment[1] = q.moment[1] + (w_jk * (S(j) - s.f[1])) * row;
          q.moment[2] = q.moment[2] + (w_jk * (S(k) - s.f[2])) * row;
        }
        if constexpr (Body::needs_slope) {
          q.slope[0] = q.slope[0] + w_jk * row_slope;
          q.slope[1] = q.slope[1] + (w.y.slope[j] * w.z.weight[k]) * row;
          q.slope[2] = q.slope[2] + (w.y.weight[j] * w.z.slope[k]) * row;
        }
      }
    }
    return q;
  }

  // One vector of every lane's sums.
  template <class S, int count, class Pick>
  MPMPBD_INLINE static auto vector_of(Quads<S> const (&sums)[count], Pick const& pick) {
    Quad<S> part[count];
    for (int l = 0; l < count; ++l) part[l] = pick(sums[l]);
    auto const all = from_lanes(part);
    return vec(all[0], all[1], all[2]);
  }

  template <class T>
  MPMPBD_INLINE static void set_column(Mat3<T>& a, int column, Vec3<T> const& v) {
    for (int i = 0; i < 3; ++i) a(i, column) = v[i];
  }

  // A particle that would lose a node of its stencil is held at the border of the domain.
  template <class T, class S>
  MPMPBD_INLINE static std::uint32_t keep_inside(Vec3<T>& x, Vec3<T> const& v,
                                                 Lattice<S> const& lattice, S dt) {
    std::uint32_t faults = 0;
    for (int a = 0; a < 3; ++a) {
      T const low = lowest_cell<Shape, S>() * lattice.dx;
      T const high = highest_cell<Shape, S>(lattice.nodes[a]) * lattice.dx;
      if (any(!(x[a] >= low && x[a] <= high))) {
        faults |=
            static_cast<std::uint32_t>(any(!is_finite(x[a])) ? Fault::not_finite : Fault::escape);
        x[a] = select(x[a] >= low, min(x[a], high), low);  // NaN too; the environment is frozen
      }
      if (any(!(abs(v[a]) * T(dt) <= T(lattice.dx))))
        faults |= static_cast<std::uint32_t>(Fault::speed);
    }
    return faults;
  }
};

}  // namespace mpmpbd
