// A2.11: Cook's membrane, a tapered panel clamped at its left and sheared at its right edge: how far the middle of
// its right edge moves.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <mpmpbd/effects/body_force.hpp>
#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/pinned_region.hpp>

#include "catch.hpp"
#include "physics/plane_strain.hpp"

namespace test {

template <class Body> class Membrane {
  static constexpr double young = 1e5, density = 1050.0, unit = 1e-3;  // [Pa] [kg/m^3] [m]
  // A small load [N/m]: the edge moves by 22 F / E, 0.4 % of the panel.
  static constexpr double load = 1e-2 * young * unit;
  static constexpr int cells = 24;                   // along the panel of 48 units
  static constexpr double dx = 48.0 / cells * unit;  // [m]
  static constexpr int margin = 3, inside = 3;       // cells; of the panel in the wall

 public:
  explicit Membrane(double poisson)
      : points_(layer_points(dx, cells + margin + inside, 30 + 2 * margin,
                             [](Vec3<double> const& x) { return holds(x); })),
        run_(options()) {
    auto const k = lame(young, poisson);
    run_.template set<typename Body::Material>(k);
    run_.template set<Walls<Slip>>(layer_walls(dx, 2));
    pure_flip(run_);
    run_.template set<PinnedRegion>(
        {{-1.0, -1.0, -1.0}, {(margin + inside + 0.01) * dx, 1.0, 1.0}});
    run_.template set<Damping>({2.0 * slowest()});
    run_.add_particles(0, points_, density, dx * dx * dx / 4);
    pull();
  }

  // Upward displacement of the middle of the right edge over F / E, at rest.
  double displacement() {
    constexpr int steps = 300;
    double before = 0.0;
    for (int s = 0; s < steps; ++s) {
      if (s == 9 * steps / 10) before = edge();
      run_.step(9.0 / slowest() / steps);
    }
    CHECK(run_.status(0) == 0);
    CHECK_THAT(edge(), WithinRel(before, 2e-3));
    return edge() * young / load;
  }

 private:
  // At the face: half a spacing beyond the last column.
  double edge() const {
    double const spacing = 0.5 * dx / unit;
    return 1.5 * column(48.0 - 0.5 * spacing) - 0.5 * column(48.0 - 1.5 * spacing);
  }
  // In units of the panel, from its lower left corner.
  static Vec3<double> place(Vec3<double> const& x) {
    return (1.0 / unit) * (x - dx * vec(double(margin + inside), double(margin), 0.0));
  }
  static bool holds(Vec3<double> const& x) {
    auto const X = place(x);
    double const along = std::max(0.0, X[0]) / 48.0;
    return X[0] > -inside * dx / unit && X[0] < 48.0 && X[1] > 44.0 * along &&
           X[1] < 44.0 + 16.0 * along;
  }
  SimulationOptions options() const {
    auto o =
        layer_options(dx, cells + 2 * margin + inside + 1, 30 + 2 * margin + 1, points_.size());
    o.substeps = 0;
    return o;
  }
  // Of a cantilever as high as the panel's right edge [1/s]: less than the panel's own.
  static double slowest() {
    double const h = 16.0 * unit, length = 48.0 * unit;
    return 3.516 * h / (length * length) * std::sqrt(young / density / 12.0);
  }
  // The load on the last half column.
  void pull() {
    std::vector<std::int64_t> edge;
    for (std::size_t p = 0; p < points_.size(); ++p)
      if (place(points_[p])[0] > 48.0 - 0.5 * dx / unit)
        edge.push_back(static_cast<std::int64_t>(p));
    double const m = density * dx * dx * dx / 4 * double(edge.size());
    for (auto const p : edge)
      run_.state().template set<particle::BodyForce>(0, p, vec(0.0, load * dx / m, 0.0));
  }
  // Mean upward displacement beside the middle of the right edge, X units from the clamp.
  double column(double X) const {
    double sum = 0.0, found = 0.0;
    for (std::size_t p = 0; p < points_.size(); ++p) {
      auto const at = place(points_[p]);
      if (std::abs(at[0] - X) > 0.1 * dx / unit || std::abs(at[1] - 52.0) > 0.3 * dx / unit)
        continue;
      sum += run_.state().template get<particle::Position>(0, static_cast<std::int64_t>(p))[1] -
             points_[p][1];
      found += 1.0;
    }
    CHECK(found == 2.0);
    return sum / found;
  }

  std::vector<Vec3<double>> points_;
  LayerRun<Body, BodyForce, Damping, PinnedRegion> run_;
};

// What finite elements of second order say of the middle of the right edge in plane strain [F / E].
struct Panel {
  double poisson, edge;
};

template <class Form> using Strained = Mpm<NeoHookean, QuadraticBSpline, Apic, Form>;

// Displacement over that of finite elements.
template <class Form> double share(Panel const& panel) {
  return Membrane<Strained<Form>>(panel.poisson).displacement() / panel.edge;
}

}  // namespace test
