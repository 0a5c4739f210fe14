// Which nodes the points touch, and which points each of these nodes feels.
//
// A compact copy of the touched nodes keeps the exchange inside fast memory. Each node adds up its points
// in the order of their numbers, so the sums need no atomic floats and give the same bits on any number
// of lanes; integers alone are counted atomically, and their order does not matter.
#pragma once

#include <cstdint>

#include <mpmpbd/core/matrix.hpp>
#include <mpmpbd/core/status.hpp>
#include <mpmpbd/coupling/node_set.hpp>

namespace mpmpbd {

// A touched node: what the exchange needs of it.
template <class T> struct TouchedNode {
  Vec3<T> velocity{};
  Vec3<T> start{};           // its velocity before the exchange
  Vec3<T> change{};          // of velocity, offered by the warm start
  Vec3<T> inverse_mass{};    // per axis; 0 where a wall holds the node
  T free_inverse_mass{};     // 1/m, walls or not
  T split{};                 // sum of firmness |weight| over the points of all bodies
  int index = 0;             // in the lattice
  int first = 0, count = 0;  // its entries in `pairs`
};

// Pair p = point * per_point + a: the a-th node of a point. Capacities are fixed at creation.
template <class T> struct Incidence {
  int node_capacity;
  int point_capacity;
  int per_point;
  NodeSet touched;
  T* weight;   // per pair; a point that is off keeps none
  int* node;   // per pair: lattice node
  int* slot;   // per pair: touched node, -1 for none
  int* pairs;  // pairs sorted by touched node, then by point
  TouchedNode<T>* nodes;
  int* entries;  // of `pairs`, how many there are

  // Of touched nodes.
  MPMPBD_HD int count() const { return touched.members(); }
};

namespace detail {

// From the first node of a point that is on to the last: a point has its nodes in their order.
template <class T, class Team_>
MPMPBD_HD void cover_points(Team_ const& team, Incidence<T> const& c, int points, bool const* on) {
  team.groups(1, [&](auto const& group, int) {
    int low = 1 << 30, beyond = 0;  // further than any node
    group.each(points, [&](int q) {
      if (!on[q]) return;
      low = min(low, c.node[q * c.per_point]);
      beyond = max(beyond, c.node[(q + 1) * c.per_point - 1] + 1);
    });
    low = group.min(low);
    beyond = -group.min(-beyond);
    group.one([&] { c.touched.cover(low, beyond - 1); });
  });
}

// Too many nodes: the points are taken in order, as many as fit; a point that does not fit is off. By one lane.
template <class T> MPMPBD_HD void touch_in_order(Incidence<T> const& c, int points, bool* on) {
  Solo const alone;
  c.touched.clear(alone);
  int used = 0;
  for (int q = 0; q < points; ++q) {
    if (!on[q]) continue;
    int const begin = q * c.per_point, end = begin + c.per_point;
    auto const fresh = [&](int p) { return c.weight[p] != T(0) && !c.touched.contains(c.node[p]); };
    int more = 0;
    for (int p = begin; p < end; ++p) more += fresh(p);
    on[q] = used + more <= c.node_capacity;
    if (!on[q]) continue;
    for (int p = begin; p < end; ++p)
      if (fresh(p)) c.touched.insert(alone, c.node[p]);
    used += more;
  }
}

template <class T> MPMPBD_HD void sort_entries(int* entry, int count) {
  for (int i = 1; i < count; ++i) {
    int const moving = entry[i];
    int k = i;
    for (; k > 0 && entry[k - 1] > moving; --k) entry[k] = entry[k - 1];
    entry[k] = moving;
  }
}

// Numbers the nodes of the points that are on. Returns whether they were too many, and some points switched off.
template <class T, class Team_>
MPMPBD_HD bool touch(Team_ const& team, Incidence<T> const& c, int points, bool* on) {
  cover_points(team, c, points, on);
  team.sync();
  c.touched.clear(team);
  team.sync();
  team.each(points * c.per_point, [&](int p) {
    if (on[p / c.per_point] && c.weight[p] != T(0)) c.touched.insert(team, c.node[p]);
  });
  team.sync();
  c.touched.number(team);
  team.sync();
  bool const overflow = c.touched.members() > c.node_capacity;
  team.sync();
  if (!overflow) return false;
  team.one([&] { touch_in_order(c, points, on); });
  team.sync();
  c.touched.number(team);
  team.sync();
  return true;
}

}  // namespace detail

// Builds the lists from weights and nodes of the points that are on, each as firm as `firmness(q)` in (0, 1] says.
// Returns the faults met: with Fault::overflow some points were switched off.
template <class T, class Team_, class Firmness>
MPMPBD_HD std::uint32_t connect(Team_ const& team, Incidence<T> const& c, int points, bool* on,
                                Firmness const& firmness) {
  bool const overflow = detail::touch(team, c, points, on);
  team.one([&] { *c.entries = 0; });
  c.touched.each_member(team,
                        [&](int slot, int node) { c.nodes[slot] = TouchedNode<T>{.index = node}; });
  team.sync();
  int const all = points * c.per_point;
  team.each(all, [&](int p) {
    bool const used = on[p / c.per_point] && c.weight[p] != T(0);
    c.slot[p] = used ? c.touched.slot(c.node[p]) : -1;
    if (used) team.add(c.nodes[c.slot[p]].count, 1);
  });
  team.sync();
  team.each(c.count(), [&](int i) {
    c.nodes[i].first = team.add(*c.entries, c.nodes[i].count);
    c.nodes[i].count = 0;
  });
  team.sync();
  team.each(all, [&](int p) {
    if (c.slot[p] < 0) return;
    TouchedNode<T>& n = c.nodes[c.slot[p]];
    c.pairs[n.first + team.add(n.count, 1)] = p;
  });
  team.sync();
  team.each(c.count(), [&](int i) {
    TouchedNode<T>& n = c.nodes[i];
    detail::sort_entries<T>(c.pairs + n.first, n.count);
    for (int e = n.first; e < n.first + n.count; ++e)
      n.split =
          multiply_add(firmness(c.pairs[e] / c.per_point), abs(c.weight[c.pairs[e]]), n.split);
  });
  team.sync();
  return overflow ? static_cast<std::uint32_t>(Fault::overflow) : 0u;
}

// sum_q w_iq f(q) over the points of touched node i, in the order of their numbers.
template <class T, class F>
MPMPBD_HD Vec3<T> sum_over_points(Incidence<T> const& c, int i, F const& f) {
  TouchedNode<T> const& n = c.nodes[i];
  Vec3<T> sum{};
  int const first = n.first, end = first + n.count;
#if defined(__CUDA_ARCH__)
#pragma unroll 4
#endif
  for (int e = first; e < end; ++e) {
    int const p = c.pairs[e];
    sum = add_product(sum, c.weight[p], f(p / c.per_point));
  }
  return sum;
}

// A sum over the nodes of point q, which is on: add(sum, w_iq, node i) is the sum with one more. A node is read before it is
// known whether it counts, so that a device has several on their way.
template <class Value, class T, class Add>
MPMPBD_HD Value sum_over_nodes(Incidence<T> const& c, int q, Add const& add) {
  Value sum{};
  int const first = q * c.per_point, end = first + c.per_point;
#if defined(__CUDA_ARCH__)
#pragma unroll 9
#endif
  for (int p = first; p < end; ++p) {
    int const slot = c.slot[p];
    Value const with = add(sum, c.weight[p], c.nodes[max(slot, 0)]);
    if (slot >= 0) sum = with;
  }
  return sum;
}

template <class T> MPMPBD_HD Vec3<T> grid_velocity(Incidence<T> const& c, int q) {
  return sum_over_nodes<Vec3<T>>(c, q, [](Vec3<T> const& sum, T w, TouchedNode<T> const& n) {
    return add_product(sum, w, n.velocity);
  });
}

// Row-sum splitting D_q = sum_i |w_iq| S_i / m_i, to be divided by the firmness of q: no set of points, acting at
// once, can gain energy with it, and a uniform slip of firm points is removed in one sweep. A point that has hardly
// taken hold does not slow down the others. Walls only make it larger than needed. A point whose
// nodes are all held keeps a small D, so that its impulse stays finite.
template <class T> MPMPBD_HD T splitting(Incidence<T> const& c, int q) {
  T const moving = sum_over_nodes<T>(c, q, [](T sum, T w, TouchedNode<T> const& n) {
    T const largest = max(max(n.inverse_mass[0], n.inverse_mass[1]), n.inverse_mass[2]);
    return multiply_add(abs(w) * n.split, largest, sum);
  });
  T const unbound = sum_over_nodes<T>(c, q, [](T sum, T w, TouchedNode<T> const& n) {
    return multiply_add(abs(w) * n.split, n.free_inverse_mass, sum);
  });
  return max(moving, T(0.05) * unbound);
}

}  // namespace mpmpbd
