// Effects: what a scene adds to the equations, each in a named slot of the substep.
#pragma once

#include <mpmpbd/core/local.hpp>
#include <mpmpbd/core/parameters.hpp>
#include <mpmpbd/core/role.hpp>
#include <mpmpbd/core/tick.hpp>
#include <mpmpbd/mpm/concepts.hpp>

namespace mpmpbd {

// Where in the substep an effect acts, and on what: particles, grid nodes or thread beads.
enum class Slot {
  before_scatter,  // a particle, after its stress is known
  on_grid,         // a node: forces, as velocity changes
  at_boundary,     // a node, after all forces: walls and pinned regions
  after_gather,    // a particle, after x and F are new
  before_solve,    // a bead: forces, as velocity changes
  on_needle,       // a needle that moves freely: forces, as velocity changes
  after_solve,     // a bead; may read but not move it
};

// An effect that acts on grid, beads and needle alike (gravity) names its other parts: `OnBeads`, an effect of
// slot before_solve, and `OnNeedle`, one of slot on_needle; both declare `using ParametersOf = TheEffect`.
namespace detail {
template <class E> struct ParameterOwner { using type = E; };
template <class E>
  requires requires { typename E::ParametersOf; }
struct ParameterOwner<E> {
  using type = typename E::ParametersOf;
};
}  // namespace detail
// Whose parameters an effect is given.
template <class E> using parameter_owner_t = typename detail::ParameterOwner<E>::type;

// `apply(item, k, tick)` acts on one item; the item holds exactly the declared fields.
template <class E>
concept Effect = HasRole<E, role::Effect> && HasName<E> && DeclaresFields<E> && requires {
  { E::slot } -> std::convertible_to<Slot>;
} && requires(detail::Archetype<E>& item, parameters_t<parameter_owner_t<E>, float> const& k,
              Tick<float> const& tick) {
  E::apply(item, k, tick);
};

namespace detail {
// Never called. Its address makes the compiler look into the body of apply, where a field that is not
// declared is refused: a concept sees the signature only.
template <class E>
void apply_to_archetype(Archetype<E>& item, parameters_t<parameter_owner_t<E>, float> const& k,
                        Tick<float> const& tick) {
  E::apply(item, k, tick);
}
}  // namespace detail

template <class E> consteval bool check_effect() {
  static_assert(HasName<E>,
                "mpmpbd Effect: give it a name: `static constexpr FixedString name = \"...\";`");
  static_assert(
      DeclaresFields<E>,
      "mpmpbd Effect: say what it reads and writes: `using Reads = Fields<...>; using Writes = Fields<...>;`");
  static_assert(
      requires {
        { E::slot } -> std::convertible_to<Slot>;
      },
      "mpmpbd Effect: say where it acts: `static constexpr Slot slot = Slot::on_grid;`");
  static_assert(
      Effect<E>,
      "mpmpbd Effect: give `template <class Item, class K, class T> MPMPBD_HD static void apply(Item& item, K const& k, Tick<T> const& tick)`, using only declared fields");
  if constexpr (Effect<E>) {
    static_assert(
        E::slot == Slot::before_scatter || !contains<typename E::Writes, particle::Acceleration>,
        "mpmpbd Effect: particle::Acceleration goes to the grid with the scatter, and is lost in any "
        "other slot; write `static constexpr Slot slot = Slot::before_scatter;`");
    [[maybe_unused]] constexpr auto look_inside = &detail::apply_to_archetype<E>;
  }
  return Effect<E>;
}

// Takes one axis of a node out of the motion: its velocity is zero there, and contact feels no mass
// that it could move. Shared by walls and pinned regions.
template <class Node> MPMPBD_HD void hold_axis(Node& n, int axis) {
  using T = typename Node::Scalar;
  n[node::Velocity{}][axis] = T(0);
  if constexpr (contains<typename Node::List, node::InverseMass>)
    n[node::InverseMass{}][axis] = T(0);
}

}  // namespace mpmpbd
