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

  // Moves one particle, or a pack of them; `grid.window(node).row(j, k)[n]` is the velocity of the n-th node
  // along x. Returns the fault bits it met.
  template <class P, class Grid, class K, class S>
  MPMPBD_INLINE static std::uint32_t run(P& p, Grid const& grid, K const& transfer_parameters,
                                         Lattice<S> const& lattice, S dt) {
    using T = typename P::Scalar;
    auto const g = collect<T>(p[particle::Position{}], grid, lattice);
    Transfer::finish(p, g, transfer_parameters);
    p[particle::Gradient{}] = Form::uses_moment ? g.moment : g.slope;
    p[particle::Deformation{}] += (T(dt) * p[particle::Gradient{}]) * p[particle::Deformation{}];
    p[particle::Position{}] = add_product(p[particle::Position{}], T(dt), g.velocity);
    return keep_inside(p[particle::Position{}], g.velocity, lattice, dt);
  }

  // Interpolates at x [m] what the composition needs; also how tracers and laws read the grid.
  template <class T, class Grid, class S>
  MPMPBD_INLINE static Gathered<T> collect(Vec3<T> const& x, Grid const& grid,
                                           Lattice<S> const& lattice) {
    auto const s = Stencils<T, Shape>::at(lattice, x);
    auto const w = Weights<T>::at(s.f);
    Quads<S> lane_sums[lanes<T>];
    for (int l = 0; l < lanes<T>; ++l) lane_sums[l] = sum(grid, s.of_lane(l).base, w.of_lane(l));
    auto const all = [&](auto const& pick) { return vector_of(lane_sums, pick); };
    Gathered<T> g{};
    g.velocity = all([](Quads<S> const& q) { return q.velocity; });
    if constexpr (Transfer::needs_previous_grid)
      g.previous_velocity = all([](Quads<S> const& q) { return q.previous; });
    for (int a = 0; a < 3; ++a) {
      if constexpr (moments) {
        auto const about_middle = all([a](Quads<S> const& q) { return q.moment[a]; });
        set_column(g.moment, a,
                   T(S(Shape::inverse_inertia) * lattice.inverse_dx) *
                       add_product(about_middle, T(middle) - s.f[a], g.velocity));
      }
      if constexpr (Body::needs_slope)
        set_column(g.slope, a,
                   T(lattice.inverse_dx) * all([a](Quads<S> const& q) { return q.slope[a]; }));
    }
    if constexpr (Body::needs_moment && !moments) g.moment = g.slope;
    return g;
  }

 private:
  static constexpr bool moments = Body::needs_moment && Shape::inverse_inertia > 0.0;
  template <class T> using Weights = StencilWeights<T, Shape, Body::needs_slope>;

  // Moments are summed about this node, where arms are small whole numbers, and moved to the particle.
  static constexpr int middle = (Shape::width - 1) / 2;

  // The sums of one particle, four numbers an instruction.
  template <class S> struct Quads {
    Quad<S> velocity, previous;
    Quad<S> moment[moments ? 3 : 1];           // sum w v (i - middle), per axis
    Quad<S> slope[Body::needs_slope ? 3 : 1];  // sum v grad w, in 1/cells
  };

  template <class Grid, class S>
  MPMPBD_INLINE static Quads<S> sum(Grid const& grid, int const (&base)[3], Weights<S> const& w) {
    auto const zero = quad<S>(0, 0, 0, 0);
    Quads<S> q;
    q.velocity = q.previous = zero;
    for (auto& m : q.moment) m = zero;
    for (auto& m : q.slope) m = zero;
    auto const window = grid.window(base);
    auto previous = window;
    if constexpr (Transfer::needs_previous_grid) previous = grid.previous_window(base);
    for_columns<Grid, S, Shape::width>([&](auto nodes, int i) MPMPBD_ALWAYS_INLINE {
      add_columns<decltype(nodes)>(q, window, previous, w, i);
    });
    return q;
  }

  // sum w_n a_n over the neighbours n along an axis, added one after the other.
  template <class V> struct Along {
    V total{};
    template <class S> MPMPBD_INLINE void add(int n, S weight, V const& a) {
      total = n == 0 ? weight * a : add_product(total, weight, a);
    }
  };
  // And sum w_n (n - middle) a_n. Arms are powers of two, their negatives, or 0: to multiply with one does not round.
  template <class V> struct WithMoment {
    V total{}, moment{};
    template <class S> MPMPBD_INLINE void add(int n, S weight, V const& a) {
      S const arm = S(n - middle);
      if (n == 0) {
        total = weight * a;
        if constexpr (moments) moment = arm * total;
      } else {
        total = add_product(total, weight, a);
        if constexpr (moments)
          if (n != middle) moment = add_product(moment, arm * weight, a);
      }
    }
  };

  // Sums some columns, over y, then over z, and adds them to q.
  template <class N, class Nodes, class S>
  MPMPBD_INLINE static void add_columns(Quads<S>& q, Nodes const& nodes,
                                        [[maybe_unused]] Nodes const& previous, Weights<S> const& w,
                                        int i) {
    using V = typename N::Values;
    WithMoment<V> column;
    [[maybe_unused]] Along<V> moment_y, slope_y, slope_z, before;
    for (int k = 0; k < Shape::width; ++k) {
      WithMoment<V> row;
      [[maybe_unused]] Along<V> slope, row_before;
      for (int j = 0; j < Shape::width; ++j) {
        V const v = N::load(nodes.row(j, k), i);
        row.add(j, w.y.weight[j], v);
        if constexpr (Body::needs_slope) slope.add(j, w.y.slope[j], v);
        if constexpr (Transfer::needs_previous_grid)
          row_before.add(j, w.y.weight[j], N::load(previous.row(j, k), i));
      }
      column.add(k, w.z.weight[k], row.total);
      if constexpr (moments) moment_y.add(k, w.z.weight[k], row.moment);
      if constexpr (Body::needs_slope) {
        slope_z.add(k, w.z.slope[k], row.total);
        slope_y.add(k, w.z.weight[k], slope.total);
      }
      if constexpr (Transfer::needs_previous_grid) before.add(k, w.z.weight[k], row_before.total);
    }
    auto const w_x = N::each(w.x.weight + i);
    q.velocity = N::add_product(q.velocity, w_x, column.total);
    if constexpr (moments) {
      if (!N::all_zero(i - middle))
        q.moment[0] = N::add_product(q.moment[0], N::numbered(i - middle) * w_x, column.total);
      q.moment[1] = N::add_product(q.moment[1], w_x, moment_y.total);
      q.moment[2] = N::add_product(q.moment[2], w_x, column.moment);
    }
    if constexpr (Body::needs_slope) {
      q.slope[0] = N::add_product(q.slope[0], N::each(w.x.slope + i), column.total);
      q.slope[1] = N::add_product(q.slope[1], w_x, slope_y.total);
      q.slope[2] = N::add_product(q.slope[2], w_x, slope_z.total);
    }
    if constexpr (Transfer::needs_previous_grid)
      q.previous = N::add_product(q.previous, w_x, before.total);
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
    T const farthest = T(lattice.dx);
    auto const low = T(lowest_cell<Shape, S>() * lattice.dx);
    Vec3<T> high;
    for (int a = 0; a < 3; ++a) high[a] = T(highest_cell<Shape, S>(lattice.nodes[a]) * lattice.dx);
    auto const inside = [&](int a) { return both_hold(x[a] >= low, x[a] <= high[a]); };
    auto const slow = [&](int a) { return abs(v[a]) * T(dt) <= farthest; };
    auto const well = [&](int a) { return both_hold(inside(a), slow(a)); };
    if (!any(!both_hold(both_hold(well(0), well(1)), well(2)))) return 0;
    std::uint32_t faults = 0;
    for (int a = 0; a < 3; ++a) {
      if (any(!inside(a))) {
        faults |=
            static_cast<std::uint32_t>(any(!is_finite(x[a])) ? Fault::not_finite : Fault::escape);
        x[a] = select(x[a] >= low, min(x[a], high[a]), low);  // NaN too; the environment is frozen
      }
      if (any(!slow(a))) faults |= static_cast<std::uint32_t>(Fault::speed);
    }
    return faults;
  }
};

}  // namespace mpmpbd
