// What a constraint acts on: the kinds of unknowns, their values, and the result of a constraint.
#pragma once

#include <cstddef>
#include <utility>

#include <mpmpbd/core/matrix.hpp>
#include <mpmpbd/core/role.hpp>
#include <mpmpbd/geometry/pose.hpp>

namespace mpmpbd {

// Kinds of unknowns. `Value<T>` is what a constraint is given; `degrees` counts the columns of its
// gradient block: displacements [m], then a rotation vector in world axes [rad].
namespace unknown {
struct Point {  // a bead of a thread
  template <class T> using Value = Vec3<T>;
  static constexpr int degrees = 3;
};
struct Orientation {  // the frame of a segment, unit quaternion (w, x, y, z)
  template <class T> using Value = Vec<T, 4>;
  static constexpr int degrees = 3;
};
struct RigidBody {  // the needle
  template <class T> using Value = Pose<T>;
  static constexpr int degrees = 6;
};
struct TissuePoint {  // a place in the tissue, interpolated from the grid
  template <class T> using Value = Vec3<T>;
  static constexpr int degrees = 3;
};
}  // namespace unknown

namespace detail {
template <int I, class V> struct ValueSlot { V value; };
template <class T, class Indices, class... Us> struct ValueSlots;
template <class T, std::size_t... Is, class... Us>
struct ValueSlots<T, std::index_sequence<Is...>, Us...>
    : ValueSlot<static_cast<int>(Is), typename Us::template Value<T>>... {};

template <int I, class T, int Rows, int Columns> struct BlockSlot { Mat<T, Rows, Columns> block; };
template <class T, int Rows, class Indices, class... Us> struct BlockSlots;
template <class T, int Rows, std::size_t... Is, class... Us>
struct BlockSlots<T, Rows, std::index_sequence<Is...>, Us...>
    : BlockSlot<static_cast<int>(Is), T, Rows, Us::degrees>... {};

template <int I, class V> MPMPBD_HD constexpr V& slot_of(ValueSlot<I, V>& s) { return s.value; }
template <int I, class V> MPMPBD_HD constexpr V const& slot_of(ValueSlot<I, V> const& s) {
  return s.value;
}
template <int I, class T, int R, int C>
MPMPBD_HD constexpr Mat<T, R, C>& block_of(BlockSlot<I, T, R, C>& s) {
  return s.block;
}
template <int I, class T, int R, int C>
MPMPBD_HD constexpr Mat<T, R, C> const& block_of(BlockSlot<I, T, R, C> const& s) {
  return s.block;
}

template <class U, class... Us>
inline constexpr int count_kind = (int(std::is_same_v<U, Us>) + ... + 0);
}  // namespace detail

// The values of a list of unknowns; `get<0>(x)` is the first one.
template <class T, class List> struct Values;
template <class T, class... Us>
struct Values<T, TypeList<Us...>> : detail::ValueSlots<T, std::index_sequence_for<Us...>, Us...> {
  using Scalar = T;
};
template <int I, class T, class List> MPMPBD_HD constexpr auto& get(Values<T, List>& x) {
  return detail::slot_of<I>(x);
}
template <int I, class T, class List>
MPMPBD_HD constexpr auto const& get(Values<T, List> const& x) {
  return detail::slot_of<I>(x);
}

// C (dimension numbers) and its derivative by each unknown, one block of (dimension x degrees) each;
// `gradient<0>(e)` is the block of the first unknown.
template <class T, int dimension, class List> struct EvaluationOf;
template <class T, int dimension, class... Us>
struct EvaluationOf<T, dimension, TypeList<Us...>>
    : detail::BlockSlots<T, dimension, std::index_sequence_for<Us...>, Us...> {
  using Scalar = T;
  Vec<T, dimension> value;
};
template <int I, class T, int dimension, class List>
MPMPBD_HD constexpr auto& gradient(EvaluationOf<T, dimension, List>& e) {
  return detail::block_of<I>(e);
}
template <int I, class T, int dimension, class List>
MPMPBD_HD constexpr auto const& gradient(EvaluationOf<T, dimension, List> const& e) {
  return detail::block_of<I>(e);
}

// How many unknowns of a list are of one kind.
template <class U, class List> inline constexpr int count_unknowns = 0;
template <class U, class... Us>
inline constexpr int count_unknowns<U, TypeList<Us...>> = detail::count_kind<U, Us...>;

}  // namespace mpmpbd
