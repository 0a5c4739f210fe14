// Coupling<Strategy, laws...>: how tissue, threads and needle act on each other.
#pragma once

#include <cstddef>
#include <cstdint>

#include <mpmpbd/core/parameters.hpp>
#include <mpmpbd/core/role.hpp>
#include <mpmpbd/coupling/drag.hpp>
#include <mpmpbd/coupling/friction.hpp>

namespace mpmpbd {

namespace detail {
template <class L> inline constexpr bool is_friction = requires { L::grips; };
template <class L> inline constexpr bool is_drag = requires { L::drags; };
template <class L> inline constexpr bool is_pressure = requires { L::squeezes; };

template <class List> struct FrictionIn { using type = NoFriction; };
template <class L, class... Ls>
struct FrictionIn<TypeList<L, Ls...>>
    : std::conditional_t<is_friction<L>, std::type_identity<L>, FrictionIn<TypeList<Ls...>>> {};
template <class List> struct DragIn { using type = NoDrag; };
template <class L, class... Ls>
struct DragIn<TypeList<L, Ls...>>
    : std::conditional_t<is_drag<L>, std::type_identity<L>, DragIn<TypeList<Ls...>>> {};

// Where no law of pressure is named: nothing is kept, read or computed.
struct NoPressure {
  static constexpr bool squeezes = false;
  using Effects = TypeList<>;
  using Reads = Fields<>;
  template <class T, class Shape> MPMPBD_HD static std::size_t bytes(int, int, std::int64_t) {
    return 0;
  }
  template <class Shape, class Team_, class Env, class X>
  MPMPBD_HD static void gather(Team_ const&, Env const&, X const&, void*) {}
};
template <class List> struct PressureIn { using type = NoPressure; };
template <class L, class... Ls>
struct PressureIn<TypeList<L, Ls...>>
    : std::conditional_t<is_pressure<L>, std::type_identity<L>, PressureIn<TypeList<Ls...>>> {};
}  // namespace detail

// What a strategy promises to conserve; the claim selects the laws that it must pass.
enum class Conserves { momentum, momentum_and_angular, none };

// A strategy names itself, lists the constraints it solves itself (`Takes`), what it conserves, and gives
// `Stages<Parts>`: the stages that stand between the grid and the gather.
template <class S> concept CouplingStrategy = requires {
  { S::name.view() } -> std::convertible_to<std::string_view>;
  typename S::Takes;
  { S::conserves } -> std::convertible_to<Conserves>;
};

template <class Strategy_, class... Laws> struct Coupling {
  using Role = role::Coupling;
  using Strategy = Strategy_;
  using FrictionLaw = typename detail::FrictionIn<TypeList<Laws...>>::type;
  using DragLaw = typename detail::DragIn<TypeList<Laws...>>::type;
  using PressureLaw = typename detail::PressureIn<TypeList<Laws...>>::type;
  using Leaves =
      join_t<TypeList<Strategy, FrictionLaw, DragLaw>,
             std::conditional_t<PressureLaw::squeezes, TypeList<PressureLaw>, TypeList<>>>;
  using Effects = typename PressureLaw::Effects;  // what the laws ask of the tissue

  static_assert(
      CouplingStrategy<Strategy>,
      "mpmpbd Coupling<Strategy, ...>: a strategy gives a name, `using Takes = TypeList<...>` of the "
      "constraints it solves itself, `static constexpr Conserves conserves` and `Stages<Parts>`; "
      "write for example Coupling<Embedded, Friction>");
  static_assert(
      ((detail::is_friction<Laws> || detail::is_drag<Laws> || detail::is_pressure<Laws>)&&... &&
       true),
      "mpmpbd Coupling<Strategy, laws...>: a law is a friction (grips), a drag (drags) or a pressure "
      "(squeezes), for example Coupling<Embedded, Friction, Drag, TissuePressure>");
  static_assert(
      (int(detail::is_friction<Laws>) + ... + 0) < 2 &&
          (int(detail::is_drag<Laws>) + ... + 0) < 2 &&
          (int(detail::is_pressure<Laws>) + ... + 0) < 2,
      "mpmpbd Coupling<Strategy, laws...>: two laws of the same kind given; keep one friction, one "
      "drag and one pressure");
  static_assert(
      FrictionLaw::grips || !PressureLaw::squeezes,
      "mpmpbd Coupling<Strategy, laws...>: a pressure given but no friction that it could "
      "add to; add Friction, or take TissuePressure out");
};

}  // namespace mpmpbd
