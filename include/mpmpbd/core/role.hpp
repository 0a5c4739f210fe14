// Roles: every policy says what it is, so that a scene can be composed in any order.
#pragma once

#include <concepts>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include <mpmpbd/core/field.hpp>

namespace mpmpbd {

namespace role {
struct Material {
  static constexpr FixedString name = "MaterialModel";
};
struct Shape {
  static constexpr FixedString name = "ShapeFunction";
};
struct Transfer {
  static constexpr FixedString name = "TransferScheme";
};
struct Form {
  static constexpr FixedString name = "ForceForm";
};
struct Constraint {
  static constexpr FixedString name = "Constraint";
};
struct ConstraintSet {
  static constexpr FixedString name = "ConstraintSet";
};
struct Solver {
  static constexpr FixedString name = "SolverPolicy";
};
struct Coupling {
  static constexpr FixedString name = "CouplingStrategy";
};
struct Effect {
  static constexpr FixedString name = "Effect";
};
struct Mpm {
  static constexpr FixedString name = "Mpm";
};
struct Pbd {
  static constexpr FixedString name = "Pbd";
};
struct Needle {
  static constexpr FixedString name = "Needle";
};
struct Surface {
  static constexpr FixedString name = "Surface";
};
}  // namespace role

template <class P, class R> concept HasRole = std::same_as<typename P::Role, R>;

template <class... Ts> struct TypeList { static constexpr int size = sizeof...(Ts); };

namespace detail {
template <class... Lists> struct Joined { using type = TypeList<>; };
template <class... As> struct Joined<TypeList<As...>> { using type = TypeList<As...>; };
template <class... As, class... Bs, class... Lists>
struct Joined<TypeList<As...>, TypeList<Bs...>, Lists...>
    : Joined<TypeList<As..., Bs...>, Lists...> {};

template <class Role, class... Ps>
inline constexpr int count_role = (int(std::is_same_v<typename Ps::Role, Role>) + ... + 0);

template <class Role, class... Ps> struct OfRole { using type = TypeList<>; };
template <class Role, class P, class... Ps>
struct OfRole<Role, P, Ps...>
    : Joined<std::conditional_t<std::is_same_v<typename P::Role, Role>, TypeList<P>, TypeList<>>,
             typename OfRole<Role, Ps...>::type> {};

template <class List, class Default> struct FirstOr { using type = Default; };
template <class P, class... Ps, class Default> struct FirstOr<TypeList<P, Ps...>, Default> {
  using type = P;
};
}  // namespace detail

namespace detail {
struct Absent {};  // stands where a scene names nothing
template <class T> inline constexpr bool present = !std::is_same_v<T, Absent>;
}  // namespace detail

// One list after another.
template <class... Lists> using join_t = typename detail::Joined<Lists...>::type;
// The policies of a role, in the order in which they were written.
template <class Role, class... Ps> using of_role_t = typename detail::OfRole<Role, Ps...>::type;
// The first policy of a role, or the default when none was written.
template <class Role, class Default, class... Ps>
using pick_t = typename detail::FirstOr<of_role_t<Role, Ps...>, Default>::type;

template <class... Ts, class Function> constexpr void for_each_type(TypeList<Ts...>, Function&& f) {
  (f(std::type_identity<Ts>{}), ...);
}

}  // namespace mpmpbd
