// Four numbers that travel together: a node's momentum and mass, or its velocity.
//
// On the host a compiler vector, so that one node is one instruction on every x86-64; per-lane
// arithmetic is that of scalars, so the bits do not depend on it.
#pragma once

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd {

#if defined(__GNUC__) && !defined(__CUDACC__) && !defined(MPMPBD_SCALAR_ONLY)
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
#endif

template <class T> MPMPBD_INLINE Quad<T> quad(Vec3<T> const& a, T w) {
  return quad<T>(a[0], a[1], a[2], w);
}
template <class T> MPMPBD_INLINE Vec3<T> vector_part(Quad<T> const& a) {
  return {{a[0], a[1], a[2]}};
}

}  // namespace mpmpbd
