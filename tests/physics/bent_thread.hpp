// T90: a taut thread bent by 90 degrees in a clamped block of tissue. It must neither cut through the
// tissue nor stretch. Block 8x8x5 cells, three sides clamped; straight 5 + arc of radius 2 + straight 5
// cells, 2 cells outside at each end, where it is pulled with T.
#pragma once

#include <algorithm>

#include "physics/tissue_block.hpp"
#include "physics/units.hpp"

namespace test {

enum class Scheme {
  embedded,
  cold_start,
  chord_tangents,
  contact_then_xpbd,
  position_bias,
  dead_load
};

// All numbers in Units of the tissue; bead masses in those of a full grid node.
struct BentCase {
  double tension = 4, bead_mass = 1e-4, dt = 0.1, friction = 0, end = 1900;
  double stiffness = 1000;  // EA
  Scheme scheme = Scheme::embedded;
  int segments = 16;
  // Speed at which the first end is drawn out after t = 100; then `tension` acts on the other alone.
  double pull = 0;
  double lambda = 2;                      // of the tissue
  double radius = 0, clamp_pressure = 0;  // of the thread, and how the tissue grips it
  double drag = 0;  // per length and speed, in shear moduli times units of time
  Units unit{};
};

struct BentResult {
  double slip_early = 0, slip_end = 0,
         slip_most = 0;  // largest distance of tissue tracers from the thread [cells]
  double slide_early = 0, slide_end = 0;  // of the thread along itself, at the same times [cells]
  double tissue = 0;                      // mean displacement of the bend along its bisector
  double stretch = 0;                     // largest strain after t = 100
  double mean_stretch = 0;                // of the segment with the largest mean after t = 100
  double energy_rise = 0;                 // above its running minimum, relative
  double pulled = 0, held = 0;  // mean tensions of the two end segments, last 30 % of the time
  bool ran_away = false;
};

inline constexpr double bent_length = 10 + mpmpbd::pi<double>, bend_radius = 2;

inline Vec3<double> bent_path(double s) {
  double const R = bend_radius, straight = 5, arc = mpmpbd::pi<double> / 2 * R, z = 5.6;
  if (s < straight) return mpmpbd::vec(5 + s, 12.1, z);
  if (s < straight + arc) {
    double const a = (s - straight) / R;
    return mpmpbd::vec(10 + R * std::sin(a), 10.1 + R * std::cos(a), z);
  }
  return mpmpbd::vec(12.0, 10.1 - (s - straight - arc), z);
}

template <class T, class Form> struct BentThread {
  BentCase c;
  Units const& u = c.unit;
  T const cell = T(u.length);
  Rig<T, Form> rig{19, 19, 12, cell};
  Tissue<T> tissue;
  std::vector<Vec3<T>> tracer, tracer0;
  std::vector<char> in_bend;
  std::vector<Vec3<T>> start;
  std::vector<Vec3<T>> drift;  // of the tissue from each point of the thread, for the position bias
  double time = 0, lowest = 1e300;  // [units]
  BentResult result;
  long samples = 0;
  std::vector<double> strain_sum;  // per segment after t = 100
  long strains = 0;

  explicit BentThread(BentCase const& c_) : c(c_) {
    fill_tissue();
    add_thread();
    for (int i = 0; i <= 60; ++i) {
      double const s = bent_length * i / 60;
      Vec3<double> const p = bent_path(s);
      if (p[0] < 8.5 || p[1] < 8.5) continue;
      tracer.push_back(nearest(mpmpbd::cast<T>(u.length * p)));
      in_bend.push_back(s > 5 && s < bent_length - 5);
    }
    tracer0 = tracer;
  }
  void fill_tissue() {
    tissue.measure_in(u, rig, c.dt, c.lambda);
    tissue.fill(u.length * mpmpbd::vec(7.0, 7.0, 3.0), u.length * mpmpbd::vec(15.0, 15.0, 8.0),
                0.4);
    tissue.fixed.assign(rig.mass.size(), 0);
    for (int k = 0, i = 0; k < 12; ++k)
      for (int b = 0; b < 19; ++b)
        for (int a = 0; a < 19; ++a, ++i)
          tissue.fixed[std::size_t(i)] = k <= 3 || k >= 8 || a >= 15 || b >= 15;
  }
  void add_thread() {
    for (int k = 0; k <= c.segments; ++k)
      rig.add_bead(mpmpbd::cast<T>(u.length * bent_path(bent_length * k / c.segments)),
                   T(c.bead_mass * u.mass()));
    strain_sum.assign(std::size_t(c.segments), 0.0);
    auto const more = std::size_t(two_points() ? 2 * c.segments : 0);
    rig.allocate({}, std::vector<mpmpbd::ContactPoint<T>>(more));
    for (auto& p : rig.points) p.radius = T(c.radius * u.length);
    rig.stretch_compliance = T(1 / (c.stiffness * u.force()));
    if (c.scheme == Scheme::contact_then_xpbd) rig.stretch_compliance = T(1e12);
    if constexpr (Form::FrictionLaw::grips)
      rig.friction = {T(c.friction), T(c.clamp_pressure * u.modulus)};
    if constexpr (Form::DragLaw::drags) rig.drag = {T(c.drag * u.modulus * u.time())};
    start = rig.bead;
    drift.assign(rig.points.size(), Vec3<T>{});
  }
  Vec3<T> nearest(Vec3<T> const& p) const {
    Vec3<T> best{};
    T far = T(1e9);
    for (std::size_t k = 0; k + 1 < rig.bead.size(); ++k) {
      Vec3<T> const d = rig.bead[k + 1] - rig.bead[k];
      T const share =
          mpmpbd::clamp(mpmpbd::dot(p - rig.bead[k], d) / mpmpbd::dot(d, d), T(0), T(1));
      Vec3<T> const q = rig.bead[k] + share * d;
      if (mpmpbd::norm(p - q) < far) far = mpmpbd::norm(p - q), best = q;
    }
    return best;
  }
  double slip() const {
    double most = 0;
    for (auto const& p : tracer) most = std::max(most, double(mpmpbd::norm(p - nearest(p))));
    return most / u.length;
  }
  double slide() const {
    return 0.5 / u.length *
           double(start.front()[0] - rig.bead.front()[0] + rig.bead.back()[1] - start.back()[1]);
  }
  double energy() const {
    double e = tissue.energy();
    for (std::size_t k = 0; k < rig.bead.size(); ++k) {
      e += 0.5 * double(rig.bead_mass[k]) *
           double(mpmpbd::dot(rig.bead_velocity[k], rig.bead_velocity[k]));
      if (k + 1 == rig.bead.size()) break;
      double const more = double(mpmpbd::norm(rig.bead[k + 1] - rig.bead[k]) - rig.rest_length[k]);
      e += 0.5 * c.stiffness * u.force() / double(rig.rest_length[k]) * more * more;
    }
    return e + c.tension * u.force() *
                   double(rig.bead.front()[0] - start.front()[0] + rig.bead.back()[1] -
                          start.back()[1]);
  }

  double tension_now() const { return c.tension * u.force() * std::min(1.0, time / 40); }  // [N]
  void load_ends() {
    T const pull = T(tension_now()) * rig.dt / rig.bead_mass.front();
    if (c.pull > 0) {
      rig.known.front() = 1;
      rig.bead_velocity.front() =
          time > 100 ? mpmpbd::vec(T(-c.pull * u.speed()), T(0), T(0)) : Vec3<T>{};
    } else {
      rig.bead_velocity.front()[0] -= pull;
    }
    rig.bead_velocity.back()[1] -= pull;
  }
  // Two points per segment are what it was measured with; with points at the beads no harm of it was found.
  bool two_points() const { return c.scheme == Scheme::position_bias; }
  void couple() {
    auto x = rig.view();
    mpmpbd::Solo const team;
    mpmpbd::place_thread_points(team, x);
    if (two_points()) place_on_segments(x, {T(0.2113), T(0.7887)});
    if (c.scheme == Scheme::chord_tangents)
      for (auto& p : rig.points) p.axis = x.thread_work.links[p.segment].direction;
    mpmpbd::embed_points(team, x, rig.nodes());
    for (int q = 0; q < x.count(); ++q) {
      auto& p = x.points[q];
      bool const unused = two_points() && q < x.thread_points();
      p.contact = !unused && p.coverage >= T(0.25) ? Contact::member : Contact::off;
      if (c.scheme == Scheme::cold_start) p.impulse = {};
    }
    result.ran_away |=
        c.scheme == Scheme::position_bias ? !biased_exchange(x) : exchange_on_back_end(rig, x) != 0;
    if (c.scheme == Scheme::contact_then_xpbd) stretch_afterwards();
  }
  // A position error of the contact, fed back as a velocity in every sweep: what makes contact solvers
  // without memory hold. With a warm start the impulses remember it too.
  template <class View> bool biased_exchange(View const& x) {
    auto const nodes = rig.nodes();
    mpmpbd::Solo const team;
    mpmpbd::detail::Exchange e(team, x, nodes);
    e.begin();
    e.move_alone();
    e.warm_start();
    for (int i = 0; i < 2; ++i) {
      e.observe();
      for (std::size_t q = 0; q < drift.size(); ++q) x.work[q].u += bias(q);
      e.sweep(i == 0);
    }
    e.thread.solve_head();
    if (x.scratch->failed != 0) return false;
    e.finish();
    e.observe();
    for (std::size_t q = 0; q < drift.size(); ++q) {
      auto const slip = x.work[q].u - e.body_velocity(int(q));
      drift[q] = x.on[q] ? drift[q] + rig.dt * slip : Vec3<T>{};
      drift[q] -= mpmpbd::dot(drift[q], x.points[q].axis) * x.points[q].axis;
    }
    return true;
  }
  Vec3<T> bias(std::size_t q) const {
    Vec3<T> const v = T(0.2) / rig.dt * drift[q];
    return mpmpbd::min(T(1), T(0.05 * u.speed()) / (mpmpbd::norm(v) + T(1e-30))) * v;
  }
  // The obvious order that fails: contact on velocities, then XPBD moves the beads.
  void stretch_afterwards() {
    auto old = rig.bead;
    std::vector<double> lambda(rig.bead.size(), 0.0);
    for (std::size_t k = 0; k < old.size(); ++k) old[k] -= rig.dt * rig.bead_velocity[k];
    double const w = 1 / double(rig.bead_mass.front()), dt = double(rig.dt);
    for (int iteration = 0; iteration < 20; ++iteration)
      for (std::size_t k = 0; k + 1 < old.size(); ++k) {
        Vec3<T> const d = rig.bead[k + 1] - rig.bead[k];
        double const l = double(mpmpbd::norm(d));
        double const soft = double(rig.rest_length[k]) / (c.stiffness * u.force() * dt * dt);
        double const step = (-(l - double(rig.rest_length[k])) - soft * lambda[k]) / (2 * w + soft);
        lambda[k] += step;
        rig.bead[k] -= T(w * step / l) * d;
        rig.bead[k + 1] += T(w * step / l) * d;
      }
    for (std::size_t k = 0; k < old.size(); ++k)
      rig.bead_velocity[k] = T(1 / dt) * (rig.bead[k] - old[k]);
  }

  // No thread at all: the forces of a line under tension T, T (t_k - t_{k-1}), laid on the tissue itself.
  void push_tissue() {
    std::vector<Vec3<T>> f(rig.bead.size());
    for (std::size_t k = 0; k + 1 < rig.bead.size(); ++k) {
      Vec3<T> const pull = T(tension_now()) * mpmpbd::direction(rig.bead[k + 1] - rig.bead[k]);
      f[k] += pull;
      f[k + 1] -= pull;
    }
    for (std::size_t k = 0; k < rig.bead.size(); ++k) {
      T w[27];
      int node[27];
      bool const end = k == 0 || k + 1 == rig.bead.size();
      T const mass = mpmpbd::embedding_weights<mpmpbd::QuadraticBSpline>(rig.lattice, rig.bead[k],
                                                                         rig.nodes(), w, node);
      for (std::size_t a = 0; a < 27 && !end && mass >= T(0.25 * u.mass()); ++a) {
        auto const i = std::size_t(node[a]);
        rig.velocity[i] += rig.dt * w[a] * rig.inverse_mass[i][0] * f[k];
      }
    }
    for (auto& p : rig.bead) p += rig.dt * Tissue<T>::velocity_at(rig, p);
  }

  BentResult run() {
    long steps = 0;
    while (time < c.end && !result.ran_away) {
      tissue.damping = time < 100 ? T(0.1 / u.time()) : T(0);
      tissue.scatter(rig);
      if (c.scheme == Scheme::dead_load) {
        push_tissue();
      } else {
        load_ends();
        couple();
      }
      for (auto& p : tracer) p += rig.dt * Tissue<T>::velocity_at(rig, p);
      tissue.gather(rig);
      time += c.dt;
      if (++steps % 10 == 0) sample();
    }
    result.slip_end = slip();
    result.slide_end = slide();
    int bend = 0;
    for (std::size_t i = 0; i < tracer.size(); ++i)
      if (in_bend[i]) {
        result.tissue +=
            double(tracer0[i][0] - tracer[i][0] + tracer0[i][1] - tracer[i][1]) * std::sqrt(0.5);
        ++bend;
      }
    result.tissue /= bend * u.length;
    result.mean_stretch =
        *std::max_element(strain_sum.begin(), strain_sum.end()) / double(std::max(strains, 1L));
    result.pulled /= double(std::max(samples, 1L));
    result.held /= double(std::max(samples, 1L));
    return result;
  }
  void sample() {
    for (auto const& x : rig.bead) {
      Vec3<double> const p = 1 / u.length * mpmpbd::cast<double>(x);
      result.ran_away |=
          !(p[0] > 1.6 && p[0] < 16 && p[1] > 1.6 && p[1] < 16 && p[2] > 1.6 && p[2] < 10);
    }
    double const s = slip();
    result.ran_away |= !(s < 3);
    if (result.ran_away) return;
    if (time >= 190 && result.slip_early == 0) {
      result.slip_early = s;
      result.slide_early = slide();
    }
    if (time > 60) result.slip_most = std::max(result.slip_most, s);
    if (time > 45 && c.pull == 0) {
      double const e = energy();
      lowest = std::min(lowest, e);
      result.energy_rise = std::max(result.energy_rise, (e - lowest) / std::abs(lowest));
    }
    if (time > 100) measure_stretch();
    if (time > 0.7 * c.end) {
      double const per_step = double(rig.dt) * u.force();
      result.pulled += double(rig.impulse.front()) / per_step;
      result.held += double(rig.impulse[rig.bead.size() - 2]) / per_step;
      ++samples;
    }
  }
  void measure_stretch() {
    ++strains;
    for (std::size_t k = 0; k + 1 < rig.bead.size(); ++k) {
      double const strain =
          double(mpmpbd::norm(rig.bead[k + 1] - rig.bead[k]) / rig.rest_length[k]) - 1;
      strain_sum[k] += strain;
      result.stretch = std::max(result.stretch, std::abs(strain));
    }
  }
};

}  // namespace test
