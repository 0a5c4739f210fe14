// B17: a suture across the free end of a bar draws on it until it tears out.
#pragma once

#include <algorithm>

#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/effects/pinned_region.hpp>
#include <mpmpbd/effects/stretch_limit.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/scene/totals.hpp>

#include "catch.hpp"

namespace test {

using namespace mpmpbd;

struct SuturedBar : Scene<Mpm<StableNeoHookean>, StretchLimit, PinnedRegion,
                          Pbd<Constraints<Distance, Bend>>, Coupling<Embedded, Friction>> {};

struct BarCase {
  int along = 2;      // particles per cell along the bar; across it there are two
  double beyond = 2;  // of the bar, behind the suture [cells]
  double modulus = 1e4, poisson = 0.45, density = 1050, cell = 3.7e-3;  // SI
  double speed = 0.1;  // of the suture's ends, of sqrt(modulus / density)
};

// A bar of 8 x 4 x 4 cells along x that is held at its first cell.
class TornBar {
 public:
  static constexpr double low = 4, held = 5, high = 12;  // of the bar [cells]
  static constexpr int beads = 15, nodes[3] = {64, 14, 14};
  using Run = Simulation<SuturedBar, Serial, double>;

  explicit TornBar(BarCase const& c_) : c(c_), at(particles(c_)), run(make(c_, at)) {}

  void step() {
    double const v = c.speed * std::sqrt(c.modulus / c.density), h = run.suggest_dt(0);
    for (int const k : {0, beads - 1}) run.state().set<bead::Velocity>(0, k, vec(v, 0.0, 0.0));
    run.step(h);
    for (int const k : {0, beads - 1}) {
      int const next = k == 0 ? 1 : k - 1, segment = std::min(k, next);
      work -=
          run.state().get<bead::Tension>(0, segment) * v * h * direction(bead(next) - bead(k))[0];
    }
  }
  // How far the part between grip and suture is stretched.
  double stretch() const { return (bead(beads / 2)[0] - held) / (high - c.beyond - held); }
  double way() const { return bead(0)[0] - (high - c.beyond); }  // of the suture's ends [cells]
  // Of the suture on the bar, along x [N].
  double force() const {
    double sum = 0;
    for (int k = 0; k < beads; ++k) sum += run.state().get<contact::Impulse>(0, k)[0];
    return sum / run.state().get<environment::Dt>(0);
  }
  double energy() const { return tissue_totals(run, 0).energy(); }
  bool told() const { return has(run.status(0), Fault::fracture); }
  double supplied() const { return work; }  // by the suture's ends [J]
  // Numbers, and in the domain: what tears off is flung away and may be held at its border, which is told.
  bool sound() const {
    bool all = true;
    for (std::int64_t p = 0; p < static_cast<std::int64_t>(at.size()); ++p) {
      auto const x = run.state().get<particle::Position>(0, p);
      all = all && is_finite(x) && is_finite(run.state().get<particle::Velocity>(0, p)) &&
            is_finite(run.state().get<particle::Deformation>(0, p));
      for (int a = 0; a < 3; ++a) all = all && x[a] >= 0 && x[a] <= c.cell * (nodes[a] - 1);
    }
    return all;
  }

 private:
  BarCase c;
  std::vector<Vec3<double>> at;
  Run run;
  double work = 0;

  Vec3<double> bead(int k) const { return 1 / c.cell * run.state().get<bead::Position>(0, k); }
  static std::vector<Vec3<double>> particles(BarCase const& c) {
    std::vector<Vec3<double>> all;
    for (int k = 0; k < 8; ++k)
      for (int j = 0; j < 8; ++j)
        for (int i = 0; i < 8 * c.along; ++i)
          all.push_back(c.cell *
                        vec(low + (i + 0.5) / c.along, 5.13 + (j + 0.5) / 2, 5.27 + (k + 0.5) / 2));
    return all;
  }
  static Run make(BarCase const& c, std::vector<Vec3<double>> const& at) {
    double const x = high - c.beyond, y = 7.17;
    std::vector<Vec3<double>> const line{c.cell * vec(x, y, 2.27), c.cell * vec(x, y, 12.27)};
    RodAssembly<SuturedBar::Rods> rod;
    RodMaterial const braid{2e9, 1.15e-4, 1150, 0.05};
    add_thread(rod, std::span<Vec3<double> const>(line), beads, braid);
    auto capacity = rod.capacity();
    capacity.push_back({ContactPoints::name.view(), beads});
    capacity.push_back({Particles::name.view(), static_cast<std::int64_t>(at.size())});
    Run run({.environments = 1,
             .cell_size = c.cell,
             .nodes = {nodes[0], nodes[1], nodes[2]},
             .capacity = capacity,
             .substeps = 1});
    run.set<StableNeoHookean>(lame(c.modulus, c.poisson));
    run.set<StretchLimit>(StretchLimit::of(c.cell / c.along, c.cell));
    run.set<PinnedRegion>({{-1, -1, -1}, {held * c.cell, 1, 1}});
    run.set<Embedded>({braid.radius});
    run.set<Friction>({0.2, 0});
    run.add_particles(0, at, c.density, c.cell * c.cell * c.cell / (4 * c.along));
    rod.write(run.state(), 0);
    run.state().table<ContactPoints>().set_live(0, beads);
    for (int const k : {0, beads - 1}) run.state().set<bead::InverseMass>(0, k, 0.0);
    return run;
  }
};

struct TornOut {
  double told = 0, force_told = 0;  // when Fault::fracture is first set: stretch [1], force
  double let_go = 0;                // stretch at the largest force
  double peak = 0;                  // [N]
  // Largest over two cells of way, 25 after it has let go: until then it shakes what it has torn off.
  double force_after = 0;
  double excess = -1e300;  // of the bar's energy over what the suture has done, in shares of that
  bool sound = true, gone = false;
};

inline TornOut tear_out(BarCase const& c) {
  TornBar bar(c);
  TornOut r;
  double gone_at = 0;
  for (int n = 0; bar.way() < 45 && !(r.gone && bar.way() > gone_at + 27); ++n) {
    bar.step();
    double const f = bar.force();
    if (f > r.peak) r.peak = f, r.let_go = bar.stretch();
    if (r.told == 0 && bar.told()) r.told = bar.stretch(), r.force_told = f;
    if (bar.way() > 1 && !r.gone && f < 1e-2 * r.peak) r.gone = true, gone_at = bar.way();
    if (r.gone && bar.way() > gone_at + 25) r.force_after = std::max(r.force_after, std::abs(f));
    if (n % 20 != 0) continue;
    r.sound = r.sound && bar.sound();
    if (bar.way() > 1) r.excess = std::max(r.excess, bar.energy() / bar.supplied() - 1);
  }
  return r;
}

// Told while the bar still holds the suture, and after that it is gone for good.
inline void check_tear_out(BarCase const& c, double least_stretch) {
  auto const r = tear_out(c);
  CAPTURE(c.along, r.told, r.force_told / r.peak, r.let_go, r.peak, r.force_after / r.peak,
          r.excess);
  CHECK(r.gone);
  CHECK(r.sound);
  CHECK(r.told > 0);
  CHECK(r.told < r.let_go);
  CHECK(r.let_go > least_stretch);
  CHECK(r.force_after < 1e-2 * r.peak);
  CHECK(r.excess < 1e-3);
}

}  // namespace test
