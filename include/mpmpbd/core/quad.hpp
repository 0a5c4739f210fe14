// Four numbers that travel together: a node's momentum and mass, or its velocity.
//
// On the host a compiler vector, so that one node is one instruction on every x86-64; per-lane
// arithmetic is that of scalars, so the bits do not depend on it.
#pragma once

#include <mpmpbd/core/matrix.hpp>
#include <mpmpbd/core/pack.hpp>

namespace mpmpbd {

#if defined(MPMPBD_HAS_PACKS)
template <class T> struct Quad {
  typedef T Lanes __attribute__((vector_size(4 * sizeof(T))));
  Lanes v;
  T operator[](int i) const { return v[i]; }
};
template <class T> MPMPBD_INLINE Quad<T> quad(T a, T b, T c, T d) {
  return {typename Quad<T>::Lanes{a, b, c, d}};
}
template <class T> MPMPBD_INLINE Quad<T> operator+(Quad<T> const& a, Quad<T> const& b) {
  return {a.v + b.v};
}
template <class T> MPMPBD_INLINE Quad<T> operator*(detail::identity_t<T> s, Quad<T> const& a) {
  return {s * a.v};
}
template <class T> using Massless = Quad<T>;
template <class T> MPMPBD_INLINE Massless<T> without_mass(Quad<T> const& a) { return a; }
#else
template <class T> struct alignas(4 * sizeof(T)) Quad {
  T v[4];
  MPMPBD_HD T operator[](int i) const { return v[i]; }
};
template <class T> MPMPBD_INLINE Quad<T> quad(T a, T b, T c, T d) { return {{a, b, c, d}}; }
template <class T> MPMPBD_INLINE Quad<T> operator+(Quad<T> const& a, Quad<T> const& b) {
  return {{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2], a.v[3] + b.v[3]}};
}
template <class T> MPMPBD_INLINE Quad<T> operator*(detail::identity_t<T> s, Quad<T> const& a) {
  return {{s * a.v[0], s * a.v[1], s * a.v[2], s * a.v[3]}};
}
// A change of momentum that brings no mass: where numbers do not travel in fours, the fourth is not even there.
template <class T> struct Massless {
  T v[3];
  MPMPBD_HD T operator[](int i) const { return v[i]; }
};
template <class T> MPMPBD_INLINE Massless<T> without_mass(Quad<T> const& a) {
  return {{a.v[0], a.v[1], a.v[2]}};
}
template <class T> MPMPBD_INLINE Quad<T> operator+(Quad<T> const& a, Massless<T> const& b) {
  return {{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2], a.v[3]}};
}
template <class T>
MPMPBD_INLINE Massless<T> operator*(detail::identity_t<T> s, Massless<T> const& a) {
  return {{s * a.v[0], s * a.v[1], s * a.v[2]}};
}
#endif

// sum + s a, as multiply_add does it; V is a quad or a pack of some. What has no mass leaves that of the sum.
template <class V, class S, class Change>
  requires requires(V const& q) { q.v; }
MPMPBD_INLINE V add_product(V const& sum, S s, Change const& a) {
#if defined(__CUDA_ARCH__)
  V r = sum;
  for (int i = 0; i < int(sizeof(a.v) / sizeof(a.v[0])); ++i)
    r.v[i] = multiply_add(s, a.v[i], sum.v[i]);
  return r;
#else
  return sum + s * a;
#endif
}

// The quads of every lane of four numbers, and back.
template <Real T> MPMPBD_INLINE void to_lanes(Vec<T, 4> const& a, Quad<T> (&q)[1]) {
  q[0] = quad(a[0], a[1], a[2], a[3]);
}
template <Real T> MPMPBD_INLINE Vec<T, 4> from_lanes(Quad<T> const (&q)[1]) {
  return {{q[0][0], q[0][1], q[0][2], q[0][3]}};
}
#if defined(MPMPBD_HAS_PACKS)
// Two quads side by side.
MPMPBD_WIDE Pack<float> both(Quad<float> const& a, Quad<float> const& b) {
  return __builtin_shufflevector(a.v, b.v, 0, 1, 2, 3, 4, 5, 6, 7);
}
MPMPBD_WIDE Quad<float> low_half(Pack<float> const& a) {
  return {__builtin_shufflevector(a.v, a.v, 0, 1, 2, 3)};
}
MPMPBD_WIDE Quad<float> high_half(Pack<float> const& a) {
  return {__builtin_shufflevector(a.v, a.v, 4, 5, 6, 7)};
}
namespace detail {
// Columns of two 4 x 4 matrices, side by side, become rows.
MPMPBD_WIDE void transpose_halves(Pack<float> (&q)[4]) {
  auto const a = q[0].v, b = q[1].v, c = q[2].v, d = q[3].v;
  auto const ab_low = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13),
             ab_high = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  auto const cd_low = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13),
             cd_high = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  q[0].v = __builtin_shufflevector(ab_low, cd_low, 0, 1, 8, 9, 4, 5, 12, 13);
  q[1].v = __builtin_shufflevector(ab_low, cd_low, 2, 3, 10, 11, 6, 7, 14, 15);
  q[2].v = __builtin_shufflevector(ab_high, cd_high, 0, 1, 8, 9, 4, 5, 12, 13);
  q[3].v = __builtin_shufflevector(ab_high, cd_high, 2, 3, 10, 11, 6, 7, 14, 15);
}
}  // namespace detail
MPMPBD_WIDE void to_lanes(Vec<Pack<float>, 4> const& a, Quad<float> (&q)[8]) {
  Pack<float> t[4] = {a.m[0], a.m[1], a.m[2], a.m[3]};
  detail::transpose_halves(t);
  for (int l = 0; l < 4; ++l) q[l] = low_half(t[l]), q[l + 4] = high_half(t[l]);
}
MPMPBD_WIDE Vec<Pack<float>, 4> from_lanes(Quad<float> const (&q)[8]) {
  Vec<Pack<float>, 4> t;
  for (int l = 0; l < 4; ++l) t.m[l] = both(q[l], q[l + 4]);
  detail::transpose_halves(t.m);
  return t;
}
#endif

template <class T> MPMPBD_INLINE Quad<T> quad(Vec3<T> const& a, T w) {
  return quad<T>(a[0], a[1], a[2], w);
}
template <class T> MPMPBD_INLINE Vec3<T> vector_part(Quad<T> const& a) {
  return {{a[0], a[1], a[2]}};
}

}  // namespace mpmpbd
