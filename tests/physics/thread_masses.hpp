// B21: a thread of any mass in a free block of gel, from 1e-4 to 1e4 of a full node per bead. Both have been
// kicked against each other, across and along the thread, and the gel swings; nothing acts from outside.
#pragma once

#include <utility>

#include "physics/back_end.hpp"
#include "physics/thread_in_gel.hpp"

namespace test {

struct ThreadMasses {
  // Largest energy of 200 steps above the least that any 200 before had, in shares of that at the start: all gain
  // there is, however slow. Within a swing the sum of both energies goes up and down by omega dt / 8, as in any
  // symplectic step.
  double energy_rise = 0;
  double momentum_error = 0;  // of the sum of sizes at the start
  double rounding = 0;        // that it may have on this back end
  double slip = 0;            // of a bead across its thread, against the gel around it [cells]
  double energy_left = 1;     // share at the end
  std::uint32_t status = 0;
};

struct FreeThreadInGel : Scene<Gel, ThreadInGel::Rods, Coupling<Embedded, Friction, Drag>> {};

// A bead and the gel particles around it, with weights that sum to one.
struct Tracer {
  std::int64_t bead;
  std::vector<std::pair<std::int64_t, double>> around;
  Vec3<double> start{};  // of the bead, from their mean
};

template <class T> struct KickedThread {
  ThreadInGel thread;
  Simulation<FreeThreadInGel, BackEnd, T> run;
  std::vector<Tracer> tracers;

  explicit KickedThread(double mass_ratio)
      : thread{.mass_ratio = mass_ratio}, run(thread.make<FreeThreadInGel, T>()) {
    run.template set<Friction>({0.2, 500.0});
    run.template set<Drag>({0.2});
    kick();
    for (std::int64_t k = 0; k < thread.beads(); ++k) trace(k);
  }
  Vec3<double> particle(std::int64_t i) const {
    return cast<double>(run.state().template get<particle::Position>(0, i));
  }
  Vec3<double> bead(std::int64_t k) const {
    return cast<double>(run.state().template get<bead::Position>(0, k));
  }
  double bead_mass(std::int64_t k) const {
    return 1 / double(run.state().template get<bead::InverseMass>(0, k));
  }
  double mass_of_beads() const {
    double sum = 0;
    for (std::int64_t k = 0; k < thread.beads(); ++k) sum += bead_mass(k);
    return sum;
  }
  double mass() const {  // of gel and thread [kg]
    return mass_of_beads() +
           gel_density * double(thread.block.particles()) / 8 * std::pow(gel_cell, 3);
  }
  // Relative speed of a tenth of shear waves, without momentum in all, and a wave in the gel.
  void kick() {
    double const u = 0.1 * gel_shear_speed();
    double const light = mass_of_beads(), all = mass();
    Vec3<double> const way = vec(0.6, 0.8, 0.0);
    for (std::int64_t i = 0; i < thread.block.particles(); ++i) {
      double const z = (particle(i)[2] / gel_cell - thread.block.low[2]) /
                       (thread.block.high[2] - thread.block.low[2]);
      run.state().template set<particle::Velocity>(
          0, i, cast<T>(u * (-light / all * way + vec(0.0, 0.5 * std::cos(pi<double> * z), 0.0))));
    }
    for (std::int64_t k = 0; k < thread.beads(); ++k)
      run.state().template set<bead::Velocity>(0, k, cast<T>((1 - light / all) * u * way));
  }
  // Beads at least a cell inside.
  void trace(std::int64_t k) {
    auto const x = (1 / gel_cell) * bead(k);
    if (x[0] < thread.block.low[0] + 1 || x[0] > thread.block.high[0] - 1) return;
    Tracer t{k, {}, {}};
    double sum = 0;
    for (std::int64_t i = 0; i < thread.block.particles(); ++i) {
      auto const d = (1 / gel_cell) * particle(i) - x;
      double w = 1;
      for (int a = 0; a < 3; ++a) w *= std::max(0.0, 1 - std::abs(d[a]));
      if (w > 0) t.around.push_back({i, w});
      sum += w;
    }
    for (auto& [i, w] : t.around) w /= sum;
    t.start = bead(k) - gel_at(t);
    tracers.push_back(t);
  }
  Vec3<double> gel_at(Tracer const& t) const {
    Vec3<double> x{};
    for (auto const& [i, w] : t.around) x += w * particle(i);
    return x;
  }
  // The block turns by little, so the places at the start need no turning.
  double slip() const {
    double most = 0;
    for (auto const& t : tracers) {
      auto d = bead(t.bead) - gel_at(t) - t.start;
      auto const along = direction(bead(t.bead + 1) - bead(t.bead - 1));
      d -= dot(d, along) * along;
      most = std::max(most, norm(d) / gel_cell);
    }
    return most;
  }
  double energy() const {
    double e = gel_energy(run, 0);
    auto const m = thread.material();
    double const l = thread.spacing * gel_cell;
    for (std::int64_t k = 0; k < thread.beads(); ++k) {
      auto const v = cast<double>(run.state().template get<bead::Velocity>(0, k));
      e += 0.5 * bead_mass(k) * dot(v, v);
      if (k == 0) continue;
      auto const a = bead(k) - bead(k - 1);
      e += 0.5 * m.axial_stiffness() / l * square(norm(a) - l);
      if (k + 1 == thread.beads()) continue;
      auto const b = bead(k + 1) - bead(k);
      e += 0.5 * m.bending_stiffness() / l * square(std::atan2(norm(cross(a, b)), dot(a, b)));
    }
    return e;
  }
  // Momentum, and the sum of its sizes.
  std::pair<Vec3<double>, double> momentum() const {
    Vec3<double> p{};
    double size = 0;
    auto add = [&](double m, Vec3<T> const& v) {
      p += m * cast<double>(v);
      size += m * norm(cast<double>(v));
    };
    auto const& s = run.state();
    for (std::int64_t i = 0; i < thread.block.particles(); ++i)
      add(double(s.template get<particle::Mass>(0, i)), s.template get<particle::Velocity>(0, i));
    for (std::int64_t k = 0; k < thread.beads(); ++k)
      add(bead_mass(k), s.template get<bead::Velocity>(0, k));
    return {p, size};
  }
};

template <class T> ThreadMasses swing(double mass_ratio, int steps) {
  KickedThread<T> scene(mass_ratio);
  ThreadMasses r;
  auto const [p0, size] = scene.momentum();
  double const e0 = scene.energy();
  double least = e0, now = 0;
  for (int i = 1; i <= steps; ++i) {
    scene.run.step(0.25 * gel_time());
    if (i <= 20 || i % 20 == 0) {
      now = std::max(now, scene.energy());
      r.momentum_error = std::max(r.momentum_error, norm(scene.momentum().first - p0) / size);
      r.slip = std::max(r.slip, scene.slip());
    }
    if (i % 200 != 0) continue;
    r.energy_rise = std::max(r.energy_rise, (now - least) / e0);
    least = std::min(least, std::exchange(now, 0.0));
  }
  double const dt = 0.25 * gel_time(), particles = double(scene.thread.block.particles());
  r.rounding =
      (sizeof(T) == 4 ? 2e-5 : 1e-12) +
      fixed_point_noise_of_mean(gel_cell, dt, steps, particles, quantum<T>) * scene.mass() / size;
  r.energy_left = scene.energy() / e0;
  r.status = scene.run.status(0);
  return r;
}

}  // namespace test
