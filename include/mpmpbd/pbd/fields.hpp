// Fields of a rod: its beads, and the instances of each kind of constraint.
#pragma once

#include <mpmpbd/core/field.hpp>
#include <mpmpbd/pbd/concepts.hpp>

namespace mpmpbd {

// The points of all threads of an environment, numbered along each thread.
struct Beads {
  static constexpr FixedString name = "bead";
};
// The material frames of segments, for constraints that act on them: without such, none is stored.
struct Frames {
  static constexpr FixedString name = "frame";
};
// The instances of one kind of constraint in an environment, ordered by colour.
template <class C> struct Instances {
  using Constraint = C;
  static constexpr auto name = C::name;
};

// A field whose values do not outlive a substep: memory, but no state.
template <FixedString Name, FixedString Unit, class Shape, class Domain>
struct Scratch : Field<Name, Unit, Shape, Domain> {
  static constexpr bool scratch = true;
};

namespace bead {
struct Position : Field<"x", "m", Vector, Beads> {};
struct Velocity : Field<"v", "m/s", Vector, Beads> {};
struct InverseMass : Field<"1/m", "1/kg", Number, Beads> {};  // 0: the bead's motion is prescribed
struct Previous : Scratch<"x0", "m", Vector, Beads> {};       // position before the substep
}  // namespace bead

// A frame turns its axes (d1, d2 across, d3 along the segment) into world axes. Its inertia is the same about
// every axis: that of a segment about its own axis, m r^2 / 2, because the beads carry what a segment resists
// when it turns across; in bending it stands for the rotary inertia of the section, of order (r/L)^2.
namespace frame {
struct Orientation : Field<"q", "1", Numbers<4>, Frames> {};  // unit quaternion (w, x, y, z)
struct AngularVelocity : Field<"omega", "rad/s", Vector, Frames> {};  // world axes
// 0: the frame's motion is prescribed
struct InverseInertia : Field<"1/I", "1/(kg m^2)", Number, Frames> {};
struct Previous : Scratch<"q0", "1", Numbers<4>, Frames> {};  // orientation before the substep
}  // namespace frame

// Where the unknowns of a kind are kept that a rod's solver can move.
template <class Unknown> struct Kept;
template <class U>
inline constexpr bool is_kept =
    std::is_same_v<U, unknown::Point> || std::is_same_v<U, unknown::Orientation>;
template <> struct Kept<unknown::Point> {
  using Domain = Beads;
  using Value = bead::Position;
  using Mobility = bead::InverseMass;
};
template <> struct Kept<unknown::Orientation> {
  using Domain = Frames;
  using Value = frame::Orientation;
  using Mobility = frame::InverseInertia;
};

// Shapes of n numbers, also for n = 1.
template <int n> using numbers_t = std::conditional_t<n == 1, Number, Numbers<n>>;
template <int n> using integers_t = std::conditional_t<n == 1, Integer, Integers<n>>;

namespace detail {
template <class C>
inline constexpr int parameter_slots = parameter_count<C> > 0 ? static_cast<int>(parameter_count<C>)
                                                              : 1;
}  // namespace detail

template <class C> struct instance {
  // Beads it acts on, in the order of its Point unknowns.
  struct Index
      : Field<"index", "1", integers_t<point_count<C> == 0 ? 1 : point_count<C>>, Instances<C>> {};
  // Frames it acts on, in the order of its Orientation unknowns.
  struct FrameIndex
      : Field<"frames", "1", integers_t<frame_count<C> == 0 ? 1 : frame_count<C>>, Instances<C>> {};
  // One past the last instance of the same colour. Instances of a colour share no bead and no frame.
  struct ColourEnd : Field<"colour", "1", Integer, Instances<C>> {};
  // The numbers of C::Parameters in their order.
  struct Parameters : Field<"k", "SI", numbers_t<detail::parameter_slots<C>>, Instances<C>> {};
  // The generalised force along each number of C: dC^T f acts on the unknowns. [N] for lengths,
  // [N m] for angles; a stretched Distance has f < 0, its tension is -f. Zero before a solve.
  struct Multiplier : Field<"f", "J/C", numbers_t<C::dimension>, Instances<C>> {};

  template <bool wanted, class F> using only_if = std::conditional_t<wanted, Fields<F>, Fields<>>;
  using List = union_t<only_if<(point_count<C> > 0 || frame_count<C> == 0), Index>,
                       only_if<(frame_count<C> > 0), FrameIndex>, Fields<ColourEnd>,
                       only_if<(parameter_count<C> > 0), Parameters>, Fields<Multiplier>>;
};

// Reads and writes a field as a vector, whatever the number of its components.
template <class F, class Env> MPMPBD_HD auto get_vector(Env const& env, std::int64_t slot) {
  if constexpr (F::components == 1) {
    using E = element_t<F, typename Env::Scalar>;
    return Vec<E, 1>{{env.template get<F>(slot)}};
  } else {
    return env.template get<F>(slot);
  }
}
template <class F, class Env, class E, int n>
MPMPBD_HD void set_vector(Env const& env, std::int64_t slot, Vec<E, n> const& v) {
  if constexpr (F::components == 1)
    env.template set<F>(slot, v[0]);
  else
    env.template set<F>(slot, v);
}

// The parameters of one instance.
template <class C, class Env> MPMPBD_HD auto load_parameters(Env const& env, std::int64_t slot) {
  using T = typename Env::Scalar;
  parameters_t<C, T> k{};
  if constexpr (parameter_count < C >> 0) {
    auto const flat = get_vector<typename instance<C>::Parameters>(env, slot);
    auto* numbers = reinterpret_cast<T*>(&k);
    for (int i = 0; i < static_cast<int>(parameter_count<C>); ++i) numbers[i] = flat[i];
  }
  return k;
}
template <class C, class Env>
MPMPBD_HD void store_parameters(Env const& env, std::int64_t slot,
                                parameters_t<C, typename Env::Scalar> const& k) {
  using T = typename Env::Scalar;
  auto const* numbers = reinterpret_cast<T const*>(&k);
  Vec<T, static_cast<int>(parameter_count<C>)> flat;
  for (int i = 0; i < static_cast<int>(parameter_count<C>); ++i) flat[i] = numbers[i];
  set_vector<typename instance<C>::Parameters>(env, slot, flat);
}

}  // namespace mpmpbd
