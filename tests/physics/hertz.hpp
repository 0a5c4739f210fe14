// A2.10: a rigid smooth sphere is pressed into a block of tissue (Hertz 1882):
// F = 4/3 E* sqrt(R) d^1.5, E* = E / (1 - nu^2).
//
// A quarter of the block between two planes of symmetry, 4 R wide and 4 R deep: with its mirror images 8 R. The force is
// the slope of the strain energy over depth.
#pragma once

#include "catch.hpp"
#include "physics/back_end.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/indenter.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/scene/totals.hpp>

namespace test {

using namespace mpmpbd;

class Indentation {
 public:
  static constexpr double radius = 10e-3, young = 10e3, poisson = 0.45, density = 1000.0;
  static constexpr double deepest = 1.6e-3;

  // The block's faces above and below lie `height` cells above nodes. The sphere takes `crossings` times as long as a
  // shear wave through the block.
  explicit Indentation(int cells_per_radius, double height = 0.0, double crossings = 6.0)
      : dx_(radius / cells_per_radius), n_(4 * cells_per_radius), run_(options()) {
    double const speed = std::sqrt(young / (2 * (1 + poisson)) / density), side = n_ * dx_;
    double const low = margin * dx_, bottom = low + height * dx_, top = bottom + side;
    duration_ = crossings * side / speed;
    run_.set<NeoHookean>(lame(young, poisson));
    run_.set<Damping>({speed / side});
    run_.set<Walls<Slip>>({{low, low, bottom}, {low + side, low + side, 1e3}});
    run_.set<Indenter>({{low, low, top + radius}, {0, 0, -deepest / duration_}, radius, 1e3});
    std::vector<Vec3<double>> at;
    for (int k = 0; k < 2 * n_; ++k)
      for (int j = 0; j < 2 * n_; ++j)
        for (int i = 0; i < 2 * n_; ++i)
          at.push_back(vec(low, low, bottom) + 0.5 * dx_ * vec(i + 0.5, j + 0.5, k + 0.5));
    run_.add_particles(0, at, density, dx_ * dx_ * dx_ / 8);
  }

  // Force [N] of the whole block at depths [m] that `samples` intervals of the way have in their middles.
  struct Curve {
    std::vector<double> depth, force;
  };
  Curve press(int samples) {
    Curve curve;
    double before = 4 * tissue_totals(run_, 0).strain;
    for (int n = 0; n < samples; ++n) {
      run_.step(duration_ / samples);
      double const now = 4 * tissue_totals(run_, 0).strain;
      curve.depth.push_back(deepest * (n + 0.5) / samples);
      curve.force.push_back((now - before) * samples / deepest);
      before = now;
    }
    CHECK(run_.status(0) == 0);
    return curve;
  }
  static double hertz(double depth) {
    return 4.0 / 3.0 * young / (1 - poisson * poisson) * std::sqrt(radius) * std::pow(depth, 1.5);
  }

 private:
  struct Pressed : Scene<Mpm<NeoHookean>, Damping, Walls<Slip>, Indenter> {};
  static constexpr int margin = 3;

  SimulationOptions options() const {
    int const nodes = n_ + 2 * margin + 1;
    return {.environments = 1,
            .cell_size = dx_,
            .nodes = {nodes, nodes, nodes + 1},
            .capacity = {{"particle", std::int64_t{8} * n_ * n_ * n_}}};
  }

  double dx_;
  int n_;
  Simulation<Pressed, ParallelBackEnd, float> run_;
  double duration_ = 0.0;
};

// The straight line of log F over log(d + gap), between two depths.
struct HertzFit {
  double gap;        // contact begins so far before the sphere meets the particles' faces [m]
  double stiffness;  // over Hertz's
  double exponent;   // of F over depth + gap
  double left;       // root mean square of log F beside the line
};
inline HertzFit fit_with(Indentation::Curve const& curve, double from, double to, double gap) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, over = 0;
  for (std::size_t i = 0; i < curve.depth.size(); ++i) {
    double const d = curve.depth[i];
    if (d < from || d > to) continue;
    double const p = std::log(d + gap), q = std::log(curve.force[i]);
    n += 1, x += p, y += q, xx += p * p, xy += p * q, yy += q * q;
    over += q - std::log(Indentation::hertz(d + gap));
  }
  double const across = xy - x * y / n, slope = across / (xx - x * x / n);
  double const left = std::max(0.0, yy - y * y / n - slope * across);
  return {gap, std::exp(over / n), slope, std::sqrt(left / n)};
}

// The mean of curves at the same depths.
inline Indentation::Curve mean_of(std::vector<Indentation::Curve> const& all) {
  auto mean = all.front();
  for (std::size_t i = 0; i < mean.depth.size(); ++i) {
    mean.force[i] = 0;
    for (auto const& one : all) mean.force[i] += one.force[i] / static_cast<double>(all.size());
  }
  return mean;
}

// F = C (d + gap)^p with all three free: the straight line of log F over log(d + gap) whose gap, of 0 to `most`
// (1.5 dx on the page), leaves the least. Stiffness is that of a force held to p = 1.5 with that gap.
inline HertzFit fit_hertz(Indentation::Curve const& curve, double from, double to, double most) {
  HertzFit best = fit_with(curve, from, to, 0.0);
  int const places = 600;
  for (int i = 1; i <= places; ++i)
    if (auto const fit = fit_with(curve, from, to, most * i / places); fit.left < best.left)
      best = fit;
  return best;
}

}  // namespace test
