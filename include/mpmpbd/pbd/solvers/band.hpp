// Elimination of a banded system along a chain of beads.
#pragma once

#include <mpmpbd/pbd/fields.hpp>

namespace mpmpbd::detail {

// The row of L that is being found, and the `half` rows above it: [d - 1] is d rows up. A window that moves down, so that a
// device has all of it in registers. What is above the first row is zero, as what the band holds of it is.
template <class T, int half> struct BandRows {
  T L[half][half] = {};  // [d - 1][k - 1] = L(row - d, row - d - k), where d + k <= half
  T inverse[half] = {};  // 1/D
  T y[half] = {};        // right sides

  // Eliminates a row: its diagonal and the `half` entries before it become 1/D and L, its right side y. Returns whether it
  // has a pivot; if not, 1/D is 0.
  MPMPBD_INLINE bool eliminate(T* row, T& right) {
    T raw[half + 1] = {}, next[half] = {};  // [d] = L(row, row - d) D, and without D [d - 1]
    T pivot = row[0];
    MPMPBD_UNROLL
    for (int d = half; d >= 1; --d) {
      T s = row[d];
      MPMPBD_UNROLL
      for (int k = d + 1; k <= half; ++k) s = multiply_add(-raw[k], L[d - 1][k - d - 1], s);
      raw[d] = s;
      next[d - 1] = s * inverse[d - 1];
      pivot = multiply_add(-s, next[d - 1], pivot);
      right = multiply_add(-next[d - 1], y[d - 1], right);
    }
    bool const solid = pivot > T(64) * epsilon<T> * row[0];
    bool const whole = solid || !(row[0] > T(0));
    row[0] = solid ? T(1) / pivot : T(0);
    for (int d = 0; d < half; ++d) row[d + 1] = next[d];
    move_down(next, row[0], right);
    return whole;
  }

 private:
  MPMPBD_INLINE void move_down(T const (&next)[half], T inverse_pivot, T right) {
    MPMPBD_UNROLL
    for (int d = half - 1; d >= 1; --d) {
      for (int k = 0; k < half - 1 - d; ++k) L[d][k] = L[d - 1][k];
      inverse[d] = inverse[d - 1];
      y[d] = y[d - 1];
    }
    for (int k = 0; k < half - 1; ++k) L[0][k] = next[k];
    inverse[0] = inverse_pivot;
    y[0] = right;
  }
};

// What the rows above take from those that are solved: [d] is d rows up. It moves up with them; so far up as [half], nothing
// is taken yet.
template <class T, int half> struct BandSums {
  T sums[half + 1] = {};

  // The unknown of a row that was eliminated; 0 where it had no pivot.
  MPMPBD_INLINE T solve(T const* row, T right) {
    T const x = multiply_add(right, row[0], -(row[0] > T(0) ? sums[0] : T(0)));
    MPMPBD_UNROLL
    for (int d = 1; d <= half; ++d) sums[d - 1] = multiply_add(row[d], x, sums[d]);
    return x;
  }
};

// Solves a symmetric positive system of `kinds` rows per bead by L D L^T and both substitutions, in place; false
// when a row lost its pivot, whose unknown is then 0. Field Band holds, for each row of a bead, its diagonal and the
// `half` entries before it; read(b) and write(b, r) are the right sides, then the unknowns.
template <class Band, int kinds, int half, class Env, class Read, class Write>
MPMPBD_HD bool eliminate_band(Env const& env, Read const& read, Write const& write) {
  using T = typename Env::Scalar;
  constexpr int width = half + 1;
  std::int64_t const beads = env.template live<Beads>();
  BandRows<T, half> above;
  bool whole = true;
  for (std::int64_t b = 0; b < beads; ++b) {
    auto band = env.template get<Band>(b);
    auto r = read(b);
    for (int a = 0; a < kinds; ++a) whole = above.eliminate(&band[a * width], r[a]) && whole;
    env.template set<Band>(b, band);
    write(b, r);
  }
  BandSums<T, half> below;
  for (std::int64_t b = beads - 1; b >= 0; --b) {
    auto band = env.template get<Band>(b);
    auto r = read(b);
    for (int a = kinds - 1; a >= 0; --a) r[a] = below.solve(&band[a * width], r[a]);
    write(b, r);
  }
  return whole;
}

}  // namespace mpmpbd::detail
