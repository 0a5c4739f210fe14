// A bent thread that would rather be straight, in soft tissue: how far does it straighten the tissue?
//
// The answer must be that of its bending stiffness EI, whatever the thread weighs. Reference: the same
// bending and stretching forces, laid on the tissue itself along a line of tracers, without any thread.
// The thread sticks to the tissue, as such a line does.
#pragma once

#include <algorithm>

#include "physics/tissue_block.hpp"
#include "physics/units.hpp"

namespace test {

// Loss of sag under a dead load of EI = 16, dt 0.02; computed again by
// `test_physics_coupling_bent_reference_long`.
inline constexpr double dead_load_straightens = 0.2533;

// An arc pulls at the tissue with a couple at each end, which the grid sees only as two forces one segment
// apart. A wave A cos^4(pi s/L) has neither moment nor shear at its ends: its load is spread, with a
// wavelength of 6 cells, and its answer is a matter of EI alone.
enum class Rest { arc, wave };

// two_points: as in_solve, by two Gauss points per segment.
enum class Bend { in_solve, two_points, before_solve, explicit_before, dead_load };

// All numbers in Units of the tissue; bead masses in those of a full grid node.
struct BendCase {
  double stiffness = 4;  // EI
  double stretch = 20;   // EA
  double bead_mass = 1e-4, dt = 0.1, end = 100;
  int segments = 6;
  Bend how = Bend::in_solve;
  Rest rest = Rest::arc;
  Units unit{};
};
struct BendResult {
  double straightened = 0;  // loss of sag of the tissue along the thread [cells]
  double slip = 0;          // largest distance of tissue tracers from the thread [cells]
  bool ran_away = false;
};

// In cells.
inline std::vector<Vec3<double>> arc_line(int segments) {
  std::vector<Vec3<double>> line;
  for (int k = 0; k <= segments; ++k) {
    double const a = (10 + 70.0 * k / segments) * mpmpbd::pi<double> / 180;
    line.push_back(mpmpbd::vec(5.5 + 4 * std::cos(a), 5.5 + 4 * std::sin(a), 5.6));
  }
  return line;
}
// Beads at equal distances along the wave [cells], found by marching along it in small steps.
inline std::vector<Vec3<double>> wave_line(int segments) {
  auto const at = [](double x) {
    double const c = std::cos(mpmpbd::pi<double> * (x - 11) / 12);
    return mpmpbd::vec(x, 7.6 + 1.5 * c * c * c * c, 5.6);
  };
  std::vector<Vec3<double>> fine;
  std::vector<double> travelled;
  for (int i = 0; i <= 12000; ++i) {
    fine.push_back(at(5 + 1e-3 * i));
    travelled.push_back(i == 0 ? 0
                               : travelled.back() +
                                     mpmpbd::norm(fine[std::size_t(i)] - fine[std::size_t(i) - 1]));
  }
  std::vector<Vec3<double>> line;
  for (int k = 0; k <= segments; ++k) {
    auto const next = std::lower_bound(travelled.begin(), travelled.end(),
                                       (1 - 1e-12) * travelled.back() * k / segments);
    line.push_back(fine[std::size_t(next - travelled.begin())]);
  }
  return line;
}

template <class T> struct BentRest {
  using Q = mpmpbd::QuadraticBSpline;
  using Bending = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::NoDrag, true>;
  using Limp = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::NoDrag, false>;
  int segments;
  BendCase c;
  Units const& u = c.unit;
  double const width = c.rest == Rest::wave ? 14 : 8;  // of the block along x [cells]
  Rig<T, Bending> rig{int(width) + 9, 17, 12, T(u.length)};
  Tissue<T> tissue;
  std::vector<Vec3<T>> line;    // tissue points where the beads were: carries the dead load
  std::vector<Vec3<T>> tracer;  // tissue points where the thread held the tissue first
  std::vector<char> limp_memory;

  explicit BentRest(BendCase const& c_) : segments(c_.segments), c(c_) {
    fill_tissue();
    add_thread();
  }
  void fill_tissue() {
    tissue.measure_in(u, rig, c.dt, 2);
    tissue.damping = T(0.3 / u.time());
    tissue.fill(u.length * mpmpbd::vec(4.0, 4.0, 3.0), u.length * mpmpbd::vec(4 + width, 12.0, 8.0),
                0.4);
    tissue.fixed.assign(rig.mass.size(), 0);
    auto const layer = rig.mass.size() / 12;
    for (std::size_t i = 0; i < 4 * layer; ++i) tissue.fixed[i] = 1;  // the floor
  }
  void add_thread() {
    for (auto const& x : c.rest == Rest::wave ? wave_line(segments) : arc_line(segments))
      rig.add_bead(mpmpbd::cast<T>(u.length * x), T(c.bead_mass * u.mass()));
    auto const extra = std::size_t(c.how == Bend::two_points ? 2 * segments : 0);
    rig.allocate({}, std::vector<mpmpbd::ContactPoint<T>>(extra));
    rig.stretch_compliance = T(1 / (c.stretch * u.force()));
    rig.friction = {T(1e3), T(1e3 * u.modulus)};
    bend(1);
    line = rig.bead;
    for (std::size_t k = 0; k + 1 < line.size(); ++k)
      for (T s : {T(0.2113), T(0.7887)}) tracer.push_back((1 - s) * line[k] + s * line[k + 1]);
    limp_memory.assign(mpmpbd::exchange_bytes<T, Limp>(rig.capacity()), 0);
  }
  // Gives the thread a share of its EI.
  void bend(double share) {
    rig.bending_stiffness = T(share * c.stiffness * u.force() * u.length * u.length);
  }
  // Distance of the middle of the line from its chord [cells].
  double sag() const {
    auto const d = tracer.back() - tracer.front();
    auto const n = tracer.size();
    auto const m = T(0.5) * (tracer[n / 2 - 1] + tracer[n / 2]) - tracer.front();
    return double(mpmpbd::norm(m - mpmpbd::dot(m, d) / mpmpbd::dot(d, d) * d)) / u.length;
  }
  // Bending forces of a polyline, for the schemes that apply them as forces.
  std::vector<Vec3<T>> forces(std::vector<Vec3<T>>& of) {
    auto state = rig.thread();
    state.position = of.data();
    auto const x = rig.view();
    mpmpbd::measure_segments(mpmpbd::Solo{}, state, x.thread_work, rig.dt);
    std::vector<Vec3<T>> f(of.size());
    for (int k = 1; k + 1 < state.beads; ++k) {
      auto const j =
          mpmpbd::detail::bend_joint(state, x.thread_work.links, x.thread_work.length, k);
      for (std::size_t a = 0; a < 3; ++a)
        f[std::size_t(k) - 1 + a] -= j.stiffness * j.excess * j.in_plane[a];
    }
    return f;
  }
  void add_stretch(std::vector<Vec3<T>> const& of, std::vector<Vec3<T>>& f) const {
    for (std::size_t k = 0; k + 1 < of.size(); ++k) {
      Vec3<T> const d = of[k + 1] - of[k];
      T const l = mpmpbd::norm(d), pull = T(c.stretch * u.force()) * (l / rig.rest_length[k] - 1);
      f[k] += pull / l * d;
      f[k + 1] -= pull / l * d;
    }
  }
  void push_tissue() {
    auto f = forces(line);
    add_stretch(line, f);
    for (std::size_t k = 0; k < line.size(); ++k) {
      T w[27];
      int node[27];
      mpmpbd::embedding_weights<Q>(rig.lattice, line[k], rig.nodes(), w, node);
      for (std::size_t a = 0; a < 27; ++a) {
        auto const i = std::size_t(node[a]);
        rig.velocity[i] += rig.dt * w[a] * rig.inverse_mass[i][0] * f[k];
      }
    }
  }
  // The thread alone, implicitly: bending, tension and stretch, then contact without bending.
  void bend_thread_alone() {
    auto x = rig.view();
    mpmpbd::Solo const team;
    mpmpbd::measure_segments(team, x.thread, x.thread_work, rig.dt);
    mpmpbd::assemble_thread(team, x.thread, x.thread_work, rig.dt);
    auto& t = x.thread_work;
    auto const beads = static_cast<std::size_t>(x.thread.beads);
    std::vector<mpmpbd::Column<T>> columns;
    for (std::size_t k = 0; k < beads; ++k)
      columns.push_back(mpmpbd::Column<T>::of(t.inertia[k], k > 0 ? t.gap_speed[k - 1] : T(0)));
    mpmpbd::ChainSystem<T, true> const chain{x.thread.beads, t.base, x.thread.known, nullptr};
    mpmpbd::ChainSides<T> const side{1, columns.data(), nullptr};
    if (!mpmpbd::solve_chain(team, chain, side, t.chain)) return;
    for (std::size_t k = 0; k < beads; ++k) rig.bead_velocity[k] = columns[k].bead();
  }
  template <class Form> bool exchange_as(char* memory) {
    mpmpbd::ExchangeView<T, Form> x{};
    auto const full = rig.view();
    x.lattice = full.lattice;
    x.rest_density = full.rest_density;
    x.dt = full.dt;
    x.previous_dt = full.previous_dt;
    x.thread = full.thread;
    x.needle = full.needle;
    x.points = full.points;
    x.attached_points = full.attached_points;
    x.friction = full.friction;
    mpmpbd::use_workspace(x, rig.capacity(), memory);
    mpmpbd::Solo const team;
    mpmpbd::place_thread_points(team, x);
    if (c.how == Bend::two_points) place_on_segments(x, {T(0.2113), T(0.7887)});
    mpmpbd::embed_points(team, x, rig.nodes());
    return exchange_on_back_end(rig, x, memory) == 0;
  }

  BendResult run() {
    BendResult r;
    double const before = sag();
    for (double t = 0; t < c.end && !r.ran_away; t += c.dt) {
      bend(std::min(1.0, t / 40));  // slowly: no slip from a jerk
      tissue.scatter(rig);
      if (c.how == Bend::dead_load) push_tissue();
      if (c.how == Bend::before_solve) bend_thread_alone();
      if (c.how == Bend::explicit_before) {
        auto const f = forces(rig.bead);
        for (std::size_t k = 0; k < f.size(); ++k)
          rig.bead_velocity[k] += rig.dt / rig.bead_mass[k] * f[k];
      }
      if (c.how == Bend::in_solve || c.how == Bend::two_points)
        r.ran_away = !exchange_as<Bending>(rig.memory.data());
      else if (c.how != Bend::dead_load)
        r.ran_away = !exchange_as<Limp>(limp_memory.data());
      for (auto& p : line) p += rig.dt * Tissue<T>::velocity_at(rig, p);
      for (auto& p : tracer) p += rig.dt * Tissue<T>::velocity_at(rig, p);
      tissue.gather(rig);
      for (auto const& p : rig.bead) r.ran_away |= !near_the_block(p);
      for (auto const& p : tracer) r.ran_away |= !near_the_block(p);
    }
    r.straightened = before - sag();
    for (auto const& p : tracer) r.slip = std::max(r.slip, double(distance(p)) / u.length);
    return r;
  }
  bool near_the_block(Vec3<T> const& p) const {
    Vec3<double> const middle = mpmpbd::vec(4 + width / 2, 8.0, 5.6);
    return mpmpbd::norm(1 / u.length * mpmpbd::cast<double>(p) - middle) < 2 + width / 2;
  }
  T distance(Vec3<T> const& p) const {
    T far = T(1e9);
    for (std::size_t k = 0; k + 1 < rig.bead.size(); ++k) {
      Vec3<T> const d = rig.bead[k + 1] - rig.bead[k];
      T const along =
          mpmpbd::clamp(mpmpbd::dot(p - rig.bead[k], d) / mpmpbd::dot(d, d), T(0), T(1));
      far = mpmpbd::min(far, mpmpbd::norm(p - rig.bead[k] - along * d));
    }
    return far;
  }
};

}  // namespace test
