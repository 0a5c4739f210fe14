// A2.9: a cantilever in plane strain under its own weight, against the elastica.
//
// The beam and its mirror image are run as one, and only the plane of nodes between them is held. A wall that
// holds all nodes behind it too is softer, because the node behind the plane should move like the one before
// it, backwards: with four cells the beam drops by 1.5 % more.
#pragma once

#include <cmath>

#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/pinned_region.hpp>

#include "catch.hpp"
#include "physics/plane_strain.hpp"

namespace test {

// A beam ten times as long as high; Gamma = w L^3 / (E I) says how heavy it is.
template <class Body> class SaggingBeam {
 public:
  SaggingBeam(double gamma, int cells_high)
      : dx_(height / cells_high), high_(cells_high), points_(points()), run_(options()) {
    run_.template set<NeoHookean>(lame(young, 0.0));
    run_.template set<Walls<Slip>>(layer_walls(dx_, 2));
    pure_flip(run_);
    double const g = gamma * young * height * height / (12.0 * density * length * length * length);
    run_.template set<Gravity>({{0.0, -g, 0.0}});
    // A little less than critical: a beam of cells is softer, and slower, than the elastica.
    run_.template set<Damping>({1.6 * slowest()});
    double const plane = (margin + 10 * high_) * dx_;
    run_.template set<PinnedRegion>(
        {{plane - 0.01 * dx_, -1.0, -1.0}, {plane + 0.01 * dx_, 1.0, 1.0}});
    run_.add_particles(0, points_, density, dx_ * dx_ * dx_ / 4);
  }

  // The drop of the tip at rest, over the length.
  double drop() {
    int const steps = 400;
    double before = 0.0;
    for (int s = 0; s < steps; ++s) {
      if (s == 9 * steps / 10) before = tip();
      run_.step(10.0 / slowest() / steps);
    }
    CHECK(run_.status(0) == 0);
    CHECK_THAT(tip(), WithinRel(before, 2e-3));
    return -tip() / length;
  }

 private:
  static constexpr double young = 1e5, density = 1050.0, height = 0.02, length = 10 * height;
  static constexpr int margin = 2;  // cells

  // Of the undamped small vibrations [1/s].
  static double slowest() {
    return 3.51601527 * height / (length * length) * std::sqrt(young / density / 12.0);
  }
  int columns() const { return 40 * high_; }
  int lowest() const { return 6 * high_ + margin; }  // cells below the beam at the start
  std::vector<Vec3<double>> points() const {
    std::vector<Vec3<double>> all;  // column by column
    for (int i = 0; i < columns(); ++i)
      for (int j = 0; j < 2 * high_; ++j)
        all.push_back(dx_ * vec(margin + 0.5 * i + 0.25, lowest() + 0.5 * j + 0.25, layer_middle));
    return all;
  }
  SimulationOptions options() const {
    auto o = layer_options(dx_, columns() / 2 + 2 * margin + 1, lowest() + high_ + margin + 1,
                           points_.size());
    o.substeps = 0;
    return o;
  }
  // Mean vertical displacement of a column, the last one for 0.
  double displacement(int from_end) const {
    double sum = 0.0;
    for (int j = 0; j < 2 * high_; ++j) {
      auto const p = static_cast<std::int64_t>(points_.size()) - 1 - from_end * 2 * high_ - j;
      sum += run_.state().template get<particle::Position>(0, p)[1] -
             points_[static_cast<std::size_t>(p)][1];
    }
    return sum / (2 * high_);
  }
  // At the face: half a spacing beyond the last column.
  double tip() const { return 1.5 * displacement(0) - 0.5 * displacement(1); }

  double dx_;
  int high_;
  std::vector<Vec3<double>> points_;
  LayerRun<Body, Gravity, Damping, PinnedRegion> run_;
};

// Of the elastica, which has no thickness.
struct Elastica {
  double gamma, drop;
};
inline constexpr Elastica heavy{2.0, 0.23850658}, heavier{5.0, 0.49590504};

// Drop over that of the elastica.
template <class Body> double sag_ratio(Elastica const& exact, int cells_high) {
  return SaggingBeam<Body>(exact.gamma, cells_high).drop() / exact.drop;
}

}  // namespace test
