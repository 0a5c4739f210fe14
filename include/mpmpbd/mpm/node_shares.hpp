// How stiffly particles of a linear shape feel the grid: from where they are, because over the cell it has no bound.
//
// Close to a node the weight of the node beyond falls to zero and its slope does not, so how heavy that node is hangs
// on who else is there. Let theta_ip be the part of node i's mass m_i that is counted as particle p's, sum_p theta_ip = 1,
// and g its weight's gradient there. No motion is faster than that of the stiffest particle on its parts of nodes (Irons
// and Fried): omega^2 <= k V_p |sum_i g g^T / (theta_ip m_i)|. With theta_ip = z_p V_p |g_ip| / s_i, s_i = sum_q z_q V_q |g_iq|,
// that is k |sum_i (s_i / m_i) g g^T / |g|| / z_p, for any z > 0: exact for a lone particle. z = 1 first, and then what
// that gives (a power iteration, Collatz and Wielandt).
#pragma once

#include <vector>

#include <mpmpbd/core/quad.hpp>
#include <mpmpbd/mpm/concepts.hpp>
#include <mpmpbd/mpm/lattice.hpp>

namespace mpmpbd {

template <class Shape, class T> class NodeShares {
 public:
  using Reads = Fields<particle::Position, particle::Mass, particle::Volume>;

  // `nodes` is scratch memory: s for z = 1, s for the next z, nothing, m.
  NodeShares(Lattice<T> const& lattice, std::vector<Quad<T>>& nodes)
      : lattice_(lattice), nodes_(nodes) {
    nodes.assign(static_cast<std::size_t>(lattice.count()), quad<T>(0, 0, 0, 0));
  }

  // First for every particle, then the second for every particle, then they may be asked for.
  template <class P> void add(P const& p) {
    for_each_node(p[particle::Position{}], [&](auto& node, T weight, Vec3<T> const& slope) {
      node =
          node + quad<T>(p[particle::Volume{}] * norm(slope), 0, 0, p[particle::Mass{}] * weight);
    });
  }
  template <class P> void refine(P const& p) {
    T const scale = p[particle::Volume{}] * first(p);
    for_each_node(p[particle::Position{}], [&](auto& node, T, Vec3<T> const& slope) {
      node = node + quad<T>(0, scale * norm(slope), 0, 0);
    });
  }
  // rho0 dx^2 |sum_i (s_i / m_i) g g^T / |g|| / z_p.
  template <class P> T stiffness(P const& p) const {
    T const z = first(p);
    return z > T(0) ? p[particle::Mass{}] / p[particle::Volume{}] * on_shares<1>(p) / z : T(0);
  }

 private:
  template <class P> T first(P const& p) const { return on_shares<0>(p); }
  template <int which, class P> T on_shares(P const& p) const {
    Mat3<T> sum{};
    for_each_node(p[particle::Position{}], [&](auto const& node, T, Vec3<T> const& slope) {
      T const size = norm(slope);
      if (node[3] > T(0) && size > T(0))
        sum += (node[which] / (node[3] * size)) * outer(slope, slope);
    });
    T most = T(0);  // rows bound the eigenvalues
    for (int a = 0; a < 3; ++a) most = max(most, abs(sum(a, 0)) + abs(sum(a, 1)) + abs(sum(a, 2)));
    return most;
  }
  // Calls with a node, and the particle's weight and its slope [1/cells] there. Nobody has a node outside.
  template <class Function> void for_each_node(Vec3<T> const& x, Function&& f) const {
    for (int a = 0; a < 3; ++a)
      if (!(x[a] >= T(0) && x[a] * lattice_.inverse_dx < T(lattice_.nodes[a]))) return;
    auto const s = Stencil<T, Shape>::at(lattice_, x);
    if (!s.inside(lattice_)) return;
    auto const w = [&](int i, int a) { return Shape::weight(i, s.f[a]); };
    auto const d = [&](int i, int a) { return Shape::slope(i, s.f[a]); };
    for (int k = 0; k < Shape::width; ++k)
      for (int j = 0; j < Shape::width; ++j)
        for (int i = 0; i < Shape::width; ++i)
          f(nodes_[static_cast<std::size_t>(
                lattice_.index(s.base[0] + i, s.base[1] + j, s.base[2] + k))],
            w(i, 0) * w(j, 1) * w(k, 2),
            vec(d(i, 0) * w(j, 1) * w(k, 2), w(i, 0) * d(j, 1) * w(k, 2),
                w(i, 0) * w(j, 1) * d(k, 2)));
  }

  Lattice<T> const& lattice_;
  std::vector<Quad<T>>& nodes_;
};

}  // namespace mpmpbd
