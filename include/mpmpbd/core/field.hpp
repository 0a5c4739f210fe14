// A field is a type: what it is called, its unit, the shape of its value and the things it lives on.
//
// Policies declare the fields they read and write; what a scene stores is the union of these lists,
// and nothing else. Names ride by inheritance (struct Position : Field<"x", ...>), because a string
// template argument must not reach a kernel's symbol.
#pragma once

#include <cstdint>
#include <type_traits>

#include <mpmpbd/core/fixed_string.hpp>
#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd {

// Shapes: the value of a field for a scalar type T, and how many components it has.
struct Number {
  template <class T> using Value = T;
  template <class T> using Element = T;
  static constexpr int components = 1;
};
template <int Rows, int Columns = 1> struct Numbers {
  template <class T> using Value = Mat<T, Rows, Columns>;
  template <class T> using Element = T;
  static constexpr int components = Rows * Columns;
};
using Vector = Numbers<3>;
using Matrix = Numbers<3, 3>;
// Counters, indices, flags: 64 bits for every scalar type, so they neither round nor overflow.
struct Integer {
  template <class T> using Value = std::int64_t;
  template <class T> using Element = std::int64_t;
  static constexpr int components = 1;
};

template <int Rows> struct Integers {
  template <class T> using Value = Vec<std::int64_t, Rows>;
  template <class T> using Element = std::int64_t;
  static constexpr int components = Rows;
};

// What a field lives on. Every domain has a capacity per environment; users may add their own. Of one whose first item is looked
// at before it is known how many there are, `fewest_slots` is 1.
struct Particles {
  static constexpr FixedString name = "particle";
  static constexpr std::int64_t fewest_slots = 1;
};
struct Nodes {
  static constexpr FixedString name = "node";
};
struct Environments {
  static constexpr FixedString name = "environment";
};

template <FixedString Name, FixedString Unit, class Shape_, class Domain_> struct Field {
  using Shape = Shape_;
  using Domain = Domain_;
  static constexpr auto name = Name;
  static constexpr auto unit = Unit;
  static constexpr int components = Shape::components;
  static constexpr bool stored = true;
};
// A field that lives only between two stages of one substep: in registers, never in memory.
template <FixedString Name, FixedString Unit, class Shape, class Domain>
struct Transient : Field<Name, Unit, Shape, Domain> {
  static constexpr bool stored = false;
};

template <class F, class T> using value_t = typename F::Shape::template Value<T>;
template <class F, class T> using element_t = typename F::Shape::template Element<T>;

template <class... Fs> struct Fields { static constexpr int count = sizeof...(Fs); };

namespace detail {
template <class Out, class In> struct Union;
template <class... Os> struct Union<Fields<Os...>, Fields<>> { using type = Fields<Os...>; };
template <class... Os, class I, class... Is>
struct Union<Fields<Os...>, Fields<I, Is...>>
    : Union<std::conditional_t<(std::is_same_v<I, Os> || ...), Fields<Os...>, Fields<Os..., I>>,
            Fields<Is...>> {};
template <class... Ls> struct UnionOf { using type = Fields<>; };
template <class L> struct UnionOf<L> { using type = typename Union<Fields<>, L>::type; };
template <class A, class B, class... Ls>
struct UnionOf<A, B, Ls...> : UnionOf<typename Union<typename UnionOf<A>::type, B>::type, Ls...> {};

template <class Out, template <class> class Keep, class In> struct Filter;
template <class Out, template <class> class Keep> struct Filter<Out, Keep, Fields<>> {
  using type = Out;
};
template <class... Os, template <class> class Keep, class I, class... Is>
struct Filter<Fields<Os...>, Keep, Fields<I, Is...>>
    : Filter<std::conditional_t<Keep<I>::value, Fields<Os..., I>, Fields<Os...>>, Keep,
             Fields<Is...>> {};

template <class F> struct IsStored : std::bool_constant<F::stored> {};
template <class D> struct LivesOn {
  template <class F> struct Test : std::is_same<typename F::Domain, D> {};
};
}  // namespace detail

// The union of field lists: each field once, the first mention sets the order.
template <class... Lists> using union_t = typename detail::UnionOf<Lists...>::type;
// The fields of a list that are kept in memory.
template <class List>
using stored_t = typename detail::Filter<Fields<>, detail::IsStored, List>::type;
// The fields of a list that live on a domain.
template <class List, class Domain>
using on_t = typename detail::Filter<Fields<>, detail::LivesOn<Domain>::template Test, List>::type;

template <class List, class F> inline constexpr bool contains = false;
template <class... Fs, class F>
inline constexpr bool contains<Fields<Fs...>, F> = (std::is_same_v<F, Fs> || ...);

namespace detail {
template <class List> struct NotIn {
  template <class F> struct Test : std::bool_constant<!contains<List, F>> {};
};
}  // namespace detail
// The fields of the first list that are not in the second.
template <class List, class Without>
using minus_t =
    typename detail::Filter<Fields<>, detail::NotIn<Without>::template Test, List>::type;

// Calls f(F{}) for every field of a list, in order (host).
template <class... Fs, class Function> constexpr void for_each_field(Fields<Fs...>, Function&& f) {
  (f(Fs{}), ...);
}

// The only message a user sees when a policy touches a field that nobody declared.
template <class F, class List> struct FieldIsNotDeclared {
  static_assert(!std::is_same_v<F, F>,
                "mpmpbd: this policy uses a field that it does not declare; add it to the policy's "
                "`using Reads = Fields<...>` or `using Writes = Fields<...>` (the field and the "
                "declared list are the template arguments of FieldIsNotDeclared)");
};

// Fields of particles (one material point).
namespace particle {
struct Position : Field<"x", "m", Vector, Particles> {};
struct Velocity : Field<"v", "m/s", Vector, Particles> {};
struct Mass : Field<"m", "kg", Number, Particles> {};
struct Volume : Field<"V0", "m^3", Number, Particles> {};       // at rest
struct Affine : Field<"C", "1/s", Matrix, Particles> {};        // affine velocity, APIC and TPIC
struct Deformation : Field<"F", "1", Matrix, Particles> {};     // deformation gradient
struct Fibre : Field<"a0", "1", Vector, Particles> {};          // unit direction at rest
struct BodyForce : Field<"b", "N/kg", Vector, Particles> {};    // force per mass, set by the caller
struct Stress : Transient<"tau", "Pa", Matrix, Particles> {};   // Kirchhoff stress J sigma
struct Gradient : Transient<"L", "1/s", Matrix, Particles> {};  // velocity gradient
struct Acceleration : Transient<"a", "m/s^2", Vector, Particles> {};  // given by effects
}  // namespace particle

// Fields of grid nodes (scratch of one substep, never state).
namespace node {
struct Velocity : Field<"v", "m/s", Vector, Nodes> {};
struct Mass : Field<"m", "kg", Number, Nodes> {};
struct InverseMass : Transient<"1/m", "1/kg", Vector, Nodes> {};  // per axis; 0 where a wall holds
struct PreviousVelocity : Field<"v0", "m/s", Vector, Nodes> {};   // before forces, for FLIP
struct Position : Transient<"x", "m", Vector, Nodes> {};          // from the index
}  // namespace node

}  // namespace mpmpbd
