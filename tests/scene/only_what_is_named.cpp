// A scene stores and runs what it names, and nothing else.
#include <mpmpbd/effects/body_force.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/flip.hpp>
#include <mpmpbd/mpm/transfer/pic.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include <type_traits>

#include "catch.hpp"

using namespace mpmpbd;

namespace {

template <class... Parts> using Of = Scene<Parts...>;
template <class... Policies> using Body = Mpm<NeoHookean, Policies...>;
template <class S> using ParticleFields = on_t<typename S::StateFields, Particles>;
template <class A, class B> inline constexpr bool same = std::is_same_v<A, B>;

// The same fields, in any order.
template <class A, class... Fs>
inline constexpr bool holds_exactly = A::count == sizeof...(Fs) && (contains<A, Fs> && ...);

using namespace particle;

// Particles: position, velocity, mass, volume and F; C only where the transfer carries it.
static_assert(
    holds_exactly<ParticleFields<Of<Body<Pic>>>, Position, Velocity, Mass, Volume, Deformation>);
static_assert(
    holds_exactly<ParticleFields<Of<Body<Flip>>>, Position, Velocity, Mass, Volume, Deformation>);
static_assert(holds_exactly<ParticleFields<Of<Body<Apic>>>, Position, Velocity, Mass, Volume,
                            Deformation, Affine>);
static_assert(holds_exactly<ParticleFields<Of<Body<Tpic>>>, Position, Velocity, Mass, Volume,
                            Deformation, Affine>);
// Stress and velocity gradient live in registers.
static_assert(!contains<typename Of<Body<>>::StateFields, Stress>);
static_assert(!contains<typename Of<Body<>>::StateFields, Gradient>);
// A force on particles is stored, and given to the grid, where a scene names it.
static_assert(holds_exactly<ParticleFields<Of<Body<Pic>, mpmpbd::BodyForce>>, Position, Velocity,
                            Mass, Volume, Deformation, particle::BodyForce>);
template <class S> using Scatters = ParticlesToGrid<typename S::Body, typename S::Effects>;
static_assert(Scatters<Of<Body<>, mpmpbd::BodyForce>>::driven);
static_assert(!Scatters<Of<Body<>, Gravity>>::driven);
static_assert(!contains<typename Scatters<Of<Body<>, Gravity>>::Writes, Acceleration>);

// The grid keeps what was before the forces only for FLIP.
template <class S>
inline constexpr bool keeps_previous = contains<typename S::NodeFields, node::PreviousVelocity>;
static_assert(keeps_previous<Of<Body<Flip>>>);
static_assert(!keeps_previous<Of<Body<Pic>>>);
static_assert(!keeps_previous<Of<Body<Apic>, Gravity>>);
static_assert(!keeps_previous<Of<Body<Tpic>>>);
template <class S> using Scratch = Workspace<float, typename S::NodeFields>;
static_assert(sizeof(Scratch<Of<Body<Apic>>>) < sizeof(Scratch<Of<Body<Flip>>>));
// The grid is never state.
static_assert(on_t<typename Of<Body<Flip>, Gravity>::StateFields, Nodes>::count == 0);

// Parameters of named policies only: the material, and of the transfers FLIP.
template <class S, class P>
inline constexpr bool has_numbers_of = contains<typename S::StateFields, ParametersField<P>>;
static_assert(has_numbers_of<Of<Body<>>, NeoHookean>);
static_assert(!has_numbers_of<Of<Body<>>, Gravity>);
static_assert(has_numbers_of<Of<Body<>, Gravity>, Gravity>);
static_assert(has_numbers_of<Of<Body<Flip>>, Flip>);
static_assert(!has_numbers_of<Of<Body<Apic>>, Flip>);

// An environment: its own fields, and the parameters that the scene has.
using NoEffect = on_t<typename Of<Body<>>::StateFields, Environments>;
using Falls = on_t<typename Of<Body<>, Gravity>::StateFields, Environments>;
static_assert(NoEffect::count == EnvironmentFields::count + 1);
static_assert(Falls::count == NoEffect::count + 1);

// A body needs three stages, and an effect rides in one of them.
static_assert(Of<Body<>>::Substep::Stages::size == 3);
using Floor = Wall<Slip, 2, Side::low>;
static_assert(Of<Body<>, Gravity, Floor>::Substep::Stages::size == 3);
// The order in which parts are written does not matter to what is stored.
static_assert(same<typename Of<Gravity, Body<>>::Substep, typename Of<Body<>, Gravity>::Substep>);
// Only computed where it is used: a gradient by moments, by slopes, or both.
static_assert(!Body<Apic, Mls>::needs_slope);
static_assert(!Body<Tpic, WeightGradient>::needs_moment);
static_assert(Body<Apic, WeightGradient>::needs_slope && Body<Apic, WeightGradient>::needs_moment);

}  // namespace

TEST_CASE("A particle and an environment cost what their scene names") {
  using Minimal = State<float, typename Of<Body<Pic>>::StateFields>;
  using Affine_ = State<float, typename Of<Body<Apic>>::StateFields>;
  // x, v, m, V0, F: 3 + 3 + 1 + 1 + 9 numbers; C: 9 more.
  CHECK(std::remove_cvref_t<decltype(Minimal(1).table<Particles>())>::bytes_per_item == 17 * 4);
  CHECK(std::remove_cvref_t<decltype(Affine_(1).table<Particles>())>::bytes_per_item == 26 * 4);
}
