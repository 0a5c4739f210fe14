// Neighbouring nodes along x that are computed at once: one, or two where vectors hold eight floats.
//
// Scatter and gather take the columns of a stencil (all its nodes with the same x) one after the other,
// or as many at once as the grid says. Every sum has the same order either way, so the bits of finite numbers are equal.
#pragma once

#include <mpmpbd/core/quad.hpp>

namespace mpmpbd {

// What a sum over columns needs of its numbers: those of one node.
template <class T> struct OneNode {
  static constexpr int count = 1;
  using Values = Quad<T>;
  using Changes = Massless<T>;

  MPMPBD_INLINE static T each(T const* of_node) { return of_node[0]; }
  MPMPBD_INLINE static T numbered(int first) { return T(first); }
  MPMPBD_INLINE static bool all_zero(int first) { return first == 0; }  // of these numbers
  template <class Q> MPMPBD_INLINE static Q all(Q const& q) { return q; }
  template <class Row> MPMPBD_INLINE static Values load(Row const& row, int first) {
    return row[first];
  }
  // sum + s times the node's values.
  MPMPBD_INLINE static Quad<T> add_product(Quad<T> const& sum, T s, Values const& a) {
    return mpmpbd::add_product(sum, s, a);
  }
};

#if defined(MPMPBD_HAS_PACKS)
// Two neighbours: eight numbers.
struct TwoNodes {
  static constexpr int count = 2;
  using Values = Pack<float>;
  using Changes = Values;

  MPMPBD_WIDE static Values each(float const* of_node) {
    float const a = of_node[0], b = of_node[1];
    return Values::Lanes{a, a, a, a, b, b, b, b};
  }
  MPMPBD_WIDE static Values numbered(int first) {
    float const n[2] = {static_cast<float>(first), static_cast<float>(first + 1)};
    return each(n);
  }
  MPMPBD_WIDE static bool all_zero(int) { return false; }
  MPMPBD_WIDE static Values all(Quad<float> const& q) { return both(q, q); }
  MPMPBD_WIDE static Values load(Quad<float> const* row, int first) {
    return Values::load(reinterpret_cast<float const*>(row + first));
  }
  MPMPBD_WIDE static Quad<float> add_product(Quad<float> const& sum, Values const& s,
                                             Values const& a) {
    Values const products = s * a;
    return (sum + low_half(products)) + high_half(products);
  }
};
#endif

// Whether a grid is read and added to two neighbours at a time.
template <class Grid>
inline constexpr bool in_pairs = [] {
  if constexpr (requires { Grid::in_pairs; })
    return bool(Grid::in_pairs);
  else
    return false;
}();

// Calls f(nodes, first) for all columns of a stencil, in their order.
template <class Grid, class T, int width, class Function>
MPMPBD_INLINE void for_columns(Function&& f) {
  int i = 0;
#if defined(MPMPBD_HAS_PACKS)
  if constexpr (in_pairs<Grid>)
    for (; i + 2 <= width; i += 2) f(TwoNodes{}, i);
#endif
  for (; i < width; ++i) f(OneNode<T>{}, i);
}

}  // namespace mpmpbd
