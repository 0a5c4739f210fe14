// Eight particles at once: a scalar type whose arithmetic is one instruction of wide vectors.
//
// Policies are templates on their scalar, so the same text runs on float and on Pack<float>. What a
// policy must not do then is branch on a value: `select(condition, a, b)` computes both and picks. Each
// lane computes what float would, in the same order, so packs do not change the bits.
#pragma once

#include <mpmpbd/core/table.hpp>
#include <mpmpbd/core/wide.hpp>

namespace mpmpbd {

// Conditions of plain scalars, so that one text serves both.
template <Real T> MPMPBD_HD constexpr T select(bool condition, T a, T b) {
  return condition ? a : b;
}
MPMPBD_HD constexpr bool any(bool condition) { return condition; }
// Both, without a branch between them.
MPMPBD_HD constexpr bool both_hold(bool a, bool b) { return a & b; }

// How many particles a scalar type holds.
template <class T> inline constexpr int lanes = 1;
// The scalar of one lane.
template <class T> struct LaneOf { using type = T; };
template <class T> using lane_t = typename LaneOf<T>::type;

template <Real T> MPMPBD_INLINE T lane(T a, int) { return a; }

#if defined(MPMPBD_HAS_PACKS)
template <class S> concept Arithmetic = std::is_arithmetic_v<S>;

template <class T> struct Pack;

// A type that moves by a function of its own is passed by reference: what holds 32 bytes by value depends
// on the target of a function, and a kernel's is not that of a policy that was not inlined.
template <> struct Pack<float> {
  typedef float Lanes __attribute__((vector_size(32)));
  typedef int Mask __attribute__((vector_size(32)));
  Lanes v;

  Pack() = default;
  Pack(Pack const&) = default;
  MPMPBD_INLINE Pack(Pack&& b) noexcept : v(b.v) {}
  Pack& operator=(Pack const&) = default;
  MPMPBD_WIDE Pack(Lanes const& lanes_) : v(lanes_) {}
  template <Arithmetic S> MPMPBD_WIDE Pack(S s) : v(static_cast<float>(s) - Lanes{}) {}

  // Eight floats in a row, wherever they start.
  MPMPBD_WIDE static Pack load(float const* from) {
    Lanes const eight =
        *reinterpret_cast<Loose const*>(from);  // a copy: clang would bind a cast to where they lie
    return eight;
  }
  MPMPBD_WIDE void store(float* to) const { *reinterpret_cast<Loose*>(to) = v; }

  MPMPBD_WIDE Pack& operator+=(Pack const& b) {
    v += b.v;
    return *this;
  }
  MPMPBD_WIDE Pack& operator-=(Pack const& b) {
    v -= b.v;
    return *this;
  }
  MPMPBD_WIDE Pack& operator*=(Pack const& b) {
    v *= b.v;
    return *this;
  }
  friend MPMPBD_WIDE Pack operator+(Pack const& a, Pack const& b) { return a.v + b.v; }
  friend MPMPBD_WIDE Pack operator-(Pack const& a, Pack const& b) { return a.v - b.v; }
  friend MPMPBD_WIDE Pack operator*(Pack const& a, Pack const& b) { return a.v * b.v; }
  friend MPMPBD_WIDE Pack operator/(Pack const& a, Pack const& b) { return a.v / b.v; }
  friend MPMPBD_WIDE Pack operator-(Pack const& a) { return -a.v; }

  struct Condition {
    Mask m;
    Condition(Condition const&) = default;
    MPMPBD_INLINE Condition(Condition&& b) noexcept : m(b.m) {}
    Condition& operator=(Condition const&) = default;
    MPMPBD_WIDE Condition(Mask const& mask) : m(mask) {}
    friend MPMPBD_WIDE Condition operator!(Condition const& a) { return ~a.m; }
    friend MPMPBD_WIDE Condition operator&&(Condition const& a, Condition const& b) {
      return a.m & b.m;
    }
    friend MPMPBD_WIDE Condition operator||(Condition const& a, Condition const& b) {
      return a.m | b.m;
    }
  };
  friend MPMPBD_WIDE Condition operator<(Pack const& a, Pack const& b) { return a.v < b.v; }
  friend MPMPBD_WIDE Condition operator>(Pack const& a, Pack const& b) { return a.v > b.v; }
  friend MPMPBD_WIDE Condition operator<=(Pack const& a, Pack const& b) { return a.v <= b.v; }
  friend MPMPBD_WIDE Condition operator>=(Pack const& a, Pack const& b) { return a.v >= b.v; }

 private:
  typedef float Loose __attribute__((vector_size(32), aligned(4), may_alias));
};
template <> inline constexpr int lanes<Pack<float>> = 8;
template <> struct LaneOf<Pack<float>> { using type = float; };

MPMPBD_WIDE Pack<float> select(Pack<float>::Condition const& c, Pack<float> const& a,
                               Pack<float> const& b) {
  using Mask = Pack<float>::Mask;
  return Pack<float>::Lanes((c.m & Mask(a.v)) | (~c.m & Mask(b.v)));
}
MPMPBD_WIDE Pack<float> multiply_add(Pack<float> const& a, Pack<float> const& b,
                                     Pack<float> const& c) {
  return a * b + c;
}
MPMPBD_WIDE Pack<float>::Condition both_hold(Pack<float>::Condition const& a,
                                             Pack<float>::Condition const& b) {
  return a && b;
}
MPMPBD_WIDE bool any(Pack<float>::Condition const& c) {
  typedef long long Pairs __attribute__((vector_size(32)));
  Pairs const p = Pairs(c.m);
  return ((p[0] | p[1]) | (p[2] | p[3])) != 0;
}
MPMPBD_WIDE Pack<float> min(Pack<float> const& a, Pack<float> const& b) {
  return select(b < a, b, a);
}
MPMPBD_WIDE Pack<float> max(Pack<float> const& a, Pack<float> const& b) {
  return select(a < b, b, a);
}
MPMPBD_WIDE Pack<float> abs(Pack<float> const& a) {
  return Pack<float>::Lanes(Pack<float>::Mask(a.v) & (0x7fffffff - Pack<float>::Mask{}));
}
MPMPBD_WIDE Pack<float>::Condition is_finite(Pack<float> const& a) {
  return (a.v - a.v) == Pack<float>::Lanes{};
}
MPMPBD_WIDE Pack<float> floor(Pack<float> const& a) {
  auto const whole =
      __builtin_convertvector(__builtin_convertvector(a.v, Pack<float>::Mask), Pack<float>::Lanes);
  return select(Pack<float>(whole) > a, whole - 1.0f, whole);
}
// The library's own functions lane by lane: the bits of float.
namespace detail {
template <class Function>
MPMPBD_WIDE Pack<float> lane_by_lane(Pack<float> const& a, Function const& f) {
  Pack<float> r;
  for (int l = 0; l < lanes<Pack<float>>; ++l) r.v[l] = f(a.v[l]);
  return r;
}
}  // namespace detail
MPMPBD_WIDE Pack<float> sqrt(Pack<float> const& a) {
  return detail::lane_by_lane(a, [](float x) { return sqrt(x); });
}
MPMPBD_WIDE Pack<float> log(Pack<float> const& a) {
  return detail::lane_by_lane(a, [](float x) { return log(x); });
}
MPMPBD_WIDE Pack<float> exp(Pack<float> const& a) {
  return detail::lane_by_lane(a, [](float x) { return exp(x); });
}

MPMPBD_INLINE float lane(Pack<float> const& a, int l) { return a.v[l]; }

// Eight consecutive slots as one item: what Local loads from and stores to.
template <class View> struct PackView {
  View view;
  template <class F> MPMPBD_WIDE value_t<F, Pack<float>> get(std::int64_t index) const {
    if constexpr (F::components == 1) {
      return Pack<float>::load(view.template plane<F>() + index);
    } else {
      value_t<F, Pack<float>> value;
      for (int c = 0; c < F::components; ++c)
        value[c] = Pack<float>::load(view.template plane<F>(c) + index);
      return value;
    }
  }
  template <class F>
  MPMPBD_WIDE void set(std::int64_t index, value_t<F, Pack<float>> const& value) const {
    if constexpr (F::components == 1)
      value.store(view.template plane<F>() + index);
    else
      for (int c = 0; c < F::components; ++c) value.m[c].store(view.template plane<F>(c) + index);
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
MPMPBD_INLINE Mat<T, R, C> select(Condition const& condition, Mat<T, R, C> const& a,
                                  Mat<T, R, C> const& b) {
  Mat<T, R, C> r;
  for (int i = 0; i < R * C; ++i) r.m[i] = select(condition, a.m[i], b.m[i]);
  return r;
}

}  // namespace mpmpbd
