// What all solvers share: loading one constraint, its correction, and walks over its instances.
#pragma once

#include <mpmpbd/core/tick.hpp>
#include <mpmpbd/pbd/constraint_set.hpp>

namespace mpmpbd::detail {

// One instance with everything that its correction needs.
template <class C, class T> struct Loaded {
  static constexpr int unknowns = C::Unknowns::size;
  Vec<std::int64_t, unknowns> slots;  // where its beads and frames are
  Vec<T, unknowns> weights;           // inverse masses [1/kg] and inertias [1/(kg m^2)]
  ValuesOf<C, T> x;
  parameters_t<C, T> k;
  Evaluation<C, T> at;
  compliance_t<C, T> compliance;  // one number, or one for each of C
  Vec<T, C::dimension> multiplier;
};

// Calls f(kind, index) for every unknown that a rod's solver moves: a tag, and its number as a type.
template <class U, int I, class Function> MPMPBD_INLINE void call_if_kept(Function&& f) {
  if constexpr (is_kept<U>) f(U{}, std::integral_constant<int, I>{});
}
template <class Function, class... Us, std::size_t... Is>
MPMPBD_INLINE void for_each_kept(Function&& f, TypeList<Us...>, std::index_sequence<Is...>) {
  (call_if_kept<Us, static_cast<int>(Is)>(f), ...);
}
template <class C, class Function> MPMPBD_INLINE void for_each_kept(Function&& f) {
  for_each_kept(f, typename C::Unknowns{},
                std::make_index_sequence<static_cast<std::size_t>(C::Unknowns::size)>{});
}

// The field that tells which beads, or which frames, an instance of C acts on.
template <class C, class Unknown>
using index_t = std::conditional_t<std::is_same_v<Unknown, unknown::Point>,
                                   typename instance<C>::Index, typename instance<C>::FrameIndex>;

// The slots of an instance's beads and frames, in the order of its unknowns.
template <class C, class Env> MPMPBD_HD auto slots_of(Env const& env, std::int64_t slot) {
  if constexpr (acts_on_points_only<C>) {
    return get_vector<typename instance<C>::Index>(env, slot);
  } else {
    Vec<std::int64_t, C::Unknowns::size> slots{};
    int b = 0, f = 0;
    for_each_kept<C>([&]<class U, class I>(U, I) {
      int& n = std::is_same_v<U, unknown::Point> ? b : f;
      slots[I::value] = get_vector<index_t<C, U>>(env, slot)[n++];
    });
    return slots;
  }
}

template <class C, class Env> MPMPBD_HD auto load_instance(Env const& env, std::int64_t slot) {
  using T = typename Env::Scalar;
  Loaded<C, T> one;
  one.slots = slots_of<C>(env, slot);
  one.weights = {};
  for_each_kept<C>([&]<class U, class I>(U, I) {
    get<I::value>(one.x) = env.template get<typename Kept<U>::Value>(one.slots[I::value]);
    one.weights[I::value] = env.template get<typename Kept<U>::Mobility>(one.slots[I::value]);
  });
  one.k = load_parameters<C>(env, slot);
  one.at = C::evaluate(one.x, one.k);
  one.compliance = C::compliance(one.k);
  one.multiplier = get_vector<typename instance<C>::Multiplier>(env, slot);
  return one;
}

// A compliance as a diagonal, and times a multiplier: one number for all of C, or one for each.
template <int n, Real T> MPMPBD_HD Mat<T, n, n> diagonal(T a) {
  return a * Mat<T, n, n>::identity();
}
template <int n, class T> MPMPBD_HD Mat<T, n, n> diagonal(Vec<T, n> const& a) {
  Mat<T, n, n> m{};
  for (int i = 0; i < n; ++i) m(i, i) = a[i];
  return m;
}
template <class T, int n> MPMPBD_HD Vec<T, n> scaled(T a, Vec<T, n> const& f) { return a * f; }
template <class T, int n> MPMPBD_HD Vec<T, n> scaled(Vec<T, n> const& a, Vec<T, n> f) {
  for (int i = 0; i < n; ++i) f[i] *= a[i];
  return f;
}

// Solves K d = r for a symmetric positive K (L D L^T). A direction without stiffness gets 0: nothing
// there can be moved, or moving it would not change C.
template <class T, int n> MPMPBD_HD Vec<T, n> solve_small(Mat<T, n, n> K, Vec<T, n> r) {
  T inverse_pivot[n];
  for (int j = 0; j < n; ++j) {
    T pivot = K(j, j);
    T const whole = pivot;
    for (int k = 0; k < j; ++k)
      pivot -= K(j, k) * K(j, k) * (inverse_pivot[k] > T(0) ? T(1) / inverse_pivot[k] : T(0));
    inverse_pivot[j] =
        pivot > T(0) && pivot > T(16) * epsilon<T> * whole * T(n > 1) ? T(1) / pivot : T(0);
    for (int i = j + 1; i < n; ++i) {
      T s = K(i, j);
      for (int k = 0; k < j; ++k)
        s -= K(i, k) * K(j, k) * (inverse_pivot[k] > T(0) ? T(1) / inverse_pivot[k] : T(0));
      K(i, j) = s * inverse_pivot[j];
    }
  }
  for (int j = 0; j < n; ++j)
    for (int k = 0; k < j; ++k) r[j] -= K(j, k) * r[k];
  for (int j = n - 1; j >= 0; --j) {
    r[j] *= inverse_pivot[j];
    for (int i = j + 1; i < n; ++i) r[j] -= K(i, j) * r[i];
  }
  return r;
}

// The change of the multiplier by one projection. XPBD (Macklin et al. 2016, eq. 18) with its
// lambda = dt^2 f, numerator and denominator times dt^2:
//   df = -(C + alpha f) / (dt^2 sum w grad grad^T + alpha),    x += dt^2 w grad^T df.
template <class C, class T>
MPMPBD_HD Vec<T, C::dimension> correction(Loaded<C, T> const& one, T dt2) {
  auto K = diagonal<C::dimension>(one.compliance);
  for_each_kept<C>([&]<class U, class I>(U, I) {
    auto const& G = gradient<I::value>(one.at);
    K += (dt2 * one.weights[I::value]) * (G * transpose(G));
  });
  auto d = solve_small(K, -(one.at.value + scaled(one.compliance, one.multiplier)));
  if constexpr (C::kind == ConstraintKind::inequality)
    for (int i = 0; i < C::dimension; ++i) d[i] = max(d[i], -one.multiplier[i]);
  return d;
}

// Calls f(kind, slot, displacement) for every bead and frame of an instance that can move: [m] or a rotation
// vector [rad].
template <class C, class T, class Function>
MPMPBD_INLINE void for_each_displacement(Loaded<C, T> const& one, Vec<T, C::dimension> const& d,
                                         T dt2, Function&& f) {
  for_each_kept<C>([&]<class U, class I>(U kind, I) {
    T const w = one.weights[I::value];
    if (w > T(0))
      f(kind, one.slots[I::value], (dt2 * w) * (transpose(gradient<I::value>(one.at)) * d));
  });
}

template <class Env, class T>
MPMPBD_HD void displace(Env const& env, unknown::Point, std::int64_t b, Vec3<T> const& by) {
  env.template set<bead::Position>(b, env.template get<bead::Position>(b) + by);
}
template <class Env, class T>
MPMPBD_HD void displace(Env const& env, unknown::Orientation, std::int64_t f, Vec3<T> const& turn) {
  env.template set<frame::Orientation>(
      f, quaternion::turned(env.template get<frame::Orientation>(f), turn));
}

// A team counts in int: one environment has fewer slots than that.
template <class Team, class Function>
MPMPBD_HD void each(Team const& team, std::int64_t count, Function const& f) {
  team.each(static_cast<int>(count), f);
}

// Calls f(slot) for every instance of C, colour after colour: within a colour in any order, because
// no two of its instances share a bead or a frame.
template <class C, class Team, class Env, class Function>
MPMPBD_HD void for_each_colour(Team const& team, Env const& env, Function const& f) {
  std::int64_t const count = env.template live<Instances<C>>();
  for (std::int64_t first = 0; first < count;) {
    std::int64_t const end = clamp<std::int64_t>(
        env.template get<typename instance<C>::ColourEnd>(first), first + 1, count);
    each(team, end - first, [&](std::int64_t i) { f(first + i); });
    team.sync();
    first = end;
  }
}
// Calls f(slot) for every instance of C, in any order.
template <class C, class Team, class Env, class Function>
MPMPBD_HD void for_each_instance(Team const& team, Env const& env, Function const& f) {
  each(team, env.template live<Instances<C>>(), f);
  team.sync();
}

}  // namespace mpmpbd::detail
