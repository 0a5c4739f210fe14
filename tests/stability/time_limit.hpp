// B2: the library's limit of the step against the true one of a lattice of particles, from how its tiny
// random motions grow.
#pragma once

#include <vector>

#include <mpmpbd/mpm/materials/neo_hookean.hpp>

#include "catch.hpp"
#include "stability/block.hpp"

namespace test {

template <class... Policies> struct Unheld : Scene<Mpm<NeoHookean, Policies...>> {};

struct Filling {
  int per_axis;
  double offset;  // of the first particle from a node [cells]
  int wide = 0;   // cells; 0: enough of them
};

// For shapes whose stiffness hardly depends on the place.
inline std::vector<Filling> smooth_fillings() {
  return {{1, 0.0}, {1, 0.5}, {1, 0.3}, {2, 0.25}, {2, 0.07}, {3, 0.1}, {4, 0.125}};
}

inline BlockCase lattice_block(Filling const& l) {
  int const wide = l.wide > 0 ? l.wide : l.per_axis == 1 ? 5 : l.per_axis == 4 ? 2 : 3;
  double const low = 4 + l.offset - 0.5 / l.per_axis;
  return {.low = vec(low, low, low),
          .cells = {{wide, wide, wide}},
          .nodes = {{wide + 8, wide + 8, wide + 8}},
          .per_axis = l.per_axis};
}

template <class S> double largest_strain(Block<S> const& block) {
  double most = 0;
  for (std::int64_t p = 0; p < block.size(); ++p)
    most = max(most, norm(block.template get<particle::Deformation>(p) - Mat3<double>::identity()));
  return most;
}

// Whether strains of 1e-9 become 1e-5 within 400 steps of h. The state is so small that a step is linear:
// this is the largest eigenvalue of the step, found by its own powers.
template <class S> bool grows(BlockCase const& c, Lame<double> const& k, double h) {
  Block<S> block(c, k);
  testing::Samples random(11);
  for (std::int64_t p = 0; p < block.size(); ++p) {
    block.template set<particle::Velocity>(p, c.cell / h * random.matrix<3>(-1e-9, 1e-9));
    block.template set<particle::Deformation>(
        p, Mat3<double>::identity() + random.matrix<3, 3>(-1e-9, 1e-9));
  }
  for (int s = 1; s <= 400; ++s) {
    block.run.step(h);
    if (s % 8 == 0 && !(largest_strain(block) < 1e-5)) return true;
  }
  return false;
}

// The true limit of a lattice over the library's.
template <class S> double true_limit(Filling const& l, double nu) {
  auto const c = lattice_block(l);
  auto const k = lame(5e4, nu);
  double const library = Block<S>(c, k).limit();
  double stable = 0.98, unstable = 4;
  if (grows<S>(c, k, stable * library)) return 0;
  while (unstable / stable > 1.01) {
    double const middle = mpmpbd::sqrt(stable * unstable);
    (grows<S>(c, k, middle * library) ? unstable : stable) = middle;
  }
  return unstable;
}

// Twice the library's value is beyond the true one: at least half of it is given.
template <class S> void check_lattices(std::vector<Filling> const& fillings) {
  for (double const nu : {0.0, 0.4})
    for (auto const& l : fillings) {
      double const limit = true_limit<S>(l, nu);
      CAPTURE(nu, l.per_axis, l.offset, limit);
      CHECK(limit >= 1);
      CHECK(limit <= 2);
    }
}

}  // namespace test
