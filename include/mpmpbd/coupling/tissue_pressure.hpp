// The tissue's own pressure on thread and needle: tissue that is squeezed grips harder.
//
// p = -(tr sigma - t . sigma t) / 2, the mean over the directions across the tangent t of the Cauchy stress
// around the point. Particles are averaged over the cells they lie in, by volume, and the cells around a
// point by the scene's shape function: a uniform stress is found exactly, whatever the particles' order.
//
// A thread that pushes sideways presses the tissue ahead of it and pulls the tissue behind: the mean of the
// two is what was there without it, so a lateral load is not counted twice.
#pragma once

#include <cstddef>

#include <mpmpbd/coupling/contact_law.hpp>
#include <mpmpbd/coupling/incidence.hpp>
#include <mpmpbd/coupling/weights.hpp>
#include <mpmpbd/coupling/workspace.hpp>
#include <mpmpbd/effects/concepts.hpp>

namespace mpmpbd {

namespace particle {
// Kirchhoff stress as it went to the grid in this substep, with all effects on it: xx yy zz xy yz zx.
struct KeptStress : Field<"tau kept", "Pa", Numbers<6>, Particles> {};
}  // namespace particle

namespace detail {

// A cell near a point of thread or needle, and the tissue in it.
template <class T> struct TissueCell {
  Vec<T, 6> stress{};        // sum of V0 tau = V sigma [N m]
  T volume{};                // sum of V0 det F [m^3]
  int first = 0, count = 0;  // its particles in `entries`
};

template <class T> struct TissueCells {
  TissueCell<T>* cells;
  int* near;      // particles in any of these cells, in no order
  int* entries;   // the same by cell, then by number
  int* counters;  // particles in {`near`, `entries`}
  NodeSet known;  // the cells, by their lowest nodes

  // Cuts the arrays from `memory` (null: only measures). Returns the bytes used.
  MPMPBD_HD std::size_t cut(void* memory, int cell_capacity, int lattice_nodes, int particles) {
    Cutter cutter{static_cast<char*>(memory)};
    cells = cutter.cut<TissueCell<T>>(cell_capacity);
    near = cutter.cut<int>(particles);
    entries = cutter.cut<int>(particles);
    counters = cutter.cut<int>(2);
    known.cut(cutter, lattice_nodes);
    return cutter.used;
  }
};

// -(tr sigma - t . sigma t) / 2 of a stress sum [N m], with t a unit vector.
template <class T> MPMPBD_HD T pressure_across(Vec<T, 6> const& s, Vec3<T> const& t) {
  T const along = s[0] * t[0] * t[0] + s[1] * t[1] * t[1] + s[2] * t[2] * t[2] +
                  2 * (s[3] * t[0] * t[1] + s[4] * t[1] * t[2] + s[5] * t[2] * t[0]);
  return T(-0.5) * (s[0] + s[1] + s[2] - along);
}

template <class Shape, class Team_, class Env, class X> struct TissueStress {
  using T = typename X::Scalar;
  Team_ const& team;
  Env const& env;
  X const& x;
  TissueCells<T> const& c;

  MPMPBD_HD void run() const {
    team.one([&] {
      c.counters[0] = c.counters[1] = 0;
      c.known.cover(0, static_cast<int>(x.lattice.count()) - 1);
    });
    team.sync();
    c.known.clear(team);
    team.sync();
    team.each(x.count(),
              [&](int q) { for_each_cell(q, [&](int cell, T) { c.known.insert(team, cell); }); });
    team.sync();
    c.known.number(team);
    team.sync();
    team.each(cell_count(), [&](int i) { c.cells[i] = {}; });
    team.sync();
    team.each(static_cast<int>(env.template live<Particles>()), [&](int p) { find_particle(p); });
    team.sync();
    team.each(cell_count(), [&](int i) {
      c.cells[i].first = team.add(c.counters[1], c.cells[i].count);
      c.cells[i].count = 0;
    });
    team.sync();
    team.each(c.counters[0], [&](int n) {
      TissueCell<T>& cell = c.cells[c.known.slot(cell_of(c.near[n]))];
      c.entries[cell.first + team.add(cell.count, 1)] = c.near[n];
    });
    team.sync();
    team.each(cell_count(), [&](int i) { sum_particles(c.cells[i]); });
    team.sync();
    team.each(x.count(), [&](int q) { x.points[q].pressure = pressure_at(q); });
    team.sync();
  }

 private:
  MPMPBD_HD int cell_count() const { return c.known.members(); }
  // Calls f(cell, weight) for the cells around a point, with weights of their centres.
  template <class F> MPMPBD_HD void for_each_cell(int q, F const& f) const {
    T const half = T(0.5) * x.lattice.dx;
    auto const around =
        neighbourhood<Shape>(x.lattice, x.points[q].position - vec(half, half, half));
    if (x.points[q].contact != Contact::member || !around.inside) return;
    for_each_node<Shape>(x.lattice, around,
                         [&](int, int cell, T w, Vec3<T> const&) { f(cell, w); });
  }
  MPMPBD_HD int cell_of(int p) const {
    Vec3<T> const cells = x.lattice.inverse_dx * env.template get<particle::Position>(p);
    return static_cast<int>(x.lattice.index(static_cast<int>(cells[0]), static_cast<int>(cells[1]),
                                            static_cast<int>(cells[2])));
  }
  MPMPBD_HD void find_particle(int p) const {
    int const cell = cell_of(p);
    if (!c.known.contains(cell)) return;
    c.near[team.add(c.counters[0], 1)] = p;
    team.add(c.cells[c.known.slot(cell)].count, 1);
  }
  // In the order of their numbers, so that the sum does not depend on who found them first.
  MPMPBD_HD void sum_particles(TissueCell<T>& cell) const {
    sort_entries<T>(c.entries + cell.first, cell.count);
    for (int e = cell.first; e < cell.first + cell.count; ++e) {
      int const p = c.entries[e];
      T const volume = env.template get<particle::Volume>(p);
      T const J = determinant(env.template get<particle::Deformation>(p));
      cell.stress = add_product(cell.stress, volume, env.template get<particle::KeptStress>(p));
      cell.volume = multiply_add(volume, J, cell.volume);
    }
  }
  MPMPBD_HD T pressure_at(int q) const {
    Vec<T, 6> stress{};
    T volume = T(0);
    for_each_cell(q, [&](int cell, T w) {
      TissueCell<T> const& tissue = c.cells[c.known.slot(cell)];
      stress = add_product(stress, w, tissue.stress);
      volume = multiply_add(w, tissue.volume, volume);
    });
    return volume > T(0) ? pressure_across(stress, x.points[q].axis) / volume : T(0);
  }
};

}  // namespace detail

// Clamp pressure of friction: p = max(0, clamp_pressure + pressure of the tissue). Without this policy the
// tissue's own pressure is not looked at.
//
// Limits: an explicit pressure, that of the stress at the start of the substep, averaged over about two
// cells; tissue squeezed over less than that is not resolved.
struct TissuePressure {
  static constexpr FixedString name = "tissue pressure";
  static constexpr bool squeezes = true;

