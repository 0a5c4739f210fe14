// The laws of an Effect, by the slot it acts in. docs/concepts/effect.md says where each comes from.
#pragma once

#include <mpmpbd/effects/concepts.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/fields.hpp>
#include <mpmpbd/testing/law.hpp>
#include <mpmpbd/testing/samples.hpp>

namespace mpmpbd {

namespace testing {

template <class E, class T> class EffectProbe {
 public:
  using Item = detail::Archetype<E, T>;
  using K = parameters_t<parameter_owner_t<E>, T>;
  static constexpr bool on_stress = contains<typename Item::List, particle::Stress>;
  static constexpr bool on_acceleration = contains<typename E::Writes, particle::Acceleration>;

  explicit EffectProbe(parameters_t<parameter_owner_t<E>, double> const& k)
      : k_(cast_parameters<parameter_owner_t<E>, T, double>(k)) {}

  void apply(Item& item, double dt) const { E::apply(item, k_, Tick<T>{T(dt), T(dt), 7}); }

  // An item in the middle of a run: known fields at random, history of its own at zero.
  static Item item(Samples& random) {
    Item i{};
    set<node::Position>(i, random.matrix<3>(-0.3, 0.7));
    set<node::Velocity>(i, random.matrix<3>(-2, 2));
    set<node::Mass>(i, random.log_uniform(1e-9, 1e-3));
    set<particle::Position>(i, random.matrix<3>(-0.3, 0.7));
    set<particle::Velocity>(i, random.matrix<3>(-2, 2));
    set<particle::Mass>(i, random.log_uniform(1e-9, 1e-3));
    set<particle::Volume>(i, random.log_uniform(1e-12, 1e-6));
    set<particle::Deformation>(i, random.deformation(0.6, 1.6));
    set<particle::Affine>(i, random.template matrix<3, 3>(-20, 20));
    set<particle::Gradient>(i, random.template matrix<3, 3>(-20, 20));
    auto const S = random.template matrix<3, 3>(-3e3, 3e3);
    set<particle::Stress>(i, S + transpose(S));
    set<particle::Fibre>(i, random.unit_vector());
    set<bead::Position>(i, random.matrix<3>(-0.3, 0.7));
    set<bead::Velocity>(i, random.matrix<3>(-2, 2));
    set<bead::InverseMass>(i, random.log_uniform(1e2, 1e6));
    set<particle::BodyForce>(i, random.matrix<3>(-20, 20));
    return i;
  }
  static bool finite(Item const& item) {
    bool ok = true;
    for_each_field(typename Item::List{}, [&](auto f) {
      if constexpr (!std::is_integral_v<element_t<decltype(f), T>>) ok = ok && is_finite(item[f]);
    });
    return ok;
  }
  // The velocity that the effect acts on, or zero.
  static Vec3<double> velocity(Item const& i) {
    if constexpr (contains<typename Item::List, node::Velocity>)
      return cast<double>(i[node::Velocity{}]);
    else if constexpr (contains<typename Item::List, particle::Velocity>)
      return cast<double>(i[particle::Velocity{}]);
    else if constexpr (contains<typename Item::List, bead::Velocity>)
      return cast<double>(i[bead::Velocity{}]);
    else
      return {};
  }
  static Vec3<double> bead_position(Item const& i) {
    if constexpr (contains<typename Item::List, bead::Position>)
      return cast<double>(i[bead::Position{}]);
    else
      return {};
  }
  static Mat3<double> stress(Item const& i) {
    if constexpr (on_stress)
      return cast<double>(i[particle::Stress{}]);
    else
      return {};
  }
  template <class F, class V> static void set(Item& i, V const& value) {
    if constexpr (contains<typename Item::List, F>) {
      if constexpr (F::components == 1)
        i[F{}] = T(value);
      else
        i[F{}] = cast<T>(value);
    }
  }

 private:
  K k_;
};

// What an effect takes from the acceleration that others gave, relative.
template <class E, class T>
double acceleration_lost(EffectProbe<E, T> const& probe, Samples& random, double dt) {
  auto alone = EffectProbe<E, T>::item(random), added = alone;
  added[particle::Acceleration{}] = cast<T>(random.matrix<3>(-20, 20));
  auto const there = cast<double>(added[particle::Acceleration{}]);
  probe.apply(alone, dt);
  probe.apply(added, dt);
  auto const own = cast<double>(alone[particle::Acceleration{}]);
  auto const sum = cast<double>(added[particle::Acceleration{}]);
  return norm(sum - there - own) / (norm(there) + norm(own));
}

// A body sheared to and fro between random directions, with the stress of a neo-Hookean solid.
template <class E, class T> class ShearCycle {
 public:
  using Probe = EffectProbe<E, T>;
  ShearCycle(Probe const& probe, Samples& random) : probe_(probe), item_(Probe::item(random)) {
    auto const n = random.unit_vector();
    slide_ = outer(direction(cross(n, random.unit_vector())), n);
  }
  // Stress after a step to shear `to`, in a frame turned by R.
  Mat3<double> step(double to, double dt, Mat3<double> const& R) {
    auto const F = R * (Mat3<double>::identity() + to * slide_);
    auto const rate = dt > 0 ? (to - shear_) / dt : 0.0;
    shear_ = to;
    Local<double, Fields<particle::Deformation>> elastic{};
    elastic[particle::Deformation{}] = F;
    Probe::template set<particle::Deformation>(item_, F);
    Probe::template set<particle::Stress>(item_, NeoHookean::kirchhoff(elastic, modulus));
    auto const L = R * (rate * slide_) * transpose(R);
    Probe::template set<particle::Affine>(item_, L);
    Probe::template set<particle::Gradient>(item_, L);
    probe_.apply(item_, dt);
    return Probe::stress(item_);
  }
  Mat3<double> const& slide() const { return slide_; }
  static constexpr Lame<double> modulus{2.7e3, 9e3};

 private:
  Probe probe_;
  typename Probe::Item item_;
  Mat3<double> slide_{};
  double shear_ = 0.0;
};

}  // namespace testing

// Runs the laws that the slot of effect E asks for, in precision T, with parameters k and steps of
// about dt [s]; positions are drawn from [-0.3, 0.7] m, velocities from [-2, 2] m/s.
// An effect at_boundary that may add energy says so: `static constexpr bool drives = true`.
template <class E, class T>
Laws effect_laws(parameters_t<parameter_owner_t<E>, double> const& k, double dt = 1e-3) {
  using testing::Samples;
  using Probe = testing::EffectProbe<E, T>;
  static_assert(check_effect<E>());
  Probe const probe(k);
  constexpr double eps = double(epsilon<T>);
  Samples random(21);
  Laws laws;

  double broken = 0;
  for (int s = 0; s < 200; ++s) {
    auto item = Probe::item(random);
    probe.apply(item, dt);
    broken += Probe::finite(item) ? 0 : 1;
  }
  laws.push_back({"finite items stay finite", broken, 0});

  if constexpr (E::slot == Slot::on_grid || E::slot == Slot::before_solve) {
    double jump = 0, spread = 0;
    for (int s = 0; s < 200; ++s) {
      auto const start = Probe::item(random);
      auto still = start, once = start, often = start;
      probe.apply(still, 0.0);
      probe.apply(once, 8 * dt);
      for (int n = 0; n < 8; ++n) probe.apply(often, dt);
      auto const v = Probe::velocity(start);
      jump = max(jump, norm(Probe::velocity(still) - v) / norm(v));
      auto const change = norm(Probe::velocity(once) - v);
      spread = max(spread, norm(Probe::velocity(once) - Probe::velocity(often)) /
                               max(change, 100 * eps * norm(v)));
    }
    laws.push_back({"a step of no length changes nothing", jump, 4 * eps});
    laws.push_back({"one step does what eight steps do, relative to the change", spread, 0.01});
  }
  if constexpr (E::slot == Slot::at_boundary) {
    double twice = 0, gained = 0, stepped = 0;
    for (int s = 0; s < 2000; ++s) {
      auto const start = Probe::item(random);
      auto once = start, again = start, longer = start;
      probe.apply(once, dt);
      probe.apply(again, dt);
      probe.apply(again, dt);
      probe.apply(longer, 8 * dt);
      auto const v = Probe::velocity(start), held = Probe::velocity(once);
      twice = max(twice, norm(Probe::velocity(again) - held));
      stepped = max(stepped, norm(Probe::velocity(longer) - held));
      gained = max(gained, dot(held, held) / dot(v, v) - 1);
    }
    laws.push_back({"applied twice is applied once [m/s]", twice, 0});
    laws.push_back({"independent of the step [m/s]", stepped, 0});
    if constexpr (!requires { requires E::drives; })
      laws.push_back({"adds no energy to a node, relative", gained, 4 * eps});
  }
  if constexpr (E::slot == Slot::before_scatter && Probe::on_stress) {
    using testing::ShearCycle;
    constexpr int steps = 400;
    double turned = 0, unsymmetric = 0, pumped = 0;
    double const scale = ShearCycle<E, T>::modulus.mu;
    for (int s = 0; s < 20; ++s) {
      Samples one(100 + s), other(100 + s);
      ShearCycle<E, T> cycle(probe, one), turned_cycle(probe, other);
      auto const R = random.rotation();
      auto const I = Mat3<double>::identity();
      double work = 0, moved = 0, before = 0;
      Mat3<double> tau_before{};
      for (int n = 0; n <= steps; ++n) {
        double const shear = 0.4 * mpmpbd::sin(4 * pi<double> * n / steps);  // two cycles
        auto const tau = cycle.step(shear, dt, I);
        auto const tau_turned = turned_cycle.step(shear, dt, R);
        turned = max(turned, norm(tau_turned - R * tau * transpose(R)) / scale);
        unsymmetric = max(unsymmetric, norm(tau - transpose(tau)) / scale);
        if (n > 0) work += (shear - before) * dot(0.5 * (tau + tau_before), cycle.slide());
        moved += abs(shear - before);
        before = shear;
        tau_before = tau;
      }
      pumped = max(pumped, -work / (scale * moved));
    }
    laws.push_back({"objective, relative to a shear modulus", turned, 512 * eps});
    laws.push_back({"symmetric stress, relative to a shear modulus", unsymmetric, 64 * eps});
    laws.push_back({"gains no energy over closed cycles, relative", pumped, 1e-6 + 16 * eps});
    auto rest = Probe::item(random);
    Probe::template set<particle::Deformation>(rest, Mat3<double>::identity());
    for (int n = 0; n < 3; ++n) {
      Probe::template set<particle::Stress>(rest, Mat3<double>::zero());
      Probe::template set<particle::Affine>(rest, Mat3<double>::zero());
      Probe::template set<particle::Gradient>(rest, Mat3<double>::zero());
      probe.apply(rest, dt);
    }
    laws.push_back({"no stress from rest [Pa]", norm(Probe::stress(rest)), 0});
  }
  if constexpr (E::slot == Slot::before_scatter && Probe::on_acceleration) {
    double lost = 0;
    for (int s = 0; s < 200; ++s)
      lost = max(lost, testing::acceleration_lost<E, T>(probe, random, dt));
    laws.push_back({"adds to the acceleration of other effects, relative", lost, 4 * eps});
  }
  if constexpr (E::slot == Slot::after_solve) {
    double moved = 0;
    for (int s = 0; s < 200; ++s) {
      auto const start = Probe::item(random);
      auto item = start;
      probe.apply(item, dt);
      moved = max(moved, norm(Probe::velocity(item) - Probe::velocity(start)) +
                             norm(Probe::bead_position(item) - Probe::bead_position(start)));
    }
    laws.push_back({"does not move beads [m, m/s]", moved, 0});
  }
  return laws;
}

}  // namespace mpmpbd
