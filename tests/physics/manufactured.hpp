// A neo-Hookean body that is made to follow a motion known in advance, by the body force which that motion
// takes: its error is that of the scheme.
#pragma once

#include <vector>

#include <mpmpbd/effects/body_force.hpp>

#include "physics/back_end.hpp"
#include "physics/plane_strain.hpp"

namespace test {

struct Manufacture {
  SimulationOptions options;
  SlipWalls walls;
  Vec3<double> origin;             // where X = 0 lies in the grid [m]
  std::vector<Vec3<double>> rest;  // X of the particles [m]
  double volume;                   // of each, at rest [m^3]
  double dt;                       // [s]
};

// Motion: `material`, `density`, position(X, t) [m], deformation(X, t), force(X, t) [N/kg].
template <class Body, class Motion, class T = double> class Manufactured {
 public:
  Manufactured(Motion const& motion, Manufacture const& make)
      : motion_(motion), make_(make), run_(make.options) {
    run_.template set<NeoHookean>(motion.material);
    run_.template set<Walls<Slip>>(make.walls);
    pure_flip(run_);
    std::vector<Vec3<double>> at;
    for (auto const& X : make.rest) at.push_back(make.origin + motion.position(X, 0.0));
    run_.add_particles(0, at, motion.density, make.volume);
    for (std::int64_t p = 0; p < count(); ++p) set_rates(p);
  }

  std::int64_t count() const { return static_cast<std::int64_t>(make_.rest.size()); }
  Vec3<double> const& rest(std::int64_t p) const { return make_.rest[static_cast<std::size_t>(p)]; }
  Vec3<double> displacement(std::int64_t p) const {
    return cast<double>(run_.state().template get<particle::Position>(0, p)) - make_.origin -
           rest(p);
  }
  Vec3<double> const& origin() const { return make_.origin; }
  std::uint32_t status() const { return run_.status(0); }
  auto& state() { return run_.state(); }
  auto const& state() const { return run_.state(); }

  // After every step, `then()`.
  template <class Then> void advance(int steps, Then const& then) {
    for (int n = 0; n < steps; ++n) {
      for (std::int64_t p = 0; p < count(); ++p)
        state().template set<particle::BodyForce>(0, p, cast<T>(motion_.force(rest(p), time_)));
      run_.step(make_.dt);
      time_ += make_.dt;
      then();
    }
  }
  void advance(int steps) {
    advance(steps, [] {});
  }

  // L2 error of the positions [m], over the particles for whose X `counts` holds.
  template <class Counts> double error(Counts const& counts) const {
    double sum = 0.0, points = 0.0;
    for (std::int64_t p = 0; p < count(); ++p) {
      if (!counts(rest(p))) continue;
      auto const d = rest(p) + displacement(p) - motion_.position(rest(p), time_);
      sum += dot(d, d);
      points += 1.0;
    }
    return mpmpbd::sqrt(sum / points);
  }

 private:
  // F, v and C at the start; rates by central differences, exact to 1e-8 of themselves.
  void set_rates(std::int64_t p) {
    auto const& X = rest(p);
    double const h = 0.01 * make_.dt;
    auto const F = motion_.deformation(X, 0.0);
    auto const turning = motion_.deformation(X, h) - motion_.deformation(X, -h);
    auto const moving = motion_.position(X, h) - motion_.position(X, -h);
    state().template set<particle::Deformation>(0, p, cast<T>(F));
    state().template set<particle::Velocity>(0, p, cast<T>((0.5 / h) * moving));
    if constexpr (Body::Transfer::carries_affine)
      state().template set<particle::Affine>(
          0, p, cast<T>((0.5 / h / determinant(F)) * turning * transpose(cofactor(F))));
  }

  struct Forced : Scene<Body, BodyForce, Walls<Slip>> {};

  Motion motion_;
  Manufacture make_;
  Simulation<Forced, BackEnd, T> run_;
  double time_ = 0.0;
};

}  // namespace test