  // Particles forget their stress once it has gone to the grid; here they keep it until contact has read it.
  struct Keep {
    using Role = role::Effect;
    using ParametersOf = TissuePressure;
    static constexpr FixedString name = "kept stress";
    static constexpr Slot slot = Slot::before_scatter;
    static constexpr bool branch_free = true;
    using Reads = Fields<particle::Stress>;
    using Writes = Fields<particle::KeptStress>;

    template <class Item, class K, class T>
    MPMPBD_HD static void apply(Item& p, K const&, Tick<T> const&) {
      auto const& tau = p[particle::Stress{}];
      p[particle::KeptStress{}] = {
          {tau(0, 0), tau(1, 1), tau(2, 2), tau(0, 1), tau(1, 2), tau(2, 0)}};
    }
  };
  using Effects = TypeList<Keep>;
  using Reads =
      Fields<particle::Position, particle::Volume, particle::Deformation, particle::KeptStress>;

  // Bytes of work memory for an environment with so many points, nodes and particles.
  template <class T, class Shape>
  MPMPBD_HD static std::size_t bytes(int points, int lattice_nodes, std::int64_t particles) {
    detail::TissueCells<T> c;
    return c.cut(nullptr, points * nodes_per_point<Shape>, lattice_nodes,
                 static_cast<int>(particles));
  }
  // Writes the pressure [Pa] at every point, 0 at those that are no members. Positions, axes and contacts
  // are known.
  template <class Shape, class Team_, class Env, class X>
  MPMPBD_HD static void gather(Team_ const& team, Env const& env, X const& x, void* memory) {
    detail::TissueCells<typename X::Scalar> c;
    c.cut(memory, x.count() * nodes_per_point<Shape>, static_cast<int>(x.lattice.count()),
          static_cast<int>(env.template live<Particles>()));
    detail::TissueStress<Shape, Team_, Env, X>{team, env, x, c}.run();
  }
};

}  // namespace mpmpbd
