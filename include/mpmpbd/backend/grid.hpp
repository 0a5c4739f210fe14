// The grid of one environment on the host: node velocities, and the tiles that particles add to.
//
// Particles are cut into chunks of fixed size; each chunk adds to a tile of its own that covers just
// its nodes, and nodes sum the tiles in chunk order. The sum does not depend on who computed a tile.
#pragma once

#include <cstdint>
#include <vector>

#include <mpmpbd/core/quad.hpp>
#include <mpmpbd/mpm/lattice.hpp>

namespace mpmpbd {

inline constexpr std::int64_t chunk_size = 1024;

// A box of nodes, [low, high) per axis.
struct NodeBox {
  int low[3] = {0, 0, 0};
  int high[3] = {0, 0, 0};
  MPMPBD_HD bool empty() const { return high[0] <= low[0]; }
  MPMPBD_HD bool has_row(int j, int k) const {
    return !empty() && j >= low[1] && j < high[1] && k >= low[2] && k < high[2];
  }
  // In an array of the box's nodes, x fastest: how far it is to the next row and plane, and a node's place.
  MPMPBD_INLINE std::int64_t next_row() const { return high[0] - low[0]; }
  MPMPBD_INLINE std::int64_t next_plane() const { return next_row() * (high[1] - low[1]); }
  MPMPBD_INLINE std::int64_t index(int i, int j, int k) const {
    return (i - low[0]) + next_row() * (j - low[1]) + next_plane() * (k - low[2]);
  }
  void include(int const (&base)[3], int width) {
    bool const first = empty();
    for (int a = 0; a < 3; ++a) {
      if (first || base[a] < low[a]) low[a] = base[a];
      if (first || base[a] + width > high[a]) high[a] = base[a] + width;
    }
  }
};

// Sums of momentum and mass over the nodes of a box; `previous` without forces, where it is asked for.
template <class T> struct Tile {
  NodeBox box;
  std::vector<Quad<T>> sums;
  std::vector<Quad<T>> previous;

  void clear_to(NodeBox const& b, bool with_previous) {
    box = b;
    std::size_t n = 1;
    for (int a = 0; a < 3; ++a) n *= static_cast<std::size_t>(b.empty() ? 0 : b.high[a] - b.low[a]);
    clear(sums, n);
    if (with_previous) clear(previous, n);
  }

 private:
  // With room to grow, so that a body that is deformed a little more needs no new memory.
  static void clear(std::vector<Quad<T>>& of, std::size_t n) {
    if (of.capacity() < n) of.reserve(2 * n);
    of.assign(n, quad<T>(0, 0, 0, 0));
  }
};

// What a scatter adds to: a row of nodes along x.
template <class T> struct SumRow {
  Quad<T>* first;
  Quad<T>* previous;
  MPMPBD_INLINE SumRow operator+(std::int64_t n) const {
    return {first + n, previous == nullptr ? nullptr : previous + n};
  }
  MPMPBD_INLINE void add(int n, Quad<T> const& sum) const { first[n] = first[n] + sum; }
  MPMPBD_INLINE void add_previous(int n, Quad<T> const& sum) const {
    previous[n] = previous[n] + sum;
  }
#if defined(MPMPBD_HAS_PACKS)
  // The same for two nodes.
  MPMPBD_WIDE void add(int n, Pack<float> const& sums) const { add(first + n, sums); }
  MPMPBD_WIDE void add_previous(int n, Pack<float> const& sums) const { add(previous + n, sums); }

 private:
  MPMPBD_WIDE static void add(Quad<T>* to, Pack<float> const& sums) {
    auto* const at = reinterpret_cast<float*>(to);
    (Pack<float>::load(at) + sums).store(at);
  }
#endif
};
template <class T> struct TileWriter {
  NodeBox box;
  Quad<T>* sums;
  Quad<T>* previous;

  explicit TileWriter(Tile<T>& tile)
      : box(tile.box), sums(tile.sums.data()), previous(tile.previous.data()) {}
  MPMPBD_INLINE auto window(int const (&at)[3]) const {
    return Window{SumRow<T>{sums, previous} + box.index(at[0], at[1], at[2]), box.next_row(),
                  box.next_plane()};
  }
};

// What a gather reads: node velocities (and those before forces), x fastest.
template <class T> struct NodeReader {
  Quad<T> const* nodes;
  Quad<T> const* previous;
  Lattice<T> lattice;
  MPMPBD_INLINE auto window(int const (&at)[3]) const { return window(nodes, at); }
  MPMPBD_INLINE auto previous_window(int const (&at)[3]) const { return window(previous, at); }

 private:
  MPMPBD_INLINE auto window(Quad<T> const* from, int const (&at)[3]) const {
    std::int64_t const next_row = lattice.nodes[0], next_plane = next_row * lattice.nodes[1];
    return Window{from + lattice.index(at[0], at[1], at[2]), next_row, next_plane};
  }
};

// The same grid, for kernels that take two neighbours at a time.
template <class Grid> struct InPairs : Grid { static constexpr bool in_pairs = true; };

// What a coupling reads and changes: nodes by their index in the lattice, and scratch memory.
template <class T, class Move, class Ctx> struct NodeAccess {
  Quad<T>* nodes;
  Ctx const& context;
  void* scratch;

  MPMPBD_HD T mass(int i) const { return nodes[i][3]; }
  MPMPBD_HD Vec3<T> velocity(int i) const { return vector_part(nodes[i]); }
  MPMPBD_HD void set_velocity(int i, Vec3<T> const& v) const { nodes[i] = quad(v, mass(i)); }
  MPMPBD_HD Vec3<T> inverse_mass(int i) const {
    int const row = i / context.lattice.nodes[0];
    auto const x =
        context.lattice.position(i % context.lattice.nodes[0], row % context.lattice.nodes[1],
                                 row / context.lattice.nodes[1]);
    return Move::inverse_mass(velocity(i), mass(i), x, context);
  }
};
// A scene without tissue has no nodes.
struct NoNodes {};

}  // namespace mpmpbd
