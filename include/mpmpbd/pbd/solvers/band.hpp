// Elimination of a banded system along a chain of beads.
#pragma once

#include <mpmpbd/pbd/fields.hpp>

namespace mpmpbd::detail {

// Solves a symmetric positive system of `kinds` rows per bead by L D L^T and both substitutions, in place; false
// when a row lost its pivot, whose unknown is then 0. Field Band holds, for each row of a bead, its diagonal and the
// `half` entries before it; read(b) and write(b, r) are the right sides, then the unknowns.
template <class Band, int kinds, int half, class Env, class Read, class Write>
MPMPBD_HD bool eliminate_band(Env const& env, Read const& read, Write const& write) {
  using T = typename Env::Scalar;
  constexpr int width = half + 1;
  std::int64_t const beads = env.template live<Beads>();
  T L[half][half] = {};  // rows of L above: L[row % half][d - 1] = L(row, row - d)
  T inverse[half] = {};  // 1/D of those rows
  T y[half] = {};
  bool whole = true;
  for (std::int64_t b = 0; b < beads; ++b) {
    auto band = env.template get<Band>(b);
    auto r = read(b);
    for (int a = 0; a < kinds; ++a) {
      std::int64_t const row = b * kinds + a;
      T raw[width] = {};  // L(row, row - d) D
      T next[half] = {};  // L(row, row - d)
      T pivot = band[a * width];
      T const before = pivot;
      T right = r[a];
      for (int d = half; d >= 1; --d) {
        if (row < d) continue;
        int const above = static_cast<int>((row - d) % half);
        T s = band[a * width + d];
        for (int k = d + 1; k <= half && row >= k; ++k) s -= raw[k] * L[above][k - d - 1];
        raw[d] = s;
        next[d - 1] = s * inverse[above];
        pivot -= s * next[d - 1];
        right -= next[d - 1] * y[above];
      }
      bool const solid = pivot > T(64) * epsilon<T> * before;
      if (!solid && before > T(0)) whole = false;
      int const at = static_cast<int>(row % half);
      for (int d = 0; d < half; ++d) L[at][d] = band[a * width + d + 1] = next[d];
      inverse[at] = band[a * width] = solid ? T(1) / pivot : T(0);
      y[at] = r[a] = right;
    }
    env.template set<Band>(b, band);
    write(b, r);
  }
  T sums[half] = {};  // what the rows below take from the next ones: sums[row % half]
  for (std::int64_t b = beads - 1; b >= 0; --b) {
    auto const band = env.template get<Band>(b);
    auto r = read(b);
    for (int a = kinds - 1; a >= 0; --a) {
      std::int64_t const row = b * kinds + a;
      int const at = static_cast<int>(row % half);
      r[a] = r[a] * band[a * width] - (band[a * width] > T(0) ? sums[at] : T(0));
      sums[at] = T(0);
      for (int d = 1; d <= half && row >= d; ++d)
        sums[(row - d) % half] += band[a * width + d] * r[a];
    }
    write(b, r);
  }
  return whole;
}

}  // namespace mpmpbd::detail
