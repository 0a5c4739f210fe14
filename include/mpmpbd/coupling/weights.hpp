// Where a point of a needle or thread sits in the grid: its nodes and weights.
#pragma once

#include <mpmpbd/mpm/lattice.hpp>

namespace mpmpbd {

// Nodes of one point, a fixed number each.
template <class Shape>
inline constexpr int nodes_per_point = Shape::width* Shape::width* Shape::width;

namespace detail {

// The first node of a point along each axis, and its distance from there [cells].
template <class T> struct Neighbourhood {
  int base[3];
  T f[3];
  bool inside;  // all its nodes exist
};
template <class Shape, class T>
MPMPBD_HD Neighbourhood<T> neighbourhood(Lattice<T> const& lattice, Vec3<T> const& x) {
  Neighbourhood<T> s{{}, {}, is_finite(x)};
  for (int a = 0; a < 3 && s.inside; ++a) {
    auto const along = on_axis<Shape>(x[a], lattice.inverse_dx);
    s.f[a] = along.distance;
    s.inside = along.first >= T(0) && along.first <= T(lattice.nodes[a] - Shape::width);
    if (s.inside) s.base[a] = static_cast<int>(along.first);
  }
  return s;
}

// Calls f(a, node, weight, d) for every node of a point in a fixed order; d = x_i - x in cells. A device has arrays that
// f indexes by a in registers, and the loads of all nodes on their way.
template <class Shape, class T, class F>
MPMPBD_INLINE void for_each_node(Lattice<T> const& lattice, Neighbourhood<T> const& s, F const& f) {
  T weight[3][Shape::width];
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < Shape::width; ++i) weight[axis][i] = Shape::weight(i, s.f[axis]);
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int k = 0; k < Shape::width; ++k)
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
    for (int j = 0; j < Shape::width; ++j) {
      int const row = static_cast<int>(lattice.index(s.base[0], s.base[1] + j, s.base[2] + k));
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
      for (int i = 0; i < Shape::width; ++i)
        f((k * Shape::width + j) * Shape::width + i, row + i,
          weight[0][i] * weight[1][j] * weight[2][k],
          vec(T(i) - s.f[0], T(j) - s.f[1], T(k) - s.f[2]));
    }
}

// What the nodes with mass around a point amount to. The corrected weight of a node at a distance d [cells] is
// w m (1 - slope . d) / (rest mass).
template <class T> struct Surroundings {
  T mass;  // sum w m; 0 where such a correction does not exist
  Vec3<T> slope;
  T rest;
};
// Calls note(a, node, w m, d) for every node.
template <class Shape, class T, class Nodes, class Note>
MPMPBD_INLINE Surroundings<T> surroundings(Lattice<T> const& lattice, Neighbourhood<T> const& near,
                                           Nodes const& nodes, Note const& note) {
  Surroundings<T> const none{};
  if (!near.inside) return none;
  T total = T(0);
  Vec3<T> first{};     // M1 = sum w d
  T xx{}, xy{}, xz{};  // M2 = sum w d d^T
  T yy{}, yz{}, zz{};
  for_each_node<Shape>(lattice, near, [&](int a, int i, T w, Vec3<T> const& d) {
    T const wm = w * nodes.mass(i);
    total += wm;
    note(a, i, wm, d);
    first = add_product(first, wm, d);
    auto const with = [&](T sum, int p, int q) { return multiply_add(wm, d[p] * d[q], sum); };
    xx = with(xx, 0, 0), xy = with(xy, 0, 1), xz = with(xz, 0, 2);
    yy = with(yy, 1, 1), yz = with(yz, 1, 2), zz = with(zz, 2, 2);
  });
  if (!(total > T(0))) return none;
  first *= T(1) / total;
  Mat3<T> const second = T(1) / total * Mat3<T>{{xx, xy, xz, xy, yy, yz, xz, yz, zz}};
  T const third = trace(second) / 3;
  if (!(determinant(second) > T(1e-6) * third * third * third)) return none;
  Vec3<T> const z = inverse(second) * first;
  T const rest = 1 - dot(first, z);
  if (!(rest >= T(0.125))) return none;
  return {total, z, rest};
}

}  // namespace detail

// Weights of a point over the nodes that have mass, corrected so that they sum to one and reproduce
// linear fields there too: impulse and moment of a point then reach the grid whole, even where the point
// is near a free surface and some of its nodes are empty. Into arrays of nodes_per_point<Shape>.
//
// Returns sum w m of the plain weights. It is 0, and the point unusable, when the nodes with mass lie in
// one plane, or all on one side so that the correction would exceed 8: on a flat surface from 0.47 cells above it,
// just before Grip::at_all lets go (0.515). The arrays are left alone then.
template <class Shape, class T, class Nodes>
MPMPBD_HD T embedding_weights(Lattice<T> const& lattice, Vec3<T> const& x, Nodes const& nodes,
                              T* weight, int* node) {
  auto const near = detail::neighbourhood<Shape>(lattice, x);
  T plain[nodes_per_point<Shape>];
  auto const s = detail::surroundings<Shape>(
      lattice, near, nodes, [&](int a, int, T wm, Vec3<T> const&) { plain[a] = wm; });
  if (!(s.mass > T(0))) return T(0);
  T const share = T(1) / (s.rest * s.mass);
  detail::for_each_node<Shape>(lattice, near, [&](int a, int i, T, Vec3<T> const& d) {
    weight[a] = plain[a] * (share * (1 - dot(s.slope, d)));
    node[a] = i;
  });
  return s.mass;
}
// The mean of f(node) with these weights, in one visit of the nodes; what f is where there is no mass has no part in it.
template <class T> struct EmbeddedMean {
  Vec3<T> value;  // [unit of f]
  T mass;         // sum w m [kg]; 0, and there is no mean, where the point is unusable
};
template <class Shape, class T, class Nodes, class F>
MPMPBD_HD EmbeddedMean<T> embedded_mean(Lattice<T> const& lattice, Vec3<T> const& x,
                                        Nodes const& nodes, F const& f) {
  auto const near = detail::neighbourhood<Shape>(lattice, x);
  Vec3<T> sum{}, moment[3]{};  // sum w m f, sum w m f d
  auto const s =
      detail::surroundings<Shape>(lattice, near, nodes, [&](int, int i, T wm, Vec3<T> const& d) {
        Vec3<T> const value = f(i), part = wm != T(0) ? wm * value : Vec3<T>{};
        sum += part;
        for (int c = 0; c < 3; ++c) moment[c] = add_product(moment[c], d[c], part);
      });
  if (!(s.mass > T(0))) return {};
  for (int c = 0; c < 3; ++c) sum = add_product(sum, -s.slope[c], moment[c]);
  return {T(1) / (s.rest * s.mass) * sum, s.mass};
}
// Sum w m of the plain weights around a point; 0 where it is unusable.
template <class Shape, class T, class Nodes>
MPMPBD_HD T mass_around(Lattice<T> const& lattice, Vec3<T> const& x, Nodes const& nodes) {
  auto const near = detail::neighbourhood<Shape>(lattice, x);
  return detail::surroundings<Shape>(lattice, near, nodes, [](int, int, T, Vec3<T> const&) {}).mass;
}

}  // namespace mpmpbd
