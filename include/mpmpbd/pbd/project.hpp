// What all solvers share: loading one constraint, its correction, and walks over its instances.
#pragma once

#include <mpmpbd/core/tick.hpp>
#include <mpmpbd/pbd/constraint_set.hpp>

namespace mpmpbd::detail {

// One instance with everything that its correction needs.
template <class C, class T> struct Loaded {
  static constexpr int points = point_count<C>;
  Vec<std::int64_t, points> beads;
  Vec<T, points> weights;  // inverse masses [1/kg]
  ValuesOf<C, T> x;
  parameters_t<C, T> k;
  Evaluation<C, T> at;
  T compliance;
  Vec<T, C::dimension> multiplier;
};

template <class C, class Env, std::size_t... Is>
MPMPBD_HD auto load_instance(Env const& env, std::int64_t slot, std::index_sequence<Is...>) {
  using T = typename Env::Scalar;
  Loaded<C, T> one;
  one.beads = get_vector<typename instance<C>::Index>(env, slot);
  ((get<static_cast<int>(Is)>(one.x) =
        env.template get<bead::Position>(one.beads[static_cast<int>(Is)])),
   ...);
  ((one.weights[static_cast<int>(Is)] =
        env.template get<bead::InverseMass>(one.beads[static_cast<int>(Is)])),
   ...);
  one.k = load_parameters<C>(env, slot);
  one.at = C::evaluate(one.x, one.k);
  one.compliance = C::compliance(one.k);
  one.multiplier = get_vector<typename instance<C>::Multiplier>(env, slot);
  return one;
}
template <class C, class Env> MPMPBD_HD auto load_instance(Env const& env, std::int64_t slot) {
  return load_instance<C>(env, slot,
                          std::make_index_sequence<static_cast<std::size_t>(point_count<C>)>{});
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

template <class C, class T, std::size_t... Is>
MPMPBD_HD void add_stiffness(Mat<T, C::dimension, C::dimension>& K, Loaded<C, T> const& one, T dt2,
                             std::index_sequence<Is...>) {
  ((K +=
    (dt2 * one.weights[static_cast<int>(Is)]) *
    (gradient<static_cast<int>(Is)>(one.at) * transpose(gradient<static_cast<int>(Is)>(one.at)))),
   ...);
}

// The change of the multiplier by one projection. XPBD (Macklin et al. 2016, eq. 18) with its
// lambda = dt^2 f, numerator and denominator times dt^2:
//   df = -(C + alpha f) / (dt^2 sum w grad grad^T + alpha),    x += dt^2 w grad^T df.
template <class C, class T>
MPMPBD_HD Vec<T, C::dimension> correction(Loaded<C, T> const& one, T dt2) {
  using Points = std::make_index_sequence<static_cast<std::size_t>(point_count<C>)>;
  auto K = one.compliance * Mat<T, C::dimension, C::dimension>::identity();
  add_stiffness<C>(K, one, dt2, Points{});
  auto d = solve_small(K, -(one.at.value + one.compliance * one.multiplier));
  if constexpr (C::kind == ConstraintKind::inequality)
    for (int i = 0; i < C::dimension; ++i) d[i] = max(d[i], -one.multiplier[i]);
  return d;
}

// Calls f(bead, displacement) for every bead of an instance that can move.
template <class C, class T, class Function, std::size_t... Is>
MPMPBD_HD void for_each_displacement(Loaded<C, T> const& one, Vec<T, C::dimension> const& d, T dt2,
                                     Function&& f, std::index_sequence<Is...>) {
  ((one.weights[static_cast<int>(Is)] > T(0)
        ? f(one.beads[static_cast<int>(Is)],
            (dt2 * one.weights[static_cast<int>(Is)]) *
                (transpose(gradient<static_cast<int>(Is)>(one.at)) * d))
        : void()),
   ...);
}
template <class C, class T, class Function>
MPMPBD_HD void for_each_displacement(Loaded<C, T> const& one, Vec<T, C::dimension> const& d, T dt2,
                                     Function&& f) {
  for_each_displacement<C>(one, d, dt2, f,
                           std::make_index_sequence<static_cast<std::size_t>(point_count<C>)>{});
}

// A team counts in int: one environment has fewer slots than that.
template <class Team, class Function>
MPMPBD_HD void each(Team const& team, std::int64_t count, Function const& f) {
  team.each(static_cast<int>(count), f);
}

// Calls f(slot) for every instance of C, colour after colour: within a colour in any order, because
// no two of its instances share a bead.
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
