// Neighbouring nodes along x that are computed at once: one, everywhere.
//
// Scatter and gather take the columns of a stencil (all its nodes with the same x) one after the other,
// or as many at once as the grid says. Every sum has the same order either way, so the bits are equal.
#pragma once

#include <mpmpbd/core/quad.hpp>

namespace mpmpbd {

// What a sum over columns needs of its numbers: those of one node.
template <class T> struct OneNode {
  static constexpr int count = 1;
  using Values = Quad<T>;

  MPMPBD_INLINE static T each(T const* of_node) { return of_node[0]; }
  MPMPBD_INLINE static T numbered(int first) { return T(first); }
  MPMPBD_INLINE static Values all(Quad<T> const& q) { return q; }
  template <class Row> MPMPBD_INLINE static Values load(Row const& row, int first) {
    return row[first];
  }
  // sum + the node's values.
  MPMPBD_INLINE static Quad<T> add(Quad<T> const& sum, Values const& a) { return sum + a; }
};

// Calls f(nodes, first) for the columns of a stencil.
template <class Grid, class T, int width, class Function>
MPMPBD_INLINE void for_columns(Function&& f) {
  for (int i = 0; i < width; ++i) f(OneNode<T>{}, i);
}

}  // namespace mpmpbd
