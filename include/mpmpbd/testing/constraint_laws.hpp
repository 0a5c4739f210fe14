// The laws of a Constraint. docs/concepts/constraint.md says where each comes from.
#pragma once

#include <mpmpbd/coupling/team.hpp>
#include <mpmpbd/pbd/access.hpp>
#include <mpmpbd/pbd/assembly.hpp>
#include <mpmpbd/testing/law.hpp>
#include <mpmpbd/testing/samples.hpp>

namespace mpmpbd {

namespace testing {

// A quaternion (w, x, y, z) turned by a rotation vector in world axes, as a constraint's blocks mean it.
inline Vec<double, 4> turned(Vec<double, 4> const& q, Vec3<double> const& w) {
  double const angle = norm(w);
  Vec3<double> const s = angle > 0 ? mpmpbd::sin(angle / 2) / angle * w : Vec3<double>{};
  double const c = mpmpbd::cos(angle / 2);
  Vec3<double> const v{{q[1], q[2], q[3]}};
  Vec3<double> const r = c * v + q[0] * s + cross(s, v);
  return {{c * q[0] - dot(s, v), r[0], r[1], r[2]}};
}

// Evaluates constraint C in precision T and moves its unknowns in double. `scale` is the length [m] that
// the configurations have.
template <class C, class T> class ConstraintProbe {
 public:
  static constexpr int unknowns = C::Unknowns::size;
  static constexpr int columns = []<class... Us>(TypeList<Us...>) {
    return (Us::degrees + ...);
  }(typename C::Unknowns{});
  static constexpr int rows = C::dimension;
  using X = ValuesOf<C, double>;
  using Columns = Vec<double, columns>;
  struct Result {
    Vec<double, rows> value;
    Mat<double, rows, columns> gradient;
  };

  ConstraintProbe(parameters_t<C, double> const& k, double scale) : k_(k), scale_(scale) {}
  double scale() const { return scale_; }

  template <class Function> static void for_each_unknown(Function const& f) {
    int column = 0;
    [&]<std::size_t... Is, class... Us>(std::index_sequence<Is...>, TypeList<Us...>) {
      ((f.template operator()<static_cast<int>(Is), Us>(column), column += Us::degrees), ...);
    }
    (std::make_index_sequence<static_cast<std::size_t>(unknowns)>{}, typename C::Unknowns{});
  }

  // Numbers that are exact in T, so that evaluations in T and in double see the same configuration.
  X random(Samples& samples) const {
    X x{};
    for_each_unknown([&]<int I, class U>(int) {
      auto place = [&] { return cast<double>(cast<T>(scale_ * samples.matrix<3>(-1.0, 1.0))); };
      auto frame = [&] {
        auto q = samples.matrix<4>(-1.0, 1.0);
        q *= 1.0 / norm(q);
        return cast<double>(cast<T>(q));
      };
      if constexpr (std::is_same_v<U, unknown::RigidBody>)
        get<I>(x) = {place(), frame()};
      else if constexpr (std::is_same_v<U, unknown::Orientation>)
        get<I>(x) = frame();
      else
        get<I>(x) = place();
    });
    return x;
  }

  X moved(X x, Columns const& d) const {
    for_each_unknown([&]<int I, class U>(int c) {
      auto part = [&](int from) { return vec(d[c + from], d[c + from + 1], d[c + from + 2]); };
      if constexpr (std::is_same_v<U, unknown::RigidBody>) {
        get<I>(x).position += part(0);
        get<I>(x).orientation = turned(get<I>(x).orientation, part(3));
      } else if constexpr (std::is_same_v<U, unknown::Orientation>) {
        get<I>(x) = turned(get<I>(x), part(0));
      } else {
        get<I>(x) += part(0);
      }
    });
    return x;
  }

  Result evaluate(X const& x) const {
    return result(C::evaluate(in<T>(x), cast_parameters<C, T, double>(k_)));
  }
  Result evaluate_in_double(X const& x) const { return result(C::evaluate(x, k_)); }
  Vec<double, rows> compliance() const {
    Vec<double, rows> ones{};
    for (int i = 0; i < rows; ++i) ones[i] = 1;
    return mpmpbd::detail::scaled(C::compliance(k_), ones);
  }

  // Columns that are lengths, counted in `scale`, so that entries compare with those of angles.
  double unit(int column) const { return is_rotation(column) ? 1.0 : scale_; }
  static bool is_rotation(int column) {
    bool rotation = false;
    for_each_unknown([&]<int I, class U>(int c) {
      if (column >= c && column < c + U::degrees)
        rotation = std::is_same_v<U, unknown::Orientation> ||
                   (std::is_same_v<U, unknown::RigidBody> && column >= c + 3);
    });
    return rotation;
  }
  double size(Result const& r) const {
    double most = 0;
    for (int c = 0; c < columns; ++c)
      for (int i = 0; i < rows; ++i) most = max(most, abs(r.gradient(i, c)) * unit(c));
    return most;
  }

  // One projection onto C = 0 in double: unit masses, inertia scale^2.
  X projected(X const& x) const {
    auto const r = evaluate_in_double(x);
    if (C::kind == ConstraintKind::inequality && !(r.value[0] < 0)) return x;
    Mat<double, rows, rows> K{};
    auto G = r.gradient;
    for (int c = 0; c < columns; ++c)
      for (int i = 0; i < rows; ++i) G(i, c) *= unit(c);
    K = G * transpose(G);
    auto const lambda = mpmpbd::detail::solve_small(K, -r.value);
    auto d = transpose(G) * lambda;
    for (int c = 0; c < columns; ++c) d[c] *= unit(c);
    return moved(x, d);
  }

  template <class To> static ValuesOf<C, To> in(X const& x) {
    ValuesOf<C, To> y{};
    for_each_unknown([&]<int I, class U>(int) {
      if constexpr (std::is_same_v<U, unknown::RigidBody>)
        get<I>(y) = {cast<To>(get<I>(x).position), cast<To>(get<I>(x).orientation)};
      else
        get<I>(y) = cast<To>(get<I>(x));
    });
    return y;
  }

 private:
  template <class E> static Result result(E const& e) {
    Result r{};
    r.value = cast<double>(e.value);
    for_each_unknown([&]<int I, class U>(int c) {
      for (int j = 0; j < U::degrees; ++j)
        for (int i = 0; i < rows; ++i) r.gradient(i, c + j) = double(gradient<I>(e)(i, j));
    });
    return r;
  }

  parameters_t<C, double> k_;
  double scale_;
};

// The gradient against central differences of C in double.
template <class C, class T> Law gradient_law(ConstraintProbe<C, T> const& probe) {
  Samples samples(11);
  double worst = 0;
  for (int n = 0; n < 200; ++n) {
    auto const x = probe.random(samples);
    auto const r = probe.evaluate(x);
    double const size = probe.size(r);
    for (int c = 0; c < probe.columns; ++c) {
      typename ConstraintProbe<C, T>::Columns d{};
      double const h = 1e-6 * probe.unit(c);
      d[c] = h;
      auto const plus = probe.evaluate_in_double(probe.moved(x, d)),
                 minus = probe.evaluate_in_double(probe.moved(x, -d));
      for (int i = 0; i < probe.rows; ++i)
        worst = max(worst, abs((plus.value[i] - minus.value[i]) / (2 * h) - r.gradient(i, c)) *
                               probe.unit(c) / size);
    }
  }
  return {"gradient = central difference, relative", worst, sizeof(T) == 8 ? 1e-7 : 1e-4};
}

// Forces of a constraint inside a system balance: gradients sum to zero, and so do their moments.
template <class C, class T> void balance_laws(ConstraintProbe<C, T> const& probe, Laws& laws) {
  Samples samples(12);
  double force = 0, moment = 0;
  for (int n = 0; n < 200; ++n) {
    auto const x = probe.random(samples);
    auto const r = probe.evaluate(x);
    double const size = probe.size(r);
    for (int i = 0; i < probe.rows; ++i) {
      Vec3<double> sum{}, turn{};
      probe.for_each_unknown([&]<int I, class U>(int c) {
        auto block = [&](int from) {
          return vec(r.gradient(i, c + from), r.gradient(i, c + from + 1),
                     r.gradient(i, c + from + 2));
        };
        if constexpr (std::is_same_v<U, unknown::Orientation>) {
          turn += block(0);
        } else if constexpr (std::is_same_v<U, unknown::RigidBody>) {
          sum += block(0);
          turn += block(3) + cross(get<I>(x).position, block(0));
        } else {
          sum += block(0);
          turn += cross(get<I>(x), block(0));
        }
      });
      force = max(force, norm(sum) * probe.scale() / size);
      // The moments of a vector C in world axes turn with it: dC by a rotation w of everything is w x C.
      Vec3<double> own{};
      if constexpr (C::dimension == 3 && !has_own_axes<C>) {
        Vec3<double> e{};
        e[i] = 1;
        own = cross(Vec3<double>{{r.value[0], r.value[1], r.value[2]}}, e);
      }
      moment = max(moment, norm(turn - own) / size);
    }
  }
  double const limit = sizeof(T) == 8 ? 1e-12 : 2e-5;
  laws.push_back({"gradients sum to zero, relative", force, limit});
  laws.push_back({"moments of the gradients sum to zero, relative", moment, limit});
}

// C does not change when everything is moved and turned together (the length of C, if it is a vector in world axes).
template <class C, class T> Law frame_law(ConstraintProbe<C, T> const& probe) {
  Samples samples(13);
  double worst = 0;
  for (int n = 0; n < 200; ++n) {
    auto const x = probe.random(samples);
    Vec3<double> const w = samples.uniform(0.1, 3.0) * samples.unit_vector();
    Vec3<double> const shift = probe.scale() * samples.matrix<3>(-2.0, 2.0);
    Vec<double, 4> const q = turned({{1, 0, 0, 0}}, w);
    auto y = x;
    probe.for_each_unknown([&]<int I, class U>(int) {
      if constexpr (std::is_same_v<U, unknown::RigidBody>) {
        get<I>(y).position = quaternion::rotate(q, get<I>(x).position) + shift;
        get<I>(y).orientation = turned(get<I>(x).orientation, w);
      } else if constexpr (std::is_same_v<U, unknown::Orientation>) {
        get<I>(y) = turned(get<I>(x), w);
      } else {
        get<I>(y) = quaternion::rotate(q, get<I>(x)) + shift;
      }
    });
    auto const a = probe.evaluate(x), b = probe.evaluate(y);
    double const change = C::dimension == 1 || has_own_axes<C> ? norm(a.value - b.value)
                                                               : abs(norm(a.value) - norm(b.value));
    worst = max(worst, change / probe.size(a));
  }
  return {"C is the same after a rigid motion, relative", worst, sizeof(T) == 8 ? 1e-12 : 2e-5};
}

// A projection brings C nearer to its law, from any configuration in which C can be improved.
template <class C, class T> Law projection_law(ConstraintProbe<C, T> const& probe) {
  Samples samples(14);
  double worst = 0;
  for (int n = 0; n < 500; ++n) {
    auto const x = probe.random(samples);
    auto wrong = [&](auto const& y) {
      auto const v = probe.evaluate_in_double(y).value;
      return C::kind == ConstraintKind::inequality ? max(0.0, -v[0]) : norm(v);
    };
    double const before = wrong(x);
    if (before > 1e-9 * probe.size(probe.evaluate(x)))
      worst = max(worst, wrong(probe.projected(x)) / before);
  }
  return {"|C| after one projection / before", worst, 1.0 - 1e-9};
}

// Frames that are equal, half a turn apart across and along, and without length; else as drawn.
inline Vec<double, 4> degenerate_frame(int shape, int number, Vec<double, 4> const& drawn) {
  if (shape == 3) return {};
  if (shape > 3) return drawn;
  Vec<double, 4> q{};
  q[number % 2 == 0 || shape == 0 ? 0 : 2 * shape - 1] = 1;
  return q;
}

// C and its gradients stay finite where geometry loses its meaning, and so does a projection.
template <class C, class T> Law finite_law(ConstraintProbe<C, T> const& probe) {
  Samples samples(15);
  int lost = 0;
  for (int shape = 0; shape < 8; ++shape) {
    for (double size : {0.0, 1e-30, 1e-12, 1.0, 1e6}) {
      auto x = probe.random(samples);
      probe.for_each_unknown([&]<int I, class U>(int) {
        // All at one point; on a line; folded; first two together; last two together; nearly straight; as drawn.
        double const along[7] = {0,         double(I), double(I % 2), double(I > 1), double(I == 0),
                                 double(I), 0};
        Vec3<double> const at =
            probe.scale() * size *
            vec(shape < 7 ? along[shape] : 0.0, shape == 5 && I == 1 ? 1e-9 : 0.0, 0.0);
        if constexpr (std::is_same_v<U, unknown::RigidBody>)
          get<I>(x).position = at;
        else if constexpr (std::is_same_v<U, unknown::Orientation>)
          get<I>(x) = degenerate_frame(shape, I, get<I>(x));
        else if (shape < 6)
          get<I>(x) = at;
      });
      auto const r = probe.evaluate(x);
      if (!is_finite(r.value) || !is_finite(r.gradient)) ++lost;
      if (!is_finite(probe.evaluate_in_double(probe.projected(x)).value)) ++lost;
    }
  }
  return {"degenerate configurations that are not finite", double(lost), 0.0};
}

// The laws that need a solver: C alone, on its beads and frames, solved by XPBD.
template <class C, class T> class ConstraintBench {
 public:
  template <int iterations> struct Body : Pbd<Constraints<C>, Xpbd<iterations>> {};
  static constexpr std::size_t size = static_cast<std::size_t>(C::Unknowns::size);

  ConstraintBench(ConstraintProbe<C, T> const& probe, parameters_t<C, double> const& k)
      : probe_(probe), k_(k) {}

  // Largest displacement of a bead or frame that does not yield (any of them, in turn) under one solve.
  Law infinite_mass() const {
    Samples samples(16);
    double moved = 0;
    for (int n = 0; n < 20; ++n) {
      for (std::size_t held = 0; held < size; ++held) {
        auto run = make<2>(probe_.random(samples), held);
        auto const before = run.values();
        run.advance(T(0.01), {});
        auto const after = run.values();
        ConstraintProbe<C, T>::for_each_unknown([&]<int I, class U>(int) {
          if (static_cast<std::size_t>(I) == held)
            moved = max(moved, double(norm(get<I>(after) - get<I>(before))));
        });
      }
    }
    return {"displacement of an infinite mass", moved, 0.0};
  }

  // Load s grad C pulls the unknowns until the constraint holds it: then C = compliance s, for any step and
  // number of iterations. Relative error.
  Law static_stretch() const {
    Samples samples(17);
    double worst = 0;
    auto const compliance = probe_.compliance();
    double a = compliance[0];
    for (int i = 1; i < C::dimension; ++i) a = min(a, compliance[i]);
    // Of the range of C: one linear step errs by the square of it, rounding by a part of it.
    double const part = sizeof(T) == 8 ? 1e-8 : 1.5e-4;
    for (int n = 0; n < 3; ++n) {
      auto x = probe_.random(samples);
      for (int i = 0; i < 200; ++i) x = onto(x);
      auto const r = probe_.evaluate_in_double(x);
      double const range = probe_.size(r);
      if (!(range > 0)) continue;
      double const stretch = (C::kind == ConstraintKind::inequality ? -part : part) * range;
      double const omega = range / probe_.scale() / mpmpbd::sqrt(a * mass());
      for (double phase : {0.25, 1.0, 2.0}) {
        worst = max(worst, settle<1>(x, stretch, phase / omega));
        worst = max(worst, settle<9>(x, stretch, phase / omega));
      }
    }
    return {"static stretch = compliance x load, relative", worst, sizeof(T) == 8 ? 1e-6 : 1e-2};
  }

 private:
  static constexpr double mass() { return 0.037; }
  double inertia() const { return mass() * probe_.scale() * probe_.scale(); }

  // Towards C = 0 from either side, so that an inequality starts where it begins to act.
  auto onto(ValuesOf<C, double> const& x) const {
    auto const r = probe_.evaluate_in_double(x);
    auto const K = r.gradient * transpose(r.gradient);
    return probe_.moved(x, transpose(r.gradient) * mpmpbd::detail::solve_small(K, -r.value));
  }

  template <class B> struct Run {
    using Store = State<T, typename B::AllFields>;
    Store store{1};
    Vec<std::int64_t, C::Unknowns::size> slots{};
    std::int64_t step = 0;

    auto environment() { return access_environment(store, 0, typename Store::Domains{}); }
    auto values() const {
      ValuesOf<C, T> x{};
      mpmpbd::detail::for_each_kept<C>([&]<class U, class I>(U, I) {
        get<I::value>(x) = store.template get<typename Kept<U>::Value>(0, slots[I::value]);
      });
      return x;
    }
    // One step under the load s along the gradients of C.
    void advance(T dt, Vec<T, C::dimension> const& s) {
      B::step(Solo{}, environment(), Tick<T>{dt, dt, step++},
              [&](auto const&, auto const& e, Tick<T> const& tick) {
                auto const at = C::evaluate(values(), mpmpbd::load_parameters<C>(e, 0));
                mpmpbd::detail::for_each_kept<C>([&]<class U, class I>(U, I) {
                  using Rate = std::conditional_t<std::is_same_v<U, unknown::Point>, bead::Velocity,
                                                  frame::AngularVelocity>;
                  auto const slot = slots[I::value];
                  auto const w = e.template get<typename Kept<U>::Mobility>(slot);
                  e.template set<Rate>(slot,
                                       e.template get<Rate>(slot) +
                                           (tick.dt * w) * (transpose(gradient<I::value>(at)) * s));
                });
              });
    }
  };

  // `held` is the unknown that does not yield.
  template <int iterations> auto make(ValuesOf<C, double> const& x, std::size_t held = size) const {
    using B = Body<iterations>;
    RodAssembly<B> rod;
    Run<B> run;
    typename mpmpbd::detail::InstanceList<C>::Slots slots{};
    mpmpbd::detail::for_each_kept<C>([&]<class U, class I>(U, I) {
      constexpr auto i = static_cast<std::size_t>(I::value);
      if constexpr (std::is_same_v<U, unknown::Point>) {
        slots[i] = rod.add_bead(get<I::value>(x), mass());
        if (i == held) rod.prescribe(slots[i]);
      } else {
        slots[i] = rod.add_frame(get<I::value>(x), inertia());
        if (i == held) rod.prescribe_frame(slots[i]);
      }
      run.slots[I::value] = slots[i];
    });
    rod.template add<C>(slots, k_);
    for_each_type(typename Run<B>::Store::Domains{}, [&]<class D>(std::type_identity<D>) {
      run.store.template table<D>().resize(1, static_cast<std::int64_t>(size));
    });
    rod.write(run.store, 0);
    return run;
  }

  template <int iterations>
  double settle(ValuesOf<C, double> const& x, double stretch, double dt) const {
    auto run = make<iterations>(x);
    auto const compliance = probe_.compliance();
    Vec<T, C::dimension> s;
    for (int i = 0; i < C::dimension; ++i) s[i] = T(stretch / compliance[i]);
    for (int n = 0; n < 600; ++n) run.advance(T(dt), s);
    auto const at = C::evaluate(run.values(), cast_parameters<C, T, double>(k_));
    double worst = 0;
    for (int i = 0; i < C::dimension; ++i)
      worst = max(worst, abs(double(at.value[i]) - stretch) / abs(stretch));
    return worst;
  }

  ConstraintProbe<C, T> probe_;
  parameters_t<C, double> k_;
};

}  // namespace testing

// All laws of constraint C in precision T. Parameters with a compliance above 0; `scale` [m] is the size
// of the configurations that they are tried in.
template <class C, class T> Laws constraint_laws(parameters_t<C, double> const& k, double scale) {
  static_assert(check_constraint<C>());
  testing::ConstraintProbe<C, T> const probe(k, scale);
  Laws laws{testing::gradient_law(probe)};
  if constexpr (is_frame_invariant<C>) {
    testing::balance_laws(probe, laws);
    laws.push_back(testing::frame_law(probe));
  }
  laws.push_back(testing::projection_law(probe));
  laws.push_back(testing::finite_law(probe));
  if constexpr (acts_on_rod_only<C>) {
    testing::ConstraintBench<C, T> const bench(probe, k);
    laws.push_back(bench.infinite_mass());
    laws.push_back(bench.static_stretch());
  }
  return laws;
}

}  // namespace mpmpbd
