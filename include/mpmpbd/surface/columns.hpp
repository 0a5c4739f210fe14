// Which triangles are near a point: square columns along z, each with a list of the triangles over
// it.
//
// Scratch, built by all lanes of a team, and anew when a vertex has moved along x or y by more than
// `margin`. A list is in no order: no question to the sheet hangs on it. A column holds each of its
// triangles once, which is what counting the crossings of a vertical ray needs.
#pragma once

#include <type_traits>

#include <mpmpbd/core/pack.hpp>
#include <mpmpbd/core/status.hpp>
#include <mpmpbd/coupling/team.hpp>
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
    // What is outside (and NaN) belongs to the border columns.
    T const c = (x - origin[axis]) * inverse_width;
    return static_cast<int>(select(c > T(0), min(c, T(count[axis] - 1)), T(0)));
  }
  MPMPBD_HD std::int64_t index(int i, int j) const {
    return i + static_cast<std::int64_t>(count[0]) * j;
  }
  MPMPBD_HD std::int64_t columns() const { return static_cast<std::int64_t>(count[0]) * count[1]; }

  // Calls f(triangle) for the triangles of all columns that the rectangle [low, high] touches,
  // column by column; one that lies over several columns comes several times. The lanes of a group
  // take the triangles by turns: those of a row of columns lie one after the other.
  template <class F> MPMPBD_HD void for_each(Vec3<T> const& low, Vec3<T> const& high, F&& f) const {
    for_each(Solo{}, low, high, f);
  }
  template <class Group_, class F>
  MPMPBD_HD void for_each(Group_ const& group, Vec3<T> const& low, Vec3<T> const& high,
                          F&& f) const {
    int const i0 = column(0, low[0]), i1 = column(0, high[0]), j0 = column(1, low[1]),
              j1 = column(1, high[1]);
    for (int j = j0; j <= j1; ++j) {
      std::int64_t const begin = first(index(i0, j)), end = first(index(i1, j) + 1);
      group.each(static_cast<int>(end - begin), [&](int n) { f(item(begin + n)); });
    }
  }

  // Builds the lists; returns Fault::overflow when they do not fit (no triangle is seen then, so the
  // environment's results are not to be used).
  template <class S> MPMPBD_HD std::uint32_t build(S const& sheet) const {
    return build(Solo{}, sheet);
  }
  template <class Team_, class S>
  MPMPBD_HD std::uint32_t build(Team_ const& team, S const& sheet) const {
    int const n = static_cast<int>(columns());
    auto const clear = [&] {
      team.each(n + 1, [&](int c) { first.set(c, 0); });
      team.sync();
    };
    clear();
    // Twice the same text, for a device waits for its code: first the items of a column are counted, in the entry after its own; then
    // they are listed, and that entry is the place of the next one, until it is where the next column's list begins.
    MPMPBD_NO_UNROLL
    for (bool listing = false;; listing = true) {
      visit_overlaps(team, sheet, listing);
      team.sync();
      if (listing) return 0u;
      team.groups(1, [&](auto const& group, int) { number_items(group); });
      team.sync();
      bool const fits = first(0) == 0;
      team.sync();
      if (!fits) {
        clear();
        return static_cast<std::uint32_t>(Fault::overflow);
      }
    }
  }

 private:
  // Adds 1 to an entry, to which other lanes may add as well; returns what it was.
  template <class Team_> MPMPBD_HD std::int64_t add(Team_ const& team, std::int64_t c) const {
    if constexpr (requires { first.entry(c); }) {
      return team.add(first.entry(c), 1);
    } else {
      static_assert(std::is_same_v<Team_, Solo>,
                    "mpmpbd Columns: lists of 64-bit fields are built by one lane; give rows with "
                    "`int& entry(i)` to a team of several");
      std::int64_t const before = first(c);
      first.set(c, before + 1);
      return before;
    }
  }
  // From how many items a column has, which stands in the entry after its own, to its first one there.
  // Entry 0 is not 0 where they do not fit.
  template <class Group_> MPMPBD_HD void number_items(Group_ const& group) const {
    Piece const mine = group.part(static_cast<int>(columns()));
    int own = 0;
    for_each_count(mine, [&](int, int of_column) { own += of_column; });
    int sum = group.sum_before(own);
    bool const fits = group.sum(own) <= capacity;
    for_each_count(mine, [&](int c, int of_column) {
      first.set(c + 1, sum);
      sum += of_column;
    });
    if (!fits) group.one([&] { first.set(0, 1); });
  }
  // Calls f(column, what stands in the entry after its own) in their order. A device has several of them on their way.
  template <class F> MPMPBD_HD void for_each_count(Piece const& some, F const& f) const {
    constexpr int at_once = 8;
    MPMPBD_NO_UNROLL
    for (int c = some.first; c < some.end; c += at_once) {
      int counts[at_once];
      for (int n = 0; n < at_once; ++n)
        counts[n] = static_cast<int>(first(min(c + n, some.end - 1) + 1));
      for (int n = 0; n < at_once; ++n)
        if (c + n < some.end) f(c + n, counts[n]);
    }
  }

  // A walk over the columns that a triangle lies over, row by row.
  struct Walk {
    int i, j, low, high, last_row;
    MPMPBD_HD bool goes_on() const { return j <= last_row; }
    MPMPBD_HD void next() {
      i += 1;
      if (i <= high) return;
      i = low;
      j += 1;
    }
  };
  template <class S> MPMPBD_HD Walk walk_over(S const& sheet, std::int64_t k) const {
    auto const t = sheet.triangle(k);
    int low[2], high[2];
    for (int a = 0; a < 2; ++a) {
      low[a] = column(a, min(t.a[a], min(t.b[a], t.c[a])) - margin);
      high[a] = column(a, max(t.a[a], max(t.b[a], t.c[a])) + margin);
    }
    return {low[0], low[1], low[0], high[0], high[1]};
  }
  // Adds every triangle to every column that it lies over: counts it, or lists it.
  template <class Team_, class S>
  MPMPBD_HD void visit_overlaps(Team_ const& team, S const& sheet, bool listing) const {
    each_loaded<4>(
        team, static_cast<int>(sheet.triangles), [&](int k) { return walk_over(sheet, k); },
        [&](int k, Walk over) {
          MPMPBD_NO_UNROLL
          for (; over.goes_on(); over.next()) {
            std::int64_t const place = add(team, index(over.i, over.j) + 1);
            if (listing) item.set(place, k);
          }
        });
  }
};

template <class T, class Firsts, class Items>
MPMPBD_HD Columns<T, Firsts, Items> make_columns(Vec<T, 2> const& origin, T width, int nx, int ny,
                                                 T margin, Firsts const& first, Items const& item,
                                                 std::int64_t capacity) {
  return {origin, T(1) / width, {nx, ny}, margin, first, item, capacity};
}

}  // namespace mpmpbd
