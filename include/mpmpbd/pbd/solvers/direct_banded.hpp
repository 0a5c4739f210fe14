// All constraints of a chain at once, by one banded elimination.
#pragma once

#include <mpmpbd/core/status.hpp>
#include <mpmpbd/pbd/project.hpp>
#include <mpmpbd/pbd/solvers/band.hpp>

namespace mpmpbd {

// The row beside that of C for what C does across its gradient (`C::across`, optional).
template <class C> struct Across { using Unknowns = typename C::Unknowns; };
template <class C>
concept HasAcross = requires(ValuesOf<C, float> const& x, parameters_t<C, float> const& k) {
  { C::across(x, k) } -> std::same_as<Evaluation<C, float>>;
};
namespace detail {
template <class List> struct RowsOf;
template <class... Cs> struct RowsOf<TypeList<Cs...>> {
  using type = join_t<std::conditional_t<HasAcross<Cs>, TypeList<Cs, Across<Cs>>, TypeList<Cs>>...>;
};
}  // namespace detail
// The rows that a bead has in the direct solver's system.
template <class Set> using rows_t = typename detail::RowsOf<typename Set::List>::type;

// The linear system of a chain: one row per bead and kind of constraint, in the order of beads. A row
// whose constraint does not exist is the identity.
template <class List> struct Chain;
template <class... Cs> struct Chain<TypeList<Cs...>> {
  static constexpr int kinds = sizeof...(Cs);
  // Where kind C stands within the rows of a bead.
  template <class C>
  static constexpr int place = [] {
    int at = 0, found = 0;
    ((std::is_same_v<C, Cs> ? (found = at++) : at++), ...);
    return found;
  }();
  // Farthest row that a row shares a bead with: 1 (tridiagonal) for Distance alone, 4 with a Bend of one
  // row, 7 with the row across it (3 x 3 blocks, half bandwidth 2).
  static constexpr int half_band = [] {
    int most = 1;
    auto against = [&](int points, int place_below) {
      ((most = (points - 1) * kinds + place<Cs> - place_below > most
                   ? (points - 1) * kinds + place<Cs> - place_below
                   : most),
       ...);
    };
    (against(point_count<Cs>, place<Cs>), ...);
    return most;
  }();

  struct Band : Scratch<"band", "m/N", numbers_t<kinds*(half_band + 1)>, Beads> {};
  template <class C>
  struct Gradient : Scratch<"grad", "1", numbers_t<3 * point_count<C>>, Beads> {};
  template <class C>
  struct Right : Scratch<"r", "1", Number, Beads> {};  // -(C + alpha f), then the change of f
  template <class C>
  struct Alpha : Scratch<"alpha", "1", Number, Beads> {};  // compliance; -1: no constraint here
  template <class C> struct Force : Scratch<"f", "J/C", Number, Beads> {};  // the multiplier so far
  template <class C>
  struct Length : Scratch<"l", "m", Number, Beads> {};      // of a taut link, when solved
  struct Predicted : Scratch<"xp", "m", Vector, Beads> {};  // by all but lengths
  struct Carry : Scratch<"s", "1", Number, Beads> {};       // of the elimination along the chain
  using ScratchFields =
      union_t<Fields<Band, Predicted, Carry>,
              Fields<Gradient<Cs>, Right<Cs>, Alpha<Cs>, Force<Cs>, Length<Cs>>...>;
};

namespace detail {
template <class List> struct WithoutLengths;
template <class... Cs> struct WithoutLengths<TypeList<Cs...>> {
  using type = join_t<std::conditional_t<is_length<Cs>, TypeList<>, TypeList<Cs>>...>;
};
}  // namespace detail

// Newton steps on (grad W grad^T + alpha/dt^2) dlambda = -(C + alpha/dt^2 lambda) for the whole chain:
// an inextensible thread costs the same as a soft one, whatever its length. Beads of one thread follow
// each other in number; several threads are several blocks of the same band.
// Before every elimination but the first, the chain is laid out under the tensions found so far, so that
// a taut light thread is stable at any step; forces of joints are carried over as vectors.
// Limits: constraints along a chain only. With one iteration there is no layout, and h^2 T / (m l) has to
// stay below 1 (T tension, m bead mass, l segment). Segments that turn by more than a radian per substep
// need 4 to 8 iterations. Over-determined chains: a row without a pivot keeps its multiplier.
// Every step is kept to turns of about a radian, so what fails stays bounded; Fault::solver is set when
// a row lost its pivot, or a constraint is left with an error of more than a tenth of its segment.
template <int iterations_ = 4> struct DirectBanded {
  using Role = role::Solver;
  static constexpr FixedString name = "XPBD, direct banded";
  static constexpr int iterations = iterations_;
  static constexpr bool needs_chain = true;
  template <class C> static constexpr bool takes = is_along_chain<C>;
  template <class Set> using ScratchFields = typename Chain<rows_t<Set>>::ScratchFields;

  template <class Set, class Team, class Env, class T, class... Cs>
  MPMPBD_HD static std::uint32_t begin(Team const& team, Env const& env, Tick<T> const&,
                                       TypeList<Cs...>) {
    using System = Chain<rows_t<Set>>;
    detail::each(team, env.template live<Beads>(), [&](std::int64_t b) {
      env.template set<typename System::Predicted>(b, env.template get<bead::Position>(b));
    });
    forget<System>(team, env, rows_t<Set>{});
    return 0;
  }

  template <class Set, class Team, class Env, class T, class... Cs>
  MPMPBD_HD static std::uint32_t iterate(Team const& team, Env const& env, Tick<T> const& tick,
                                         TypeList<Cs...>) {
    using System = Chain<rows_t<Set>>;
    T const dt2 = tick.dt * tick.dt;
    std::uint32_t faults = 0;
    team.one([&] { lay_out<System>(env, dt2, rows_t<Set>{}); });
    team.sync();
    clear<System>(team, env, rows_t<Set>{});
    (evaluate<System, Cs>(team, env), ...);
    assemble<System>(team, env, dt2, rows_t<Set>{});
    team.one([&] {
      T const errors = sum_of_errors<System>(env, rows_t<Set>{});
      if (!eliminate<System>(env, rows_t<Set>{}))
        faults |= static_cast<std::uint32_t>(Fault::solver);
      shorten<System>(env, dt2, errors, rows_t<Set>{});
    });
    team.sync();
    (add_multipliers<System, Cs>(team, env), ...);
    detail::each(team, env.template live<Beads>(), [&](std::int64_t b) {
      if (!(env.template get<bead::InverseMass>(b) > T(0))) return;
      env.template set<bead::Position>(b, env.template get<bead::Position>(b) +
                                              displacement<System>(env, b, dt2, rows_t<Set>{}));
      env.template set<typename System::Predicted>(
          b, env.template get<typename System::Predicted>(b) +
                 displacement<System>(env, b, dt2,
                                      typename detail::WithoutLengths<rows_t<Set>>::type{}));
    });
    team.sync();
    return faults;
  }

  // Nothing is lost silently: says so when the iterations did not solve the chain.
  template <class Set, class Team, class Env, class T, class... Cs>
  MPMPBD_HD static std::uint32_t end(Team const& team, Env const& env, Tick<T> const&,
                                     TypeList<Cs...>) {
    return (unsolved<Cs>(team, env) | ... | 0u);
  }

 private:
  template <class System, class Team, class Env, class... Cs>
  MPMPBD_HD static void forget(Team const& team, Env const& env, TypeList<Cs...>) {
    using T = typename Env::Scalar;
    detail::each(team, env.template live<Beads>(), [&](std::int64_t b) {
      (env.template set<typename System::template Force<Cs>>(b, T(0)), ...);
      (env.template set<typename System::template Length<Cs>>(b, T(0)), ...);
      (env.template set<typename System::template Gradient<Cs>>(b, {}), ...);
    });
    team.sync();
  }

  // A taut link as a spring of force density T/l [N/m] between beads b and b + 1.
  template <class System, class C, class Env>
  MPMPBD_HD static auto density(Env const& env, std::int64_t b) {
    using T = typename Env::Scalar;
    T const l = env.template get<typename System::template Length<C>>(b);
    T const f = env.template get<typename System::template Force<C>>(b);
    return is_length<C> && l > T(0) && f < T(0) ? -f / l : T(0);
  }
  // What a length does to a bead when it is pressed [N]: its force so far along its last gradient.
  template <class System, class C, class Env, class T>
  MPMPBD_HD static void add_pressure(Env const& env, std::int64_t bead_, Vec3<T>& sum) {
    if constexpr (is_length<C>) {
      for (int s = 0; s < 2 && bead_ - s >= 0; ++s) {
        T const f = env.template get<typename System::template Force<C>>(bead_ - s);
        if (!(f > T(0))) continue;
        auto const g = env.template get<typename System::template Gradient<C>>(bead_ - s);
        sum += f * vec(g[3 * s], g[3 * s + 1], g[3 * s + 2]);
      }
    }
  }
  // Lays the chain out under the forces found so far: tension acts along the segments where they end up,
  // not where they were predicted. One tridiagonal elimination, dominated by its diagonal.
  template <class System, class Env, class T, class... Cs>
  MPMPBD_HD static void lay_out(Env const& env, T dt2, TypeList<Cs...>) {
    std::int64_t const beads = env.template live<Beads>();
    Vec3<T> before{};
    T carry = T(0), left = T(0);
    for (std::int64_t b = 0; b < beads; ++b) {
      T const step = dt2 * env.template get<bead::InverseMass>(b);
      T const right = (density<System, Cs>(env, b) + ... + T(0));
      Vec3<T> force{};
      (add_pressure<System, Cs>(env, b, force), ...);
      T const pivot = T(1) / (T(1) + step * (left * (T(1) - carry) + right));
      before = pivot *
               (env.template get<typename System::Predicted>(b) + step * (force + left * before));
      carry = pivot * step * right;
      env.template set<typename System::Carry>(b, carry);
      env.template set<bead::Position>(b, before);
      left = right;
    }
    for (std::int64_t b = beads - 2; b >= 0; --b) {
      before = env.template get<bead::Position>(b) +
               env.template get<typename System::Carry>(b) * before;
      env.template set<bead::Position>(b, before);
    }
  }

  template <class System, class Team, class Env, class... Cs>
  MPMPBD_HD static void clear(Team const& team, Env const& env, TypeList<Cs...>) {
    using T = typename Env::Scalar;
    detail::each(team, env.template live<Beads>(), [&](std::int64_t b) {
      (env.template set<typename System::template Right<Cs>>(b, T(0)), ...);
      (env.template set<typename System::template Alpha<Cs>>(b, T(-1)), ...);
    });
    team.sync();
  }

  template <class C, class T, std::size_t... Is>
  MPMPBD_HD static auto flatten(Evaluation<C, T> const& e, std::index_sequence<Is...>) {
    Vec<T, 3 * point_count<C>> flat;
    for (int a = 0; a < 3; ++a)
      ((flat[3 * static_cast<int>(Is) + a] = gradient<static_cast<int>(Is)>(e)[a]), ...);
    return flat;
  }

  // How much of a force vector is along gradient g.
  template <class T, int n>
  MPMPBD_HD static T component(Vec<T, n> const& force, Vec<T, n> const& g) {
    T const size = dot(g, g);
    return size > T(0) ? dot(force, g) / size : T(0);
  }

  template <class System, class C, class Team, class Env>
  MPMPBD_HD static void evaluate(Team const& team, Env const& env) {
    using T = typename Env::Scalar;
    using Points = std::make_index_sequence<static_cast<std::size_t>(point_count<C>)>;
    detail::for_each_instance<C>(team, env, [&](std::int64_t slot) {
      auto const one = detail::load_instance<C>(env, slot);
      auto const b = one.slots[0];
      auto const g = flatten<C, T>(one.at, Points{});
      T f = one.multiplier[0];
      if constexpr (HasAcross<C>) {
        using Sideways = Across<C>;
        auto const side = C::across(one.x, one.k);
        auto const h = flatten<C, T>(side, Points{});
        // The force found so far is a vector: it keeps its direction when the joint's plane turns, or flips.
        auto const force = f * env.template get<typename System::template Gradient<C>>(b) +
                           env.template get<typename System::template Force<Sideways>>(b) *
                               env.template get<typename System::template Gradient<Sideways>>(b);
        f = component(force, g);
        T const f_side = component(force, h);
        env.template set<typename instance<C>::Multiplier>(slot, f);
        T const part = side.value[0];
        bool const acts = part > T(0) && (one.compliance > T(0) || part == T(1));
        T const alpha = acts ? one.compliance / part : T(-1);
        env.template set<typename System::template Gradient<Sideways>>(
            b, acts ? h : Vec<T, 3 * point_count<C>>{});
        env.template set<typename System::template Alpha<Sideways>>(b, alpha);
        env.template set<typename System::template Force<Sideways>>(b, acts ? f_side : T(0));
        env.template set<typename System::template Right<Sideways>>(b,
                                                                    acts ? -alpha * f_side : T(0));
      }
      env.template set<typename System::template Gradient<C>>(b, g);
      env.template set<typename System::template Right<C>>(b,
                                                           -(one.at.value[0] + one.compliance * f));
      env.template set<typename System::template Alpha<C>>(b, one.compliance);
      if constexpr (is_length<C>) {  // the length at C = 0; add_multipliers adds the stretch
        auto const d =
            env.template get<bead::Position>(one.slots[1]) - env.template get<bead::Position>(b);
        env.template set<typename System::template Length<C>>(b, norm(d) - one.at.value[0]);
      }
    });
  }

  // dt^2 sum over shared beads of w grad_a . grad_b, for A at bead i and B at bead j <= i.
  template <class System, class A, class B, class Env, class T>
  MPMPBD_HD static T coupling(Env const& env, std::int64_t i, std::int64_t j, T dt2) {
    auto const a = env.template get<typename System::template Gradient<A>>(i);
    auto const b = env.template get<typename System::template Gradient<B>>(j);
    std::int64_t const end = min(i + point_count<A>, j + point_count<B>);
    T sum = T(0);
    for (std::int64_t q = i; q < end; ++q) {
      int const p = 3 * static_cast<int>(q - i), r = 3 * static_cast<int>(q - j);
      sum += env.template get<bead::InverseMass>(q) *
             (a[p] * b[r] + a[p + 1] * b[r + 1] + a[p + 2] * b[r + 2]);
    }
    return dt2 * sum;
  }

  template <class System, class A, class B, class Env, class T, class Band>
  MPMPBD_HD static void assemble_pair(Env const& env, std::int64_t i, T dt2, Band& band) {
    constexpr int width = System::half_band + 1;
    constexpr int from = System::template place<A>;
    for (int s = 0; s < point_count<B> && i - s >= 0; ++s) {
      int const offset = s * System::kinds + from - System::template place<B>;
      if (offset >= 0 && offset < width && has<System, A>(env, i) && has<System, B>(env, i - s))
        band[from * width + offset] = coupling<System, A, B>(env, i, i - s, dt2);
    }
  }
  template <class System, class A, class Env, class T, class Band, class... Bs>
  MPMPBD_HD static void assemble_row(Env const& env, std::int64_t i, T dt2, Band& band,
                                     TypeList<Bs...>) {
    (assemble_pair<System, A, Bs>(env, i, dt2, band), ...);
    constexpr int diagonal = System::template place<A> * (System::half_band + 1);
    if (has<System, A>(env, i))
      band[diagonal] += env.template get<typename System::template Alpha<A>>(i);
    else
      band[diagonal] = T(1);
  }
  template <class System, class Team, class Env, class T, class... Cs>
  MPMPBD_HD static void assemble(Team const& team, Env const& env, T dt2, TypeList<Cs...> list) {
    detail::each(team, env.template live<Beads>(), [&](std::int64_t b) {
      value_t<typename System::Band, T> band{};
      (assemble_row<System, Cs>(env, b, dt2, band, list), ...);
      env.template set<typename System::Band>(b, band);
    });
    team.sync();
  }
  template <class System, class C, class Env>
  MPMPBD_HD static bool has(Env const& env, std::int64_t b) {
    return !(env.template get<typename System::template Alpha<C>>(b) < 0);
  }

  template <class System, class Env, class... Cs>
  MPMPBD_HD static auto rights(Env const& env, std::int64_t b, TypeList<Cs...>) {
    Vec<typename Env::Scalar, System::kinds> r;
    ((r[System::template place<Cs>] = env.template get<typename System::template Right<Cs>>(b)),
     ...);
    return r;
  }
  template <class System, class Env, class V, class... Cs>
  MPMPBD_HD static void set_rights(Env const& env, std::int64_t b, V const& r, TypeList<Cs...>) {
    (env.template set<typename System::template Right<Cs>>(b, r[System::template place<Cs>]), ...);
  }

  template <class System, class Env, class List>
  MPMPBD_HD static bool eliminate(Env const& env, List list) {
    return detail::eliminate_band<typename System::Band, System::kinds, System::half_band>(
        env, [&](std::int64_t b) { return rights<System>(env, b, list); },
        [&](std::int64_t b, auto const& r) { set_rights<System>(env, b, r, list); });
  }

  template <class System, class C, class Env, class T>
  MPMPBD_HD static void add_displacement(Env const& env, std::int64_t bead_, Vec3<T>& sum) {
    for (int s = 0; s < point_count<C> && bead_ - s >= 0; ++s) {
      auto const g = env.template get<typename System::template Gradient<C>>(bead_ - s);
      sum += env.template get<typename System::template Right<C>>(bead_ - s) *
             vec(g[3 * s], g[3 * s + 1], g[3 * s + 2]);
    }
  }
  // How far the changes of the multipliers move a bead [m].
  template <class System, class Env, class T, class... Cs>
  MPMPBD_HD static Vec3<T> displacement(Env const& env, std::int64_t b, T dt2, TypeList<Cs...>) {
    Vec3<T> sum{};
    (add_displacement<System, Cs>(env, b, sum), ...);
    return (dt2 * env.template get<bead::InverseMass>(b)) * sum;
  }

  // The length that the error of a bead's constraint stands for, |C + alpha f| / |grad C| [m].
  template <class System, class C, class Env>
  MPMPBD_HD static auto error_length(Env const& env, std::int64_t b) {
    using T = typename Env::Scalar;
    T const slope = norm(env.template get<typename System::template Gradient<C>>(b));
    return slope > T(0) ? abs(env.template get<typename System::template Right<C>>(b)) / slope
                        : T(0);
  }
  // The sum of all errors: how far one of them could carry the rest of the chain.
  template <class System, class Env, class... Cs>
  MPMPBD_HD static auto sum_of_errors(Env const& env, TypeList<Cs...>) {
    typename Env::Scalar sum{};
    for (std::int64_t b = 0; b < env.template live<Beads>(); ++b)
      ((sum += error_length<System, Cs>(env, b)), ...);
    return sum;
  }
  // A linear step is good while segments turn by less than a radian or so: shortens it to that.
  template <class System, class Env, class T, class List>
  MPMPBD_HD static void shorten(Env const& env, T dt2, T errors, List list) {
    std::int64_t const beads = env.template live<Beads>();
    T part = T(1);
    Vec3<T> x_before{}, move_before{};
    for (std::int64_t b = 0; b < beads; ++b) {
      auto const x = env.template get<bead::Position>(b);
      auto const move = displacement<System>(env, b, dt2, list);
      T const most = errors + (b > 0 ? norm(x - x_before) : T(0));
      T const asked = b > 0 ? norm(move - move_before) : T(0);
      if (asked * part > most) part = most / asked;
      if (!is_finite(asked)) part = T(0);
      x_before = x;
      move_before = move;
    }
    if (part == T(1)) return;
    for (std::int64_t b = 0; b < beads; ++b) {
      auto r = rights<System>(env, b, list);
      if (part > T(0))
        r *= part;
      else
        r = {};
      set_rights<System>(env, b, r, list);
    }
  }

  // Whether an instance of C is left with an error of more than a tenth of its first segment.
  template <class C, class Team, class Env>
  MPMPBD_HD static std::uint32_t unsolved(Team const& team, Env const& env) {
    using T = typename Env::Scalar;
    std::uint32_t faults = 0;
    detail::for_each_instance<C>(team, env, [&](std::int64_t slot) {
      auto const one = detail::load_instance<C>(env, slot);
      T const slope = norm(flatten<C, T>(
          one.at, std::make_index_sequence<static_cast<std::size_t>(point_count<C>)>{}));
      T const segment = norm(env.template get<bead::Position>(one.slots[1]) -
                             env.template get<bead::Position>(one.slots[0]));
      T const error = abs(one.at.value[0] + one.compliance * one.multiplier[0]);
      bool const moves = !is_held<C>(one.weights);
      if (moves && !(T(10) * error <= segment * slope))
        faults |= static_cast<std::uint32_t>(Fault::solver);
    });
    return faults;
  }
  template <class C, class W> MPMPBD_HD static bool is_held(W const& weights) {
    for (int i = 0; i < point_count<C>; ++i)
      if (weights[i] > 0) return false;
    return true;
  }

  template <class System, class C, class Team, class Env>
  MPMPBD_HD static void add_multipliers(Team const& team, Env const& env) {
    detail::for_each_instance<C>(team, env, [&](std::int64_t slot) {
      auto const first = get_vector<typename instance<C>::Index>(env, slot)[0];
      auto const f = env.template get<typename instance<C>::Multiplier>(slot) +
                     env.template get<typename System::template Right<C>>(first);
      env.template set<typename instance<C>::Multiplier>(slot, f);
      env.template set<typename System::template Force<C>>(first, f);
      if constexpr (HasAcross<C>) {
        using Sideways = Across<C>;
        env.template set<typename System::template Force<Sideways>>(
            first, env.template get<typename System::template Force<Sideways>>(first) +
                       env.template get<typename System::template Right<Sideways>>(first));
      }
      if constexpr (is_length<C>) {
        auto const l = env.template get<typename System::template Length<C>>(first);
        env.template set<typename System::template Length<C>>(
            first, l - env.template get<typename System::template Alpha<C>>(first) * f);
      }
    });
  }
};

}  // namespace mpmpbd
