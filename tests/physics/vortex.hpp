// The generalised vortex of Kamojjala and Brannon (A2.3): a ring of tissue turns against itself and back, in plane strain.
#pragma once

#include <cmath>

#include "physics/manufactured.hpp"

namespace test {

// Every point turns about the axis by alpha = A sin(pi t) h(R), h = 1 - 32 (R - 1)^2 + 256 (R - 1)^4.
struct Vortex {
  static constexpr double duration = 0.5;              // [s]
  static constexpr double inner = 0.75, outer = 1.25;  // radii of the ring [m]
  static constexpr double half_width = 1.5;            // of the grid [m]

  double amplitude;                        // [rad]
  Lame<double> material = lame(1e3, 0.3);  // [Pa]
  double density = 1000.0;                 // [kg/m^3]

  double wave_speed() const { return std::sqrt((material.lambda + 2.0 * material.mu) / density); }

  static double radius(Vec3<double> const& X) { return std::sqrt(X[0] * X[0] + X[1] * X[1]); }
  struct Profile {
    double h, slope, curvature;  // [1] [1/m] [1/m^2]
  };
  static Profile profile(double R) {
    if (R <= inner || R >= outer) return {0.0, 0.0, 0.0};
    double const r = R - 1.0, rr = r * r;
    return {1.0 - 32.0 * rr + 256.0 * rr * rr, r * (-64.0 + 1024.0 * rr), -64.0 + 3072.0 * rr};
  }
  static Mat3<double> turn(double angle) {
    double const c = std::cos(angle), s = std::sin(angle);
    return {{c, s, 0, -s, c, 0, 0, 0, 1}};
  }
  double turned(double R, double t) const {
    return amplitude * std::sin(pi<double> * t) * profile(R).h;
  }
  Vec3<double> position(Vec3<double> const& X, double t) const {
    return turn(turned(radius(X), t)) * X;
  }
  // F = Q (I + R alpha_R e_Theta e_R^T)
  Mat3<double> deformation(Vec3<double> const& X, double t) const {
    double const R = radius(X);
    double const shear = R * amplitude * std::sin(pi<double> * t) * profile(R).slope;
    auto const e_R = (1.0 / R) * vec(X[0], X[1], 0.0), e_T = vec(-e_R[1], e_R[0], 0.0);
    return turn(turned(R, t)) * (Mat3<double>::identity() + shear * mpmpbd::outer(e_T, e_R));
  }
  // In the present polar frame: b_r = -R alpha_t^2 + mu/rho R alpha_R^2,
  // b_theta = R alpha_tt - mu/rho (3 alpha_R + R alpha_RR)
  Vec3<double> force(Vec3<double> const& X, double t) const {
    double const R = radius(X), k = material.mu / density;
    auto const f = profile(R);
    double const now = amplitude * std::sin(pi<double> * t);
    double const rate = amplitude * pi<double> * std::cos(pi<double> * t) * f.h;
    double const radial = R * (k * square(now * f.slope) - rate * rate);
    double const along =
        -now * (R * square(pi<double>) * f.h + k * (3.0 * f.slope + R * f.curvature));
    return turn(turned(R, t)) *
           ((1.0 / R) * vec(radial * X[0] - along * X[1], radial * X[1] + along * X[0], 0.0));
  }
};

inline bool in_ring(Vec3<double> const& X) {
  double const R = Vortex::radius(X);
  return R > Vortex::inner && R < Vortex::outer;
}

struct VortexCase {
  int n;                   // cells per metre
  double cfl = 0.1;        // step, about that many dx / c_p
  double amplitude = 0.1;  // [rad]
  double around = 0.125;   // tissue at rest on either side of the ring [m]; 0: its faces are free
};

template <class Body> Manufactured<Body, Vortex> vortex(VortexCase const& c, int& steps) {
  Vortex const motion{c.amplitude};
  int const n = c.n;
  double const dx = 1.0 / n;
  steps = static_cast<int>(std::ceil(Vortex::duration * motion.wave_speed() / (c.cfl * dx)));
  auto const middle = vec(Vortex::half_width, Vortex::half_width, 0.0);  // a node
  auto rest = layer_points(dx, 3 * n, 3 * n, [&](Vec3<double> const& x) {
    double const R = Vortex::radius(x - middle);
    return R > Vortex::inner - c.around && R < Vortex::outer + c.around;
  });
  for (auto& X : rest) X = X - middle;
  return {motion,
          {.options = layer_options(dx, 3 * n + 1, 3 * n + 1, rest.size()),
           .walls = layer_walls(dx, 2),
           .origin = middle,
           .rest = rest,
           .volume = dx * dx * dx / 4,
           .dt = Vortex::duration / steps}};
}

}  // namespace test
