// The regular grid of one environment. Environment-local coordinates: node (0, 0, 0) is the origin.
#pragma once

#include <cstdint>

#include <mpmpbd/core/pack.hpp>

namespace mpmpbd {

template <class T> struct Lattice {
  T dx;          // cell size [m]
  T inverse_dx;  // [1/m]
  int nodes[3];  // nodes per axis

  MPMPBD_HD static Lattice make(T dx, int nx, int ny, int nz) {
    return {dx, T(1) / dx, {nx, ny, nz}};
  }

  // x is the fastest axis: particles in lattice order then touch memory in order.
  MPMPBD_HD std::int64_t index(int i, int j, int k) const {
    return i + static_cast<std::int64_t>(nodes[0]) * (j + static_cast<std::int64_t>(nodes[1]) * k);
  }
  MPMPBD_HD std::int64_t count() const {
    return static_cast<std::int64_t>(nodes[0]) * nodes[1] * nodes[2];
  }
  MPMPBD_HD Vec3<T> position(int i, int j, int k) const {
    return {{T(i) * dx, T(j) * dx, T(k) * dx}};
  }
};

// Where a coordinate [m] lies along its axis.
template <class T> struct OnAxis {
  T first;     // first node of its stencil, a whole number
  T distance;  // from that node [cells]
};
template <class Shape, class T> MPMPBD_INLINE OnAxis<T> on_axis(T const& x, T const& inverse_dx) {
  T const first = floor(multiply_add(x, inverse_dx, T(-Shape::offset)));
  return {first, multiply_add(x, inverse_dx, -first)};
}

// The nodes around a point and its distance from the first of them; all lengths in cells.
template <class T, class Shape> struct Stencil {
  int base[3];  // first node per axis
  T f[3];       // distance from it [cells]

  MPMPBD_INLINE static Stencil at(Lattice<T> const& lattice, Vec3<T> const& x) {
    Stencil s;
    for (int a = 0; a < 3; ++a) {
      auto const along = on_axis<Shape>(x[a], lattice.inverse_dx);
      s.base[a] = static_cast<int>(along.first);
      s.f[a] = along.distance;
    }
    return s;
  }
  // Whether all nodes exist.
  MPMPBD_INLINE bool inside(Lattice<T> const& lattice) const {
    bool ok = true;
    for (int a = 0; a < 3; ++a)
      ok = ok && base[a] >= 0 && base[a] + Shape::width <= lattice.nodes[a];
    return ok;
  }
};

// The nodes of one stencil as rows along x: the row of the first node, and the way to the others.
template <class Row, class Step> struct Window {
  Row first;
  Step next_row, next_plane;  // nodes
  MPMPBD_INLINE Row row(int j, int k) const { return first + (j * next_row + k * next_plane); }
};
template <class Row, class Step> Window(Row, Step, Step) -> Window<Row, Step>;

// The part of the domain in which a point has all its nodes, kept a hundredth of a cell clear of its
// border so that rounding never leaves it: [low, high] in cells, per axis.
template <class Shape, class T> MPMPBD_HD T lowest_cell() { return T(Shape::offset) + T(0.01); }
template <class Shape, class T> MPMPBD_HD T highest_cell(int nodes) {
  return T(nodes - Shape::width) + T(Shape::offset) + T(0.99);
}

}  // namespace mpmpbd
