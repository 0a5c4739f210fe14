// Four particles at once: a scalar type whose arithmetic is one vector instruction on any x86-64.
//
// Policies are templates on their scalar, so the same text runs on float and on Pack<float>. What a
// policy must not do then is branch on a value: `select(condition, a, b)` computes both and picks. Each
// lane computes what float would, in the same order, so packs do not change the bits.
#pragma once

#include <mpmpbd/core/table.hpp>

namespace mpmpbd {

// Conditions of plain scalars, so that one text serves both.
template <Real T> MPMPBD_HD constexpr T select(bool condition, T a, T b) {
  return condition ? a : b;
}
MPMPBD_HD constexpr bool any(bool condition) { return condition; }

// How many particles a scalar type holds.
template <class T> inline constexpr int lanes = 1;
// The scalar of one lane.
template <class T> struct LaneOf { using type = T; };
template <class T> using lane_t = typename LaneOf<T>::type;

template <Real T> MPMPBD_INLINE T lane(T a, int) { return a; }

#if defined(__GNUC__) && !defined(__CUDACC__) && !defined(MPMPBD_SCALAR_ONLY)
#define MPMPBD_HAS_PACKS 1

template <class T> struct Pack;

template <> struct Pack<float> {
  typedef float Lanes __attribute__((vector_size(16)));
  typedef int Mask __attribute__((vector_size(16)));
  Lanes v;

  Pack() = default;
  MPMPBD_INLINE Pack(Lanes lanes_) : v(lanes_) {}
  template <class S>
    requires std::is_arithmetic_v<S> MPMPBD_INLINE Pack(S s) : v(static_cast<float>(s) - Lanes{}) {}

    MPMPBD_INLINE Pack& operator+=(Pack b) {
      v += b.v;
      return *this;
    }
    MPMPBD_INLINE Pack& operator-=(Pack b) {
      v -= b.v;
      return *this;
    }
    MPMPBD_INLINE Pack& operator*=(Pack b) {
      v *= b.v;
      return *this;
    }
    friend MPMPBD_INLINE Pack operator+(Pack a, Pack b) { return a.v + b.v; }
    friend MPMPBD_INLINE Pack operator-(Pack a, Pack b) { return a.v - b.v; }
    friend MPMPBD_INLINE Pack operator*(Pack a, Pack b) { return a.v * b.v; }
    friend MPMPBD_INLINE Pack operator/(Pack a, Pack b) { return a.v / b.v; }
    friend MPMPBD_INLINE Pack operator-(Pack a) { return -a.v; }

    struct Condition {
      Mask m;
      friend MPMPBD_INLINE Condition operator!(Condition a) { return {~a.m}; }
      friend MPMPBD_INLINE Condition operator&&(Condition a, Condition b) { return {a.m & b.m}; }
      friend MPMPBD_INLINE Condition operator||(Condition a, Condition b) { return {a.m | b.m}; }
    };
    friend MPMPBD_INLINE Condition operator<(Pack a, Pack b) { return {a.v < b.v}; }
    friend MPMPBD_INLINE Condition operator>(Pack a, Pack b) { return {a.v > b.v}; }
    friend MPMPBD_INLINE Condition operator<=(Pack a, Pack b) { return {a.v <= b.v}; }
    friend MPMPBD_INLINE Condition operator>=(Pack a, Pack b) { return {a.v >= b.v}; }
};
template <> inline constexpr int lanes<Pack<float>> = 4;
template <> struct LaneOf<Pack<float>> { using type = float; };

MPMPBD_INLINE Pack<float> select(Pack<float>::Condition c, Pack<float> a, Pack<float> b) {
  using Mask = Pack<float>::Mask;
  return Pack<float>::Lanes((c.m & Mask(a.v)) | (~c.m & Mask(b.v)));
}
MPMPBD_INLINE bool any(Pack<float>::Condition c) {
  return (c.m[0] | c.m[1] | c.m[2] | c.m[3]) != 0;
}
MPMPBD_INLINE Pack<float> min(Pack<float> a, Pack<float> b) { return select(b < a, b, a); }
MPMPBD_INLINE Pack<float> max(Pack<float> a, Pack<float> b) { return select(a < b, b, a); }
MPMPBD_INLINE Pack<float> abs(Pack<float> a) {
  return Pack<float>::Lanes(Pack<float>::Mask(a.v) & (0x7fffffff - Pack<float>::Mask{}));
}
MPMPBD_INLINE Pack<float>::Condition is_finite(Pack<float> a) {
  return {(a.v - a.v) == Pack<float>::Lanes{}};
}
// The library's own functions lane by lane: the bits of float.
MPMPBD_INLINE Pack<float> sqrt(Pack<float> a) {
  return Pack<float>::Lanes{sqrt(a.v[0]), sqrt(a.v[1]), sqrt(a.v[2]), sqrt(a.v[3])};
}
MPMPBD_INLINE Pack<float> log(Pack<float> a) {
  return Pack<float>::Lanes{log(a.v[0]), log(a.v[1]), log(a.v[2]), log(a.v[3])};
}
MPMPBD_INLINE Pack<float> exp(Pack<float> a) {
  return Pack<float>::Lanes{exp(a.v[0]), exp(a.v[1]), exp(a.v[2]), exp(a.v[3])};
}
MPMPBD_INLINE Pack<float> floor(Pack<float> a) {
  auto const whole =
      __builtin_convertvector(__builtin_convertvector(a.v, Pack<float>::Mask), Pack<float>::Lanes);
  return select(Pack<float>(whole) > a, whole - 1.0f, whole);
}

MPMPBD_INLINE float lane(Pack<float> const& a, int l) { return a.v[l]; }

// Four consecutive slots as one item: what Local loads from and stores to.
template <class View> struct PackView {
  View view;
  template <class F> MPMPBD_INLINE value_t<F, Pack<float>> get(std::int64_t index) const {
    value_t<F, Pack<float>> value;
    auto* to = reinterpret_cast<Pack<float>*>(&value);
    for (int c = 0; c < F::components; ++c)
      __builtin_memcpy(&to[c].v, view.template plane<F>(c) + index, sizeof to[c].v);
    return value;
  }
  template <class F>
  MPMPBD_INLINE void set(std::int64_t index, value_t<F, Pack<float>> const& value) const {
    auto const* from = reinterpret_cast<Pack<float> const*>(&value);
    for (int c = 0; c < F::components; ++c)
      __builtin_memcpy(view.template plane<F>(c) + index, &from[c].v, sizeof from[c].v);
  }
};
#endif

// The same lane of every entry.
template <class T, int R, int C>
MPMPBD_INLINE Mat<lane_t<T>, R, C> lane(Mat<T, R, C> const& a, int l) {
  Mat<lane_t<T>, R, C> r;
  for (int i = 0; i < R * C; ++i) r.m[i] = lane(a.m[i], l);
  return r;
}
template <class Condition, class T, int R, int C>
MPMPBD_INLINE Mat<T, R, C> select(Condition condition, Mat<T, R, C> const& a,
                                  Mat<T, R, C> const& b) {
  Mat<T, R, C> r;
  for (int i = 0; i < R * C; ++i) r.m[i] = select(condition, a.m[i], b.m[i]);
  return r;
}

}  // namespace mpmpbd
