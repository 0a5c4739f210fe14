// A2.4: a unit cube that vibrates along its axes by a manufactured body force (Wallstedt and Guilkey 2008),
// between walls through which nothing moves.
//
// The walls are mirrors: behind each lie images of the particles before it, so that the cube has no surface,
// and the order is that of its inside. A wall of the grid holds the node behind it too, which should
// move like the one before it, backwards, and that is first order in dx.
#pragma once

#include <cmath>

#include "catch.hpp"
#include "physics/manufactured.hpp"

namespace test {

// u_i = A sin(pi X_i) sin(c pi t + phase_i)
struct Vibration {
  static constexpr double amplitude = 0.05, young = 1e4;  // [m] [Pa]
  Lame<double> material = lame(young, 0.3);               // mu = 3846.15, K = 8333.33
  double density = 1.0;

  double speed() const { return std::sqrt(young / density); }
  double now(int axis, double t) const {
    return amplitude * std::sin(pi<double> * (speed() * t + 2.0 * axis / 3.0));
  }
  double stretch(Vec3<double> const& X, double t, int axis) const {
    return 1.0 + pi<double> * now(axis, t) * std::cos(pi<double> * X[axis]);
  }
  Vec3<double> displacement(Vec3<double> const& X, double t) const {
    Vec3<double> u{};
    for (int a = 0; a < 3; ++a) u[a] = now(a, t) * std::sin(pi<double> * X[a]);
    return u;
  }
  Vec3<double> position(Vec3<double> const& X, double t) const { return X + displacement(X, t); }
  Mat3<double> deformation(Vec3<double> const& X, double t) const {
    Mat3<double> F{};
    for (int a = 0; a < 3; ++a) F(a, a) = stretch(X, t, a);
    return F;
  }
  // pi^2 u_i (mu/rho - c^2 - (lambda (ln J - 1) - mu) / (rho F_ii^2))
  Vec3<double> force(Vec3<double> const& X, double t) const {
    auto const u = displacement(X, t);
    double const log_J = std::log(determinant(deformation(X, t)));
    double const spring = material.lambda * (log_J - 1.0) - material.mu;
    Vec3<double> b{};
    for (int a = 0; a < 3; ++a)
      b[a] = square(pi<double>) * u[a] / density *
             (material.mu - young - spring / square(stretch(X, t, a)));
    return b;
  }
};

template <class Body> class MirroredCube {
 public:
  using Run = Manufactured<Body, Vibration>;

  explicit MirroredCube(int cells) : cells_(cells), run_(Vibration{}, make()) {}

  // L2 error of the cube along one axis at t = 1/c [m]: a third of the squares of all three.
  double error() {
    run_.advance(10 * cells_, [this] { mirror(); });
    CHECK(run_.status() == 0);
    return run_.error(inside) / std::sqrt(3.0);
  }

 private:
  // Half cells of images behind a wall: all that the nodes of a particle at the wall can feel.
  static constexpr int deep = Body::Shape::width + 2;

  int per_side() const { return 2 * cells_ + 2 * deep; }  // particles
  static bool inside(Vec3<double> const& X) {
    bool in = true;
    for (int a = 0; a < 3; ++a) in = in && X[a] > 0.0 && X[a] < 1.0;
    return in;
  }
  Manufacture make() const {
    double const dx = 1.0 / cells_;
    std::vector<Vec3<double>> rest;
    int const n = per_side();
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
          rest.push_back(0.5 * dx * vec(i - deep + 0.5, j - deep + 0.5, k - deep + 0.5));
    // Whole cells to the origin, two more than the images need: they move by up to A.
    int const margin = (deep + 1) / 2 + 2, nodes = cells_ + 2 * margin + 1;
    double const o = margin * dx, far = 1e6;
    SimulationOptions const options{.environments = 1,
                                    .cell_size = dx,
                                    .nodes = {nodes, nodes, nodes},
                                    .capacity = {{"particle", std::int64_t(rest.size())}},
                                    .substeps = 1};
    return {.options = options,
            .walls = {{-far, -far, -far}, {far, far, far}},
            .origin = vec(o, o, o),
            .rest = rest,
            .volume = dx * dx * dx / 8,
            .dt = 0.1 * dx / Vibration{}.speed()};
  }

  // Every image takes what its particle has.
  void mirror() {
    int const n = per_side();
    for (std::int64_t p = 0; p < run_.count(); ++p) {
      std::int64_t source = 0, stride = 1;
      Mat3<double> S{};
      Vec3<double> twice{};  // where the mirrors stand
      for (int a = 0; a < 3; ++a, stride *= n) {
        int const i = static_cast<int>(p / stride % n) - deep;
        bool const before = i < 0, behind = i >= 2 * cells_;
        S(a, a) = before || behind ? -1.0 : 1.0;
        twice[a] = (before || behind ? 2.0 * run_.origin()[a] : 0.0) + (behind ? 2.0 : 0.0);
        source += stride * (deep + (before ? -1 - i : behind ? 4 * cells_ - 1 - i : i));
      }
      if (source != p) reflect(p, source, S, twice);
    }
  }
  void reflect(std::int64_t to, std::int64_t from, Mat3<double> const& S,
               Vec3<double> const& twice) {
    auto& s = run_.state();
    s.template set<particle::Position>(0, to,
                                       S * s.template get<particle::Position>(0, from) + twice);
    s.template set<particle::Velocity>(0, to, S * s.template get<particle::Velocity>(0, from));
    s.template set<particle::Deformation>(0, to,
                                          S * s.template get<particle::Deformation>(0, from) * S);
    if constexpr (Body::Transfer::carries_affine)
      s.template set<particle::Affine>(0, to, S * s.template get<particle::Affine>(0, from) * S);
  }

  int cells_;
  Run run_;
};

}  // namespace test
