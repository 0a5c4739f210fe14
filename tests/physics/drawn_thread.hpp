// A suture in a block of gel, along a track that runs straight or turns round a bend. Its first end is moved along the
// track, to and fro if need be; the other is free and carries a load, as over a pulley.
#pragma once

#include <algorithm>

#include <mpmpbd/pbd/rod_builder.hpp>

#include "physics/back_end.hpp"
#include "physics/gel.hpp"

namespace test {

// A leg, an arc in the x-y plane that turns to the right, a leg; it begins along x. In cells.
struct ThreadTrack {
  Vec3<double> entry{};  // where it enters the gel
  double leg = 4;        // of each leg in the gel
  double radius = 0, turn = 0;
  double climb = 0;    // along z over the arc, so that a full turn does not meet itself
  double outside = 4;  // of each leg, before and behind the gel

  double arc() const { return radius * turn; }
  double embedded() const { return 2 * leg + arc(); }
  Vec3<double> at(double s) const {  // from where it enters
    double const past = s - leg - arc(),
                 a = std::clamp((s - leg) / std::max(radius, 1e-9), 0.0, turn);
    double const share = turn > 0 ? a / turn : 0;
    double const z = climb * (share - std::sin(2 * pi<double> * share) / (2 * pi<double>));
    auto const straight = std::min(s, leg) + (turn > 0 ? 0.0 : std::max(s - leg, 0.0));
    auto x = entry + vec(straight + radius * std::sin(a), radius * (std::cos(a) - 1), z);
    if (turn > 0 && past > 0) x += past * vec(std::cos(turn), -std::sin(turn), 0.0);
    return x;
  }
  Vec3<double> along(double s) const { return direction(at(s + 1e-4) - at(s - 1e-4)); }
};

struct DrawnCase {
  GelBlock block{};
  ThreadTrack track{};
  double segment = 0.75;             // of the thread [cells]
  double tension = 1;                // at the far end, in shear moduli times a cell's area
  double friction = 0.2, clamp = 0;  // clamp: pressure of the channel, in shear moduli
  double step = 0.25;                // in times of a shear wave over a cell
  // Of size 3-0: a monofilament, or a braid whose filaments slide on each other and bend more easily.
  RodMaterial thread{2e9, 1.15e-4, 1150, 0.05};
};

template <class Rods_>
struct DrawnScene : Scene<Gel, Rods_, Coupling<Embedded, Friction>, Damping, Walls<Sticky>> {};
using Stiff = Pbd<Constraints<Distance, Bend>>;
using Limp = Pbd<Constraints<Distance>>;

template <class Rods_, class Backend = BackEnd, class T = double> struct DrawnThread {
  using Run = Simulation<DrawnScene<Rods_>, Backend, T>;
  // A particle near the track, and which way the track goes there.
  struct Tracer {
    std::int64_t particle;
    Vec3<double> start, along;
  };

  DrawnCase c;
  int beads;
  Run run;
  std::vector<Tracer> tracers;
  double time = 0, work = 0;  // [gel times]; of the moved end and of the load, since the start [J]
  double moved = 0;           // of the first end, outwards [cells]

  explicit DrawnThread(DrawnCase const& c_, Backend where = {})
      : c(c_),
        beads(1 + static_cast<int>(
                      std::lround((c.track.embedded() + 2 * c.track.outside) / c.segment))),
        run(make(c, beads, where)) {
    for (std::int64_t p = 0; p < c.block.particles(); ++p) trace(p);
  }
  static Run make(DrawnCase c, int beads, Backend where) {
    std::vector<Vec3<double>> line;
    for (int k = 0; k < beads; ++k)
      line.push_back(gel_cell * c.track.at(c.segment * k - c.track.outside));
    RodAssembly<Rods_> rod;
    add_thread(rod, std::span<Vec3<double> const>(line), c.thread);
    auto capacity = rod.capacity();
    capacity.push_back({ContactPoints::name.view(), beads});
    c.block.substeps = 1;
    c.block.damping = 0.1 / gel_time();
    Run run(c.block.options(capacity), where);
    c.block.fill(run);
    run.template set<Embedded>({c.thread.radius});
    run.template set<Friction>({c.friction, c.clamp * modulus()});
    rod.write(run.state(), 0);
    run.state().template table<ContactPoints>().set_live(0, beads);
    run.state().template set<bead::InverseMass>(0, 0, T(0));  // it moves as it is told
    return run;
  }
  static double modulus() { return lame(gel_modulus, gel_poisson).mu; }
  static double force() { return modulus() * gel_cell * gel_cell; }  // unit of tensions [N]

  Vec3<double> particle(std::int64_t p) const {
    return 1 / gel_cell * cast<double>(run.state().template get<particle::Position>(0, p));
  }
  Vec3<double> bead(int k) const {
    return 1 / gel_cell * cast<double>(run.state().template get<bead::Position>(0, k));
  }
  Vec3<double> velocity(int k) const {
    return cast<double>(run.state().template get<bead::Velocity>(0, k));
  }
  // Half a cell from the track at most, and a cell inside.
  void trace(std::int64_t p) {
    auto const x = particle(p);
    double nearest = 0.5, where = -1;
    for (double s = 1; s < c.track.embedded() - 1; s += 0.1)
      if (norm(c.track.at(s) - x) < nearest) nearest = norm(c.track.at(s) - x), where = s;
    if (where >= 0) tracers.push_back({p, x, c.track.along(where)});
  }
  // How far the gel around the track has moved along it, in the mean [cells].
  double followed() const {
    double sum = 0;
    for (auto const& t : tracers) sum += dot(particle(t.particle) - t.start, t.along);
    return sum / double(tracers.size());
  }
  // Mean place of all gel [cells].
  Vec3<double> middle() const {
    Vec3<double> sum{};
    for (std::int64_t p = 0; p < c.block.particles(); ++p) sum += particle(p);
    return 1.0 / double(c.block.particles()) * sum;
  }
  // In units of force().
  double pulled() const { return tension(0); }
  double held() const { return tension(beads - 2); }
  double tension(int segment) const {
    return double(run.state().template get<bead::Tension>(0, segment)) / force();
  }

  // One step; the first end moves outwards at a speed, in shear waves. The load has grown after 40 gel times.
  void step(double speed) {
    double const dt = c.step * gel_time(), load = c.tension * force() * std::min(1.0, time / 40);
    auto& s = run.state();
    auto const end = c.track.along(c.track.embedded() + 0.5 * c.track.outside);
    auto const v = velocity(beads - 1);
    double const inverse = double(s.template get<bead::InverseMass>(0, beads - 1));
    s.template set<bead::Velocity>(0, beads - 1, cast<T>(v + load * dt * inverse * end));
    s.template set<bead::Velocity>(
        0, 0, cast<T>(-speed * gel_shear_speed() * c.track.along(-0.5 * c.track.outside)));
    run.step(dt);
    work += pulled() * force() * speed * gel_shear_speed() * dt +
            load * dt * dot(velocity(beads - 1), end);
    time += c.step;
    moved += speed * c.step;
  }
  // Until the load has grown and the gel is at rest; from then on nothing damps it but friction.
  void settle() {
    while (time < 60) step(0);
    run.template set<Damping>({0.0});
  }
  // Of gel and thread [J].
  double energy() const {
    auto const& s = run.state();
    double e = gel_energy(run, 0);
    double const l = c.segment * gel_cell;
    for (int k = 0; k < beads; ++k) {
      double const inverse = double(s.template get<bead::InverseMass>(0, k));
      auto const v = velocity(k);
      if (inverse > 0) e += 0.5 / inverse * dot(v, v);
      if (k == 0) continue;
      auto const stretch = gel_cell * norm(bead(k) - bead(k - 1)) - l;
      e += 0.5 * c.thread.axial_stiffness() / l * square(stretch);
      if (Rods_::Set::template has<Bend> && k + 1 < beads)
        e += 0.5 * c.thread.bending_stiffness() / l * square(joint(k));
    }
    return e;
  }
  double joint(int k) const {  // by which the thread turns at a bead [rad]
    auto const a = bead(k) - bead(k - 1), b = bead(k + 1) - bead(k);
    return std::atan2(norm(cross(a, b)), dot(a, b));
  }
};

// Blocks with gel around the track, held on the sides that no thread goes through.
inline DrawnCase straight_track() {
  DrawnCase c;
  c.block = {.high = {11, 9, 9}, .held_low = {-99, 3, 3}, .held_high = {99, 9, 9}};
  c.track = {.entry = vec(3.0, 6.13, 5.79)};
  return c;
}
inline DrawnCase right_angle() {
  DrawnCase c;
  c.block = {.high = {14, 14, 8}, .held_low = {-99, -99, 3}, .held_high = {14, 14, 8}};
  c.track = {.entry = vec(3.0, 11.13, 5.59), .leg = 4, .radius = 4, .turn = pi<double> / 2};
  return c;
}

}  // namespace test
