// Which triangles are near a point: square columns along z, each with a list of the triangles over
// it.
//
// Scratch, rebuilt when the sheet has moved by `margin` (a substep moves it by much less than a
// cell, so once per step is enough); serial and in triangle order, so the lists never depend on a
// race. A column holds each of its triangles once, which is what counting the crossings of a
// vertical ray needs.
#pragma once

#include <mpmpbd/core/status.hpp>
#include <mpmpbd/surface/sheet.hpp>

namespace mpmpbd {

struct SheetColumns {
  static constexpr FixedString name = "sheet column";
};
struct SheetItems {
  static constexpr FixedString name = "sheet item";
};

namespace sheet {
struct First : Field<"first", "1", Integer, SheetColumns> {
};  // first item of a column; one more at the end
struct Item : Field<"item", "1", Integer, SheetItems> {};  // a triangle
}  // namespace sheet

template <class T, class Firsts, class Items> struct Columns {
  Vec<T, 2> origin;  // low corner [m]
  T inverse_width;   // of a column [1/m]
  int count[2];
  T margin;      // how far vertices may move before the lists are rebuilt [m]
  Firsts first;  // count[0] * count[1] + 1 entries
  Items item;
  std::int64_t capacity;  // of items

  MPMPBD_HD int column(int axis, T x) const {
    T const c = (x - origin[axis]) * inverse_width;
    // What is outside (and NaN) belongs to the border columns.
    if (!(c > T(0))) return 0;
    return c < T(count[axis]) ? static_cast<int>(c) : count[axis] - 1;
  }
  MPMPBD_HD std::int64_t index(int i, int j) const {
    return i + static_cast<std::int64_t>(count[0]) * j;
  }
  MPMPBD_HD std::int64_t columns() const { return static_cast<std::int64_t>(count[0]) * count[1]; }

  // Calls f(triangle) for the triangles of all columns that the rectangle [low, high] touches,
  // column by column; one that lies over several columns comes several times.
  template <class F> MPMPBD_HD void for_each(Vec3<T> const& low, Vec3<T> const& high, F&& f) const {
    int const i0 = column(0, low[0]), i1 = column(0, high[0]), j0 = column(1, low[1]),
              j1 = column(1, high[1]);
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i) {
        std::int64_t const c = index(i, j);
        std::int64_t const end = first(c + 1);
        for (std::int64_t k = first(c); k < end; ++k) f(item(k));
      }
  }

  // Builds the lists; returns Fault::overflow when they do not fit (the triangles left out are then
  // not seen, so the environment's results are not to be used).
  template <class S> MPMPBD_HD std::uint32_t build(S const& sheet) const {
    std::int64_t const n = columns();
    for (std::int64_t c = 0; c <= n; ++c) first.set(c, 0);
    for_each_overlap(sheet,
                     [&](std::int64_t c, std::int64_t) { first.set(c + 1, first(c + 1) + 1); });
    for (std::int64_t c = 0; c < n; ++c) first.set(c + 1, first(c + 1) + first(c));
    std::uint32_t const faults =
        first(n) > capacity ? static_cast<std::uint32_t>(Fault::overflow) : 0u;
    // Fill with `first` as the cursor of each column, then move it back by one column.
    for_each_overlap(sheet, [&](std::int64_t c, std::int64_t k) {
      std::int64_t const at = first(c);
      if (at < capacity) item.set(at, k);
      first.set(c, at + 1);
    });
    for (std::int64_t c = n; c > 0; --c) first.set(c, min(first(c - 1), capacity));
    first.set(0, 0);
    return faults;
  }

 private:
  template <class S, class F> MPMPBD_HD void for_each_overlap(S const& sheet, F&& f) const {
    for (std::int64_t k = 0; k < sheet.triangles; ++k) {
      auto const t = sheet.triangle(k);
      int range[2][2];
      for (int a = 0; a < 2; ++a) {
        range[a][0] = column(a, min(t.a[a], min(t.b[a], t.c[a])) - margin);
        range[a][1] = column(a, max(t.a[a], max(t.b[a], t.c[a])) + margin);
      }
      for (int j = range[1][0]; j <= range[1][1]; ++j)
        for (int i = range[0][0]; i <= range[0][1]; ++i) f(index(i, j), k);
    }
  }
};

template <class T, class Firsts, class Items>
MPMPBD_HD Columns<T, Firsts, Items> make_columns(Vec<T, 2> const& origin, T width, int nx, int ny,
                                                 T margin, Firsts const& first, Items const& item,
                                                 std::int64_t capacity) {
  return {origin, T(1) / width, {nx, ny}, margin, first, item, capacity};
}

}  // namespace mpmpbd
