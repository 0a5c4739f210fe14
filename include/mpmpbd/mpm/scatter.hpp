// Particle to grid: mass, momentum and the impulse of internal forces over one substep.
//
// m_i += w m;  (m v)_i += w m (v + C d) - dt V0 tau g,  g = D^-1 w d (MLS) or grad w. Jiang et al.
// 2015; Hu et al. 2018, eq. 16-18. With MLS both terms are one matrix: w (m C - dt V0 D^-1 tau) d.
// Where particles are driven, + w m dt a. Added to a particle's own velocity instead, a force would leave
// FLIP with what the grid cannot see.
#pragma once

#include <mpmpbd/core/status.hpp>
#include <mpmpbd/core/tick.hpp>
#include <mpmpbd/mpm/body.hpp>
#include <mpmpbd/mpm/lattice.hpp>
#include <mpmpbd/mpm/neighbours.hpp>

namespace mpmpbd {

// 1-D weights of a stencil along its axes; slopes in 1/cells, only where they are used.
template <class T, class Shape, bool slopes> struct StencilWeights {
  struct Axis {
    T weight[Shape::width];
    T slope[slopes ? Shape::width : 1];
  };
  Axis x, y, z;

  MPMPBD_INLINE static StencilWeights at(T const (&f)[3]) {
    return {along(f[0]), along(f[1]), along(f[2])};
  }
  MPMPBD_INLINE StencilWeights<lane_t<T>, Shape, slopes> of_lane(int l) const {
    return {lane_of(x, l), lane_of(y, l), lane_of(z, l)};
  }

 private:
  MPMPBD_INLINE static Axis along(T f) {
    Axis a{};
    for (int i = 0; i < Shape::width; ++i) {
      a.weight[i] = Shape::weight(i, f);
      if constexpr (slopes) a.slope[i] = Shape::slope(i, f);
    }
    return a;
  }
  MPMPBD_INLINE static auto lane_of(Axis const& a, int l) {
    typename StencilWeights<lane_t<T>, Shape, slopes>::Axis one{};
    for (int i = 0; i < Shape::width; ++i) {
      one.weight[i] = lane(a.weight[i], l);
      if constexpr (slopes) one.slope[i] = lane(a.slope[i], l);
    }
    return one;
  }
};

// The stencils of all lanes of T at once.
template <class T, class Shape> struct Stencils {
  T first[3];  // first node per axis, whole numbers
  T f[3];      // distance from it [cells]

  MPMPBD_INLINE static Stencils at(Lattice<lane_t<T>> const& lattice, Vec3<T> const& x) {
    Stencils s;
    for (int a = 0; a < 3; ++a) {
      auto const along = on_axis<Shape>(x[a], T(lattice.inverse_dx));
      s.first[a] = along.first;
      s.f[a] = along.distance;
    }
    return s;
  }
  MPMPBD_INLINE Stencil<lane_t<T>, Shape> of_lane(int l) const {
    Stencil<lane_t<T>, Shape> s;
    for (int a = 0; a < 3; ++a) {
      s.base[a] = static_cast<int>(lane(first[a], l));
      s.f[a] = lane(f[a], l);
    }
    return s;
  }
};

namespace detail {
// The momentum (and mass) a particle brings to a node at offset d is value + gradient d, d in cells.
template <class T> struct AffineMomentum {
  Vec<T, 4> value;        // at the first node
  Vec<T, 4> gradient[3];  // per cell along each axis
};
// The same for one particle, four numbers an instruction; and the impulse of forces by slopes.
template <class S> struct LaneMomentum {
  Quad<S> value;
  Massless<S> gradient[3], impulse[3];
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

  // Adds one particle (or a pack of them, one after the other) to the grid: `grid.window(node).row(j, k)` is
  // a row along x from there, and `row.add(n, quad)` adds to its n-th node. `add_previous` adds the same without the impulse of
  // the forces, for transfers that ask. A kernel adds in fixed point: its grid says what one of its counts is (unit) and
  // rounds what the nodes get, one after the other (shares). With `driven`, particles have an Acceleration. Returns Fault::speed
  // where a particle brings more than sums of counts hold (most_cells per substep), and it was slowed down to that; and
  // Fault::not_finite where no count stands for what it would bring, and it brought nothing more.
  template <bool driven = false, class P, class Grid, class S>
  MPMPBD_INLINE static std::uint32_t run(P const& p, Grid const& grid, Lattice<S> const& lattice,
                                         S dt) {
    using T = typename P::Scalar;
    auto const s = Stencils<T, Shape>::at(lattice, p[particle::Position{}]);
    auto const w = Weights<T>::at(s.f);
    auto const amount = amount_in<T>(grid, p);
    detail::LaneMomentum<S> carried[lanes<T>];
    std::uint32_t faults = 0;
    to_each(momentum<Form::uses_moment, driven>(p, amount, s, lattice, dt), carried);
    if constexpr (!Form::uses_moment)
      impulse_to_each(T(-dt * lattice.inverse_dx) * amount.volume, p[particle::Stress{}], carried);
    if constexpr (counts<Grid>) faults |= slow_down<Grid>(carried[0]);
    if (has(faults, Fault::not_finite)) return faults;
    for (int l = 0; l < lanes<T>; ++l) add<false>(grid, s.of_lane(l), w.of_lane(l), carried[l]);
    if constexpr (Transfer::needs_previous_grid) {
      detail::LaneMomentum<S> before[lanes<T>]{};
      to_each(momentum<false, false>(p, amount, s, lattice, dt), before);
      if constexpr (counts<Grid>) faults |= slow_down<Grid>(before[0]);
      if (has(faults, Fault::not_finite)) return faults;
      for (int l = 0; l < lanes<T>; ++l) add<true>(grid, s.of_lane(l), w.of_lane(l), before[l]);
    }
    return faults;
  }

 private:
  template <class T> using Weights = StencilWeights<T, Shape, !Form::uses_moment>;
  template <class Grid> static constexpr bool counts = requires(Grid const& g) { g.unit; };

  // Mass and volume of a particle, in units of the sums of momentum, and its mass in that of the sums of mass: [kg], [m^3], [kg],
  // or counts where the grid has them.
  template <class T> struct Amount { T inertia, volume, mass; };
  template <class T, class Grid, class P>
  MPMPBD_INLINE static Amount<T> amount_in(Grid const& grid, P const& p) {
    T const m = p[particle::Mass{}], V = p[particle::Volume{}];
    if constexpr (counts<Grid>)
      return {grid.unit.momentum * m, grid.unit.momentum * V, grid.unit.mass * m};
    else
      return {m, V, m};
  }

  // Numbers of all lanes become quads of each.
  template <class T, class S, int count>
  MPMPBD_INLINE static void to_each(detail::AffineMomentum<T> const& q,
                                    detail::LaneMomentum<S> (&out)[count]) {
    Quad<S> part[count];
    to_lanes(q.value, part);
    for (int l = 0; l < count; ++l) out[l].value = part[l];
    for (int a = 0; a < 3; ++a) {
      to_lanes(q.gradient[a], part);
      for (int l = 0; l < count; ++l) out[l].gradient[a] = without_mass(part[l]);
    }
  }
  // Forces by slopes of the weights: - dt V0 tau per cell.
  template <class T, class S, int count>
  MPMPBD_INLINE static void impulse_to_each(T const& scale, Mat3<T> const& stress,
                                            detail::LaneMomentum<S> (&out)[count]) {
    Mat3<T> const A = scale * stress;
    Quad<S> part[count];
    for (int a = 0; a < 3; ++a) {
      to_lanes(Vec<T, 4>{{A(0, a), A(1, a), A(2, a), T(0)}}, part);
      for (int l = 0; l < count; ++l) out[l].impulse[a] = without_mass(part[l]);
    }
  }

  // What a particle brings, in counts of the grid, in which momentum at a cell per substep is as much as mass, is
  // scaled down so that no node of the stencil gets more than at the grid's most_cells per substep.
  template <class Grid, class S>
  MPMPBD_INLINE static std::uint32_t slow_down(detail::LaneMomentum<S>& q) {
    S const most = Grid::most_cells * q.value[3];
    Vec3<S> const greatest = greatest_momentum(q);
    S const sum = greatest[0] + greatest[1] + greatest[2];  // NaN where one of them is
    if (sum <= most) return 0;
    if (!is_finite(sum)) return static_cast<std::uint32_t>(Fault::not_finite);
    S const fastest = max(max(greatest[0], greatest[1]), greatest[2]);
    if (!(fastest > most)) return 0;
    S const share = most / fastest;
    q.value = quad<S>(share * q.value[0], share * q.value[1], share * q.value[2], q.value[3]);
    for (auto& g : q.gradient) g = share * g;
    if constexpr (!Form::uses_moment)
      for (auto& b : q.impulse) b = share * b;
    return static_cast<std::uint32_t>(Fault::speed);
  }
  // Components of momentum over weight at any node of the stencil are no more: that of its middle, and what there
  // is from there to a corner.
  template <class S>
  MPMPBD_INLINE static Vec3<S> greatest_momentum(detail::LaneMomentum<S> const& q) {
    constexpr S half = S(Shape::width - 1) / 2;
    auto const of = [&q](int i) MPMPBD_ALWAYS_INLINE {
      auto const sum = [i](auto const& c) { return c[0][i] + c[1][i] + c[2][i]; };
      auto const size = [i](auto const& c) { return abs(c[0][i]) + abs(c[1][i]) + abs(c[2][i]); };
      S const reach = half * size(q.gradient);
      S const greatest = abs(multiply_add(half, sum(q.gradient), q.value[i])) + reach;
      return Form::uses_moment ? greatest : greatest + size(q.impulse);
    };
    return {{of(0), of(1), of(2)}};
  }

  // Adds one particle to its nodes.
  template <bool previous, class Grid, class S>
  MPMPBD_INLINE static void add(Grid const& grid, Stencil<S, Shape> const& s, Weights<S> const& w,
                                detail::LaneMomentum<S> const& q) {
    auto const window = grid.window(s.base);
    auto const to_nodes = [&](auto const& put) MPMPBD_ALWAYS_INLINE {
      for_columns<Grid, S, Shape::width>([&](auto nodes, int i) MPMPBD_ALWAYS_INLINE {
        add_columns<decltype(nodes), previous>(window, w, q, i, put);
      });
    };
    if constexpr (requires { grid.shares(); }) {
      auto shares = grid.shares();
      to_nodes([&shares](auto const& row, int i, S weight, auto const& all) MPMPBD_ALWAYS_INLINE {
        if constexpr (previous) {
          row.add_previous_counts(i, shares.next(weight, all));
        } else {
          row.add_mass(i, weight, all);
          row.add_counts(i, shares.next(weight, all));
        }
      });
    } else {
      to_nodes([](auto const& row, int i, S weight, auto const& all) MPMPBD_ALWAYS_INLINE {
        if constexpr (previous)
          row.add_previous(i, weight * all);
        else
          row.add(i, weight * all);
      });
    }
  }
  // w_i w_j w_k (value + gradient d) to the nodes of some columns, the products of weights taken plane by
  // plane and row by row; the last weight is given with what it weighs, put(row, i, w_j, all), which a sum of counts joins.
  template <class N, bool previous, class Nodes, class S, class Put>
  MPMPBD_INLINE static void add_columns(Nodes const& nodes, Weights<S> const& w,
                                        detail::LaneMomentum<S> const& q, int i, Put const& put) {
    using V = typename N::Values;
    constexpr bool slopes = !previous && !Form::uses_moment;
    auto const w_x = N::each(w.x.weight + i);
    V column = N::all(q.value);
    if (!N::all_zero(i)) column = add_product(column, N::numbered(i), N::all(q.gradient[0]));
    column = w_x * column;
    using Change = typename N::Changes;
    Change const along_y = w_x * N::all(q.gradient[1]);
    Change across_y, across_z;
    if constexpr (slopes) {
      column = add_product(column, N::each(w.x.slope + i), N::all(q.impulse[0]));
      across_y = w_x * N::all(q.impulse[1]), across_z = w_x * N::all(q.impulse[2]);
    }
    for (int k = 0; k < Shape::width; ++k) {
      if (k > 0) column = add_product(column, w_x, N::all(q.gradient[2]));
      V row = w.z.weight[k] * column;
      if constexpr (slopes) row = add_product(row, w.z.slope[k], across_z);
      for (int j = 0; j < Shape::width; ++j) {
        if (j > 0) row = add_product(row, w.z.weight[k], along_y);
        if constexpr (slopes)
          put(nodes.row(j, k), i, S(1),
              add_product(w.y.weight[j] * row, w.y.slope[j], w.z.weight[k] * across_y));
        else
          put(nodes.row(j, k), i, w.y.weight[j], row);
      }
    }
  }

  // Momentum and mass as an affine function of the offset; with the impulse of the forces (MLS) or without.
  template <bool forces, bool driven, class P, class T, class S>
  MPMPBD_INLINE static detail::AffineMomentum<T> momentum(P const& p, Amount<T> const& amount,
                                                          Stencils<T, Shape> const& s,
                                                          Lattice<S> const& lattice,
                                                          [[maybe_unused]] S dt) {
    T const m = amount.inertia;
    Vec3<T> v = m * p[particle::Velocity{}];
    if constexpr (driven) v = add_product(v, m * T(dt), p[particle::Acceleration{}]);
    Mat3<T> A{};
    if constexpr (Transfer::carries_affine) A = (m * T(lattice.dx)) * p[particle::Affine{}];
    if constexpr (forces)
      A = add_product(A, T(-dt * S(Shape::inverse_inertia) * lattice.inverse_dx) * amount.volume,
                      p[particle::Stress{}]);
    detail::AffineMomentum<T> q;
    q.value = {{v[0], v[1], v[2], amount.mass}};
    for (int a = 0; a < 3; ++a) {
      q.gradient[a] = {{A(0, a), A(1, a), A(2, a), T(0)}};
      for (int i = 0; i < 3; ++i) q.value[i] = multiply_add(-s.f[a], A(i, a), q.value[i]);
    }
    return q;
  }
};

}  // namespace mpmpbd
