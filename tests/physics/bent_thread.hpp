// T90: a taut thread bent by 90 degrees in a clamped block of tissue. It must neither cut through the
// tissue nor stretch. Block 8x8x5 cells, three sides clamped; straight 5 + arc of radius 2 + straight 5
// cells, 2 cells outside at each end, where it is pulled with T.
#pragma once

#include "physics/tissue_block.hpp"

namespace test {

enum class Scheme { embedded, cold_start, chord_tangents, contact_then_xpbd, dead_load };

struct BentCase {
  double tension = 4, bead_mass = 1e-4, dt = 0.1, friction = 0, end = 1900;
  double stiffness = 1000;  // EA
  Scheme scheme = Scheme::embedded;
  int segments = 16;
  double pull =
      0;  // speed at which the first end is drawn out after t = 100; then `tension` acts on the other
};

struct BentResult {
  double slip_early = 0, slip_end = 0,
         slip_most = 0;         // largest distance of tissue tracers from the thread
  double tissue = 0;            // mean displacement of the bend along its bisector
  double stretch = 0;           // largest strain after t = 100
  double energy_rise = 0;       // above its running minimum, relative
  double pulled = 0, held = 0;  // mean tensions of the two end segments, last 30 % of the time
  bool ran_away = false;
};

inline Vec3<double> bent_path(double s) {
  double const R = 2, straight = 5, arc = mpmpbd::pi<double> / 2 * R, z = 5.6;
  if (s < straight) return mpmpbd::vec(5 + s, 12.1, z);
  if (s < straight + arc) {
    double const a = (s - straight) / R;
    return mpmpbd::vec(10 + R * std::sin(a), 10.1 + R * std::cos(a), z);
  }
  return mpmpbd::vec(12.0, 10.1 - (s - straight - arc), z);
}
inline constexpr double bent_length = 10 + mpmpbd::pi<double>;

template <class T, class Form> struct BentThread {
  BentCase c;
  Rig<T, Form> rig{19, 19, 12};
  Tissue<T> tissue;
  std::vector<Vec3<T>> tracer, tracer0;
  std::vector<char> in_bend;
  std::vector<Vec3<T>> start;
  double time = 0, lowest = 1e300;
  BentResult result;
  long samples = 0;

  explicit BentThread(BentCase const& c_) : c(c_) {
    tissue.dt = rig.dt = rig.previous_dt = T(c.dt);
    tissue.fill(mpmpbd::vec(7.0, 7.0, 3.0), mpmpbd::vec(15.0, 15.0, 8.0), 0.4);
    tissue.fixed.assign(rig.mass.size(), 0);
    for (int k = 0, i = 0; k < 12; ++k)
      for (int b = 0; b < 19; ++b)
        for (int a = 0; a < 19; ++a, ++i)
          tissue.fixed[std::size_t(i)] = k <= 3 || k >= 8 || a >= 15 || b >= 15;
    for (int k = 0; k <= c.segments; ++k)
      rig.add_bead(mpmpbd::cast<T>(bent_path(bent_length * k / c.segments)), T(c.bead_mass));
    rig.allocate();
    rig.stretch_compliance = T(1 / c.stiffness);
    if (c.scheme == Scheme::contact_then_xpbd) rig.stretch_compliance = T(1e12);
    if constexpr (Form::FrictionLaw::grips) rig.friction = {T(c.friction), T(0)};
    start = rig.bead;
    for (int i = 0; i <= 60; ++i) {
      double const s = bent_length * i / 60;
      auto const p = mpmpbd::cast<T>(bent_path(s));
      if (p[0] < T(8.5) || p[1] < T(8.5)) continue;
      tracer.push_back(nearest(p));
      in_bend.push_back(s > 5 && s < bent_length - 5);
    }
    tracer0 = tracer;
  }
  Vec3<T> nearest(Vec3<T> const& p) const {
    Vec3<T> best{};
    T far = T(1e9);
    for (std::size_t k = 0; k + 1 < rig.bead.size(); ++k) {
      Vec3<T> const d = rig.bead[k + 1] - rig.bead[k];
      T const u = mpmpbd::clamp(mpmpbd::dot(p - rig.bead[k], d) / mpmpbd::dot(d, d), T(0), T(1));
      Vec3<T> const q = rig.bead[k] + u * d;
      if (mpmpbd::norm(p - q) < far) far = mpmpbd::norm(p - q), best = q;
    }
    return best;
  }
  double slip() const {
    double most = 0;
    for (auto const& p : tracer) most = std::max(most, double(mpmpbd::norm(p - nearest(p))));
    return most;
  }
  double energy() const {
    double e = tissue.energy();
    for (std::size_t k = 0; k < rig.bead.size(); ++k) {
      e += 0.5 * c.bead_mass * double(mpmpbd::dot(rig.bead_velocity[k], rig.bead_velocity[k]));
      if (k + 1 == rig.bead.size()) break;
      double const more = double(mpmpbd::norm(rig.bead[k + 1] - rig.bead[k]) - rig.rest_length[k]);
      e += 0.5 * c.stiffness / double(rig.rest_length[k]) * more * more;
    }
    return e + c.tension * double(rig.bead.front()[0] - start.front()[0] + rig.bead.back()[1] -
                                  start.back()[1]);
  }

  void load_ends() {
    T const pull = T(c.tension * std::min(1.0, time / 40) * c.dt / c.bead_mass);
    if (c.pull > 0) {
      rig.known.front() = 1;
      rig.bead_velocity.front() = time > 100 ? mpmpbd::vec(T(-c.pull), T(0), T(0)) : Vec3<T>{};
    } else {
      rig.bead_velocity.front()[0] -= pull;
    }
    rig.bead_velocity.back()[1] -= pull;
  }
  void couple() {
    auto x = rig.view();
    mpmpbd::Solo const team;
    mpmpbd::place_thread_points(team, x);
    if (c.scheme == Scheme::chord_tangents)
      for (auto& p : rig.points) p.axis = x.thread_work.links[p.segment].direction;
    mpmpbd::embed_points(team, x, rig.nodes());
    for (auto& p : rig.points) {
      p.contact = p.coverage >= T(0.25) ? Contact::member : Contact::off;
      if (c.scheme == Scheme::cold_start) p.impulse = {};
    }
    result.ran_away |= mpmpbd::exchange(team, x, rig.nodes()) != 0;
    if (c.scheme == Scheme::contact_then_xpbd) stretch_afterwards();
  }
  // The obvious order that fails: contact on velocities, then XPBD moves the beads.
  void stretch_afterwards() {
    auto old = rig.bead;
    std::vector<double> lambda(rig.bead.size(), 0.0);
    for (std::size_t k = 0; k < old.size(); ++k) old[k] -= rig.dt * rig.bead_velocity[k];
    double const w = 1 / c.bead_mass;
    for (int iteration = 0; iteration < 20; ++iteration)
      for (std::size_t k = 0; k + 1 < old.size(); ++k) {
        Vec3<T> const d = rig.bead[k + 1] - rig.bead[k];
        double const l = double(mpmpbd::norm(d));
        double const soft = double(rig.rest_length[k]) / (c.stiffness * c.dt * c.dt);
        double const step = (-(l - double(rig.rest_length[k])) - soft * lambda[k]) / (2 * w + soft);
        lambda[k] += step;
        rig.bead[k] -= T(w * step / l) * d;
        rig.bead[k + 1] += T(w * step / l) * d;
      }
    for (std::size_t k = 0; k < old.size(); ++k)
      rig.bead_velocity[k] = T(1 / c.dt) * (rig.bead[k] - old[k]);
  }

  // No thread at all: the forces of a line under tension T, T (t_k - t_{k-1}), laid on the tissue itself.
  void push_tissue() {
    double const T_now = c.tension * std::min(1.0, time / 40);
    std::vector<Vec3<T>> f(rig.bead.size());
    for (std::size_t k = 0; k + 1 < rig.bead.size(); ++k) {
      Vec3<T> const pull = T(T_now) * mpmpbd::direction(rig.bead[k + 1] - rig.bead[k]);
      f[k] += pull;
      f[k + 1] -= pull;
    }
    for (std::size_t k = 0; k < rig.bead.size(); ++k) {
      T w[27];
      int node[27];
      bool const end = k == 0 || k + 1 == rig.bead.size();
      T const mass = mpmpbd::embedding_weights<mpmpbd::QuadraticBSpline>(rig.lattice, rig.bead[k],
                                                                         rig.nodes(), w, node);
      for (std::size_t a = 0; a < 27 && !end && mass >= T(0.25); ++a) {
        auto const i = std::size_t(node[a]);
        rig.velocity[i] += rig.dt * w[a] * rig.inverse_mass[i][0] * f[k];
      }
    }
    for (auto& p : rig.bead) p += rig.dt * Tissue<T>::velocity_at(rig, p);
  }

  BentResult run() {
    long steps = 0;
    while (time < c.end && !result.ran_away) {
      tissue.damping = time < 100 ? T(0.1) : T(0);
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
    int bend = 0;
    for (std::size_t i = 0; i < tracer.size(); ++i)
      if (in_bend[i]) {
        result.tissue +=
            double(tracer0[i][0] - tracer[i][0] + tracer0[i][1] - tracer[i][1]) * std::sqrt(0.5);
        ++bend;
      }
    result.tissue /= bend;
    result.pulled /= double(std::max(samples, 1L));
    result.held /= double(std::max(samples, 1L));
    return result;
  }
  void sample() {
    for (auto const& p : rig.bead)
      result.ran_away |= !(p[0] > T(1.6) && p[0] < T(16) && p[1] > T(1.6) && p[1] < T(16) &&
                           p[2] > T(1.6) && p[2] < T(10));
    double const s = slip();
    result.ran_away |= !(s < 3);
    if (result.ran_away) return;
    if (time >= 190 && result.slip_early == 0) result.slip_early = s;
    if (time > 60) result.slip_most = std::max(result.slip_most, s);
    if (time > 45 && c.pull == 0) {
      double const e = energy();
      lowest = std::min(lowest, e);
      result.energy_rise = std::max(result.energy_rise, (e - lowest) / std::abs(lowest));
    }
    if (time > 100)
      for (std::size_t k = 0; k + 1 < rig.bead.size(); ++k)
        result.stretch = std::max(
            result.stretch,
            std::abs(double(mpmpbd::norm(rig.bead[k + 1] - rig.bead[k]) / rig.rest_length[k]) - 1));
    if (time > 0.7 * c.end) {
      result.pulled += double(rig.impulse.front()) / c.dt;
      result.held += double(rig.impulse[rig.bead.size() - 2]) / c.dt;
      ++samples;
    }
  }
};

}  // namespace test
