// Laws of a coupling strategy: what it claims to conserve, and what none may break.
//
// The suite composes scenes of its own around the strategy and runs what stands between grid and gather
// on grids, threads and needles in random motion:
//   using Laws = Coupling<MyStrategy, Friction>;
//   for (auto const& law : coupling_laws<Laws, double>({.strategy = {...}, .friction = {0.2, 0.0}})) ...
//
// Momentum laws follow `Strategy::conserves`. A strategy that hands momentum over later says how much is
// under way by `momentum_under_way<Parts>(env)`; it is counted. One that knows threads alone says
// `static constexpr bool couples_needles = false`.
#pragma once

#include <cmath>
#include <vector>

#include <mpmpbd/coupling/coupling.hpp>
#include <mpmpbd/coupling/embedded_fields.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/needle/arc_needle.hpp>
#include <mpmpbd/needle/contact_points.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/pbd/solvers/direct_banded.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/testing/law.hpp>
#include <mpmpbd/testing/samples.hpp>
#include <mpmpbd/testing/worst.hpp>

namespace mpmpbd {

// The numbers with which a coupling is tested. Lengths of the scenes: cells of 2 mm, a thread of 8
// segments of about a cell, a needle of 6 mm radius; density 1050 kg/m^3, substeps of 0.5 ms.
template <class Laws_> struct CouplingCase {
  parameters_t<typename Laws_::Strategy, double> strategy{};
  parameters_t<typename Laws_::FrictionLaw, double> friction{};
  parameters_t<typename Laws_::DragLaw, double> drag{};
};

namespace testing {

struct CouplingTissue : Mpm<NeoHookean> {};
// For strategies that leave the thread to its own solver: one that does not depend on an order.
struct CouplingThread : Pbd<Constraints<Distance>, DirectBanded<>> {};
template <class Laws_> struct ThreadInTissue : Scene<CouplingTissue, CouplingThread, Laws_> {};
template <class Laws_> struct NeedleInTissue : Scene<CouplingTissue, ArcNeedle, Laws_> {};
template <class Laws_>
struct ThreadAndFreeNeedle : Scene<CouplingTissue, CouplingThread, FreeArcNeedle, Laws_> {};

struct Momenta {
  Vec3<double> linear{}, angular{};
  double linear_size = 0, angular_size = 0;  // sums of sizes: what rounding is relative to
  double energy = 0;
  void add(double m, Vec3<double> const& x, Vec3<double> const& v) {
    linear += m * v;
    angular += m * cross(x, v);
    linear_size += m * norm(v);
    angular_size += m * norm(cross(x, v));
    energy += 0.5 * m * dot(v, v);
  }
};

// A grid, a thread and a needle without particles' motion: only the coupling's own stages run.
template <class Scene_, class T> class CouplingProbe {
 public:
  using Laws_ = typename Scene_::Coupling;
  using In = typename Scene_::In;
  using Needle = typename Scene_::Needle;
  static constexpr double dx = 2e-3, density = 1050.0, speed = 0.05;
  static constexpr double node_mass = density * dx * dx * dx;
  static constexpr int cells = 16, beads = 9;
  double dt = 5e-4;
  static constexpr bool has_rods = Scene_::has_rods;
  static constexpr bool free_needle = std::is_same_v<Needle, FreeArcNeedle>;

  explicit CouplingProbe(CouplingCase<Laws_> const& c) : sim_(options()) {
    nodes_.assign(static_cast<std::size_t>(sim_.lattice().count()), quad<T>(0, 0, 0, 0));
    std::vector<Vec3<double>> const one{dx * vec(8.0, 8.0, 8.0)};
    sim_.add_particles(0, one, density, dx * dx * dx / 8);
    sim_.template set<typename Laws_::Strategy>(c.strategy);
    sim_.template set<typename Laws_::FrictionLaw>(c.friction);
    sim_.template set<typename Laws_::DragLaw>(c.drag);
    if constexpr (Scene_::has_needle) add_needle();
    if constexpr (State_::template has<ContactPoints>)
      state().template table<ContactPoints>().set_live(
          0, state().template table<ContactPoints>().capacity());
  }

  // Tissue up to the height `top` [cells]; masses differ by `spread` from those of full tissue.
  void fill(Samples& random, double top, double spread) {
    auto const& l = sim_.lattice();
    for (int k = 0; k < l.nodes[2]; ++k)
      for (int j = 0; j < l.nodes[1]; ++j)
        for (int i = 0; i < l.nodes[0]; ++i) {
          double const share = clamp(top - k + 0.5, 0.0, 1.0);
          double const m = share * node_mass * random.uniform(1 - spread, 1 + spread);
          nodes_[static_cast<std::size_t>(l.index(i, j, k))] = quad<T>(0, 0, 0, T(m));
        }
  }
  void stir(Samples& random) {
    for (auto& n : nodes_)
      n = quad(cast<T>(random.matrix<3>(-speed, speed)), n[3] > T(0) ? n[3] : T(0));
    if constexpr (Scene_::has_rods)
      for (int k = 0; k < beads; ++k)
        state().template set<bead::Velocity>(0, k, cast<T>(random.matrix<3>(-speed, speed)));
    if constexpr (Scene_::has_needle)
      needle::set_twist(state().template view<Needles>(), 0,
                        Twist<T>{cast<T>(random.matrix<3>(-speed, speed)),
                                 cast<T>(random.matrix<3>(-speed / dx / 4, speed / dx / 4))});
  }

  // An inextensible thread along a gentle curve from `from`, with beads of `mass` [kg].
  void lay_thread(Vec3<double> const& from, Vec3<double> const& along, Vec3<double> const& bend,
                  double mass, bool reversed = false) {
    RodAssembly<CouplingThread> rod;
    std::vector<Vec3<double>> line;
    for (int k = 0; k < beads; ++k) {
      double const s = double(k) / (beads - 1);
      line.push_back(cast<double>(cast<T>(from + s * along + (s * (1 - s)) * bend)));
    }
    if (reversed) line = {line.rbegin(), line.rend()};
    for (auto const& x : line) rod.add_bead(x, mass);
    auto const at = [&](int k) { return cast<T>(line[static_cast<std::size_t>(k)]); };
    for (int k = 0; k + 1 < beads; ++k)
      rod.template add<Distance>({k, k + 1}, {double(norm(at(k + 1) - at(k))), 0.0});
    rod.write(state(), 0);
  }
  void place_needle(Vec3<double> const& centre, Quaternion<double> const& turn) {
    needle::set_pose(state().template view<Needles>(), 0,
                     cast_pose<T>(Pose<double>{dx * centre, turn}));
  }

  // Once what stands between the grid and the gather.
  std::uint32_t couple() {
    Ctx context{};
    context.lattice = sim_.lattice();
    for_each_type(typename Scene_::Policies{}, [&]<class P>(std::type_identity<P>) {
      context.parameters.template get<P>() = state().template parameters<P>(0);
    });
    context.tick = Tick<T>{T(dt), T(dt), 0};
    std::uint32_t faults = 0;
    for_each_type(typename Scene_::Substep::Stages{}, [&]<class S>(std::type_identity<S>) {
      if constexpr (concerns_environment<S>) {
        auto const env = access();
        if constexpr (requires { S::scratch_bytes(env, context); })
          scratch_.resize(S::scratch_bytes(env, context) / sizeof(std::max_align_t) + 1);
        NodeAccess<T, Move, Ctx> const grid{nodes_.data(), context, scratch_.data()};
        faults |= run_by_team<S>(Solo{}, env, context, grid);
      }
    });
    return faults;
  }

  // Moments are about the middle of the domain, so that they are not all the same number.
  Momenta of_grid() const {
    Momenta sum;
    auto const& l = sim_.lattice();
    for (int k = 0; k < l.nodes[2]; ++k)
      for (int j = 0; j < l.nodes[1]; ++j)
        for (int i = 0; i < l.nodes[0]; ++i) {
          auto const& n = nodes_[static_cast<std::size_t>(l.index(i, j, k))];
          sum.add(double(n[3]), about(l.position(i, j, k)), cast<double>(vector_part(n)));
        }
    return sum;
  }
  Momenta all() {
    Momenta sum = of_grid();
    if constexpr (Scene_::has_rods)
      for (int k = 0; k < beads; ++k) {
        double const w = double(state().template get<bead::InverseMass>(0, k));
        if (w > 0)
          sum.add(1 / w, about(state().template get<bead::Position>(0, k)),
                  cast<double>(state().template get<bead::Velocity>(0, k)));
      }
    if constexpr (free_needle) {
      auto const view = state().template view<Needles>();
      auto const body = NeedleBody<double>::of(
          Needle::arc(cast_parameters<Needle, double, T>(state().template parameters<Needle>(0))),
          double(state().template parameters<Needle>(0).density));
      Pose<double> const pose = cast_pose<double>(needle::pose(view, 0));
      Twist<double> const twist{cast<double>(needle::twist(view, 0).linear),
                                cast<double>(needle::twist(view, 0).angular)};
      Vec3<double> const p = body.momentum(pose, twist);
      Vec3<double> const L = body.angular_momentum(pose, twist, middle());
      sum.linear += p;
      sum.linear_size += norm(p);
      sum.angular += L;
      sum.angular_size += norm(L);
      sum.energy += body.kinetic_energy(pose, twist);
    }
    using Strategy = typename Laws_::Strategy;
    auto const env = access();
    if constexpr (requires { Strategy::template momentum_under_way<In>(env); })
      sum.linear += cast<double>(Strategy::template momentum_under_way<In>(env));
    return sum;
  }

  static Vec3<double> middle() { return (0.5 * cells * dx) * vec(1.0, 1.0, 1.0); }
  template <class U> static Vec3<double> about(Vec3<U> const& x) {
    return cast<double>(x) - middle();
  }
  Simulation<Scene_, Serial, T>& sim() { return sim_; }
  auto& state() { return sim_.state(); }
  std::vector<Quad<T>>& nodes() { return nodes_; }

 private:
  using State_ = typename Simulation<Scene_, Serial, T>::Store;
  using Ctx = Context<T, typename Scene_::Policies>;
  using Move = MoveNodes<typename Scene_::Body, typename Scene_::Effects>;

  static ArcNeedle::Parameters<double> arc() { return {6e-3, 2.5, 2e-4, 1e-3, 0.0, 0.0}; }
  static SimulationOptions options() {
    SimulationOptions o;
    o.cell_size = dx;
    for (int& n : o.nodes) n = cells + 1;
    auto const points = contact_points(ArcPoints<double>::over(ArcNeedle::arc(arc()), dx));
    o.capacity = {{Particles::name.view(), 1},
                  {Beads::name.view(), beads},
                  {Distance::name.view(), beads - 1},
                  {Needles::name.view(), 1},
                  {ContactPoints::name.view(),
                   (Scene_::has_rods ? beads : 0) + (Scene_::has_needle ? points : 0)}};
    return o;
  }
  void add_needle() {
    state().template table<Needles>().set_live(0, 1);
    auto const k = arc();
    if constexpr (free_needle)
      sim_.template set<Needle>({k.radius, k.angle, k.wire_radius, k.taper, 0.0, 0.0, 7800.0});
    else
      sim_.template set<Needle>(k);
    place_needle(vec(8.0, 8.0, 9.0), quaternion::identity<double>());
  }
  auto access() { return access_environment(state(), 0, typename State_::Domains{}); }

  Simulation<Scene_, Serial, T> sim_;
  std::vector<Quad<T>> nodes_;
  std::vector<std::max_align_t> scratch_;
};

// A thread and a needle of random mass and place, both half in tissue, everything in motion.
template <class Probe> void through_surface(Probe& p, Samples& random, double ratio) {
  constexpr double dx = Probe::dx;
  p.fill(random, 9.0 + random.uniform(0.0, 1.0), 0.3);
  if constexpr (Probe::has_rods) {
    auto const from = dx * (vec(4.0, 6.0, 5.0) + random.matrix<3>(0.0, 1.0));
    auto const along = dx * (vec(4.0, 2.0, 6.0) + random.matrix<3>(-0.5, 0.5));
    p.lay_thread(from, along, dx * random.matrix<3>(-3.0, 3.0), ratio * Probe::node_mass);
  }
  p.stir(random);
}

template <class Strategy>
inline constexpr bool couples_needles = [] {
  if constexpr (requires { Strategy::couples_needles; })
    return bool(Strategy::couples_needles);
  else
    return true;
}();

template <class Laws_, class T> class CouplingSuite {
 public:
  static constexpr bool needles = couples_needles<typename Laws_::Strategy>;
  template <bool there, class> struct AllBodies { using type = ThreadInTissue<Laws_>; };
  template <class L> struct AllBodies<true, L> { using type = ThreadAndFreeNeedle<L>; };
  using All = CouplingProbe<typename AllBodies<needles, Laws_>::type, T>;

  explicit CouplingSuite(CouplingCase<Laws_> const& c) : case_(c) {}

  // Worst errors relative to the sums of sizes: of linear momentum, of angular momentum while the thread
  // has no tension stored from a coupling before, and of angular momentum when it has.
  Vec<double, 3> momentum(double dt) const {
    Worst linear, angular, taut;
    Samples random(1);
    for (int n = 0; n < 20; ++n) {
      All p(case_);
      p.dt = dt;
      through_surface(p, random, random.log_uniform(1e-3, 1e3));
      if constexpr (needles)
        p.place_needle(vec(8.0, 8.0, 9.0) + random.matrix<3>(-0.5, 0.5),
                       quaternion::from_rotation_vector(random.matrix<3>(-2.0, 2.0)));
      p.stir(random);
      for (int s = 0; s < 3; ++s) {
        Momenta const before = p.all();
        p.couple();
        Momenta const after = p.all();
        linear.include(norm(after.linear - before.linear) /
                       max(before.linear_size, after.linear_size));
        (s == 0 ? angular : taut)
            .include(norm(after.angular - before.angular) /
                     max(before.angular_size, after.angular_size));
      }
    }
    return {{linear.value(), angular.value(), taut.value()}};
  }

  // The largest relative gain of kinetic energy in one coupling: an inextensible thread, the strategy's
  // memory filled by a coupling before.
  double energy(double ratio) const {
    Worst gain;
    Samples random(2);
    for (int n = 0; n < 100; ++n) {
      CouplingProbe<ThreadInTissue<Laws_>, T> p(case_);
      through_surface(p, random, ratio);
      auto const start = p.state();
      p.couple();
      for (int k = 0; k < CouplingProbe<ThreadInTissue<Laws_>, T>::beads; ++k)
        p.state().template set<bead::Position>(0, k, start.template get<bead::Position>(0, k));
      p.stir(random);
      double const before = p.all().energy;
      p.couple();
      gain.include(p.all().energy / before - 1);
    }
    return gain.value();
  }

  // Reported force and moment of a needle against what the grid got, relative.
  Vec<double, 2> reaction() const {
    using Probe = CouplingProbe<NeedleInTissue<Laws_>, T>;
    Worst force, moment;
    Samples random(3);
    for (int n = 0; n < 20; ++n) {
      Probe p(case_);
      p.fill(random, 9.0 + random.uniform(0.0, 1.0), 0.3);
      p.place_needle(vec(8.0, 8.0, 9.0) + random.matrix<3>(-0.5, 0.5),
                     quaternion::from_rotation_vector(random.matrix<3>(-2.0, 2.0)));
      p.stir(random);
      auto const centre = Probe::about(p.state().template get<needle::Position>(0));
      Momenta const before = p.of_grid();
      p.couple();
      Momenta const after = p.of_grid();
      Vec3<double> const J = after.linear - before.linear;
      Vec3<double> const L = after.angular - before.angular - cross(centre, J);
      auto const F = cast<double>(p.state().template get<needle::Force>(0));
      auto const M = cast<double>(p.state().template get<needle::Moment>(0));
      force.include(norm(p.dt * F + J) / (norm(J) + before.linear_size * scale_));
      moment.include(norm(p.dt * M + L) / (norm(L) + before.angular_size * scale_));
    }
    return {{force.value(), moment.value()}};
  }

  // Change of any node's velocity by a thread and a needle above the tissue, and of the bodies' own.
  Vec<double, 2> without_touch() const {
    using Probe = All;
    Probe p(case_);
    Samples random(4);
    p.fill(random, 2.0, 0.3);
    p.stir(random);
    p.lay_thread(Probe::dx * vec(3.0, 5.0, 11.0), Probe::dx * vec(8.0, 2.0, 1.0), {},
                 Probe::node_mass);
    if constexpr (needles) p.place_needle(vec(8.0, 8.0, 10.0), quaternion::identity<double>());
    auto const v = cast<T>(vec(0.02, 0.01, -0.03));
    for (int k = 0; k < Probe::beads; ++k) p.state().template set<bead::Velocity>(0, k, v);
    if constexpr (needles)
      needle::set_twist(p.state().template view<Needles>(), 0, Twist<T>{v, {}});
    auto const before = p.nodes();
    for (int s = 0; s < 3; ++s) p.couple();
    Worst tissue, bodies;
    for (std::size_t i = 0; i < before.size(); ++i)
      tissue.include(double(norm(vector_part(p.nodes()[i]) - vector_part(before[i]))));
    if constexpr (needles) tissue.include(double(norm(p.state().template get<needle::Force>(0))));
    for (int k = 0; k < Probe::beads; ++k)
      bodies.include(double(norm(p.state().template get<bead::Velocity>(0, k) - v) / norm(v)));
    if constexpr (needles)
      bodies.include(double(norm(p.state().template get<needle::LinearVelocity>(0) - v) / norm(v)));
    return {{tissue.value(), bodies.value()}};
  }

  // The same thread numbered from its other end: largest difference of bead velocities after 3 couplings.
  double reversal() const {
    using Probe = CouplingProbe<ThreadInTissue<Laws_>, T>;
    Worst worst;
    for (int n = 0; n < 10; ++n) {
      Probe p(case_), q(case_);
      lay(p, n, false);
      lay(q, n, true);
      for (int s = 0; s < 3; ++s) {
        p.couple();
        q.couple();
      }
      for (int k = 0; k < Probe::beads; ++k)
        worst.include(
            double(norm(p.state().template get<bead::Velocity>(0, k) -
                        q.state().template get<bead::Velocity>(0, Probe::beads - 1 - k))) /
            Probe::speed);
    }
    return worst.value();
  }

  // Variation (standard deviation over mean) of the impulse on nodes at rest by a straight heavy thread that
  // moves sideways, over 16 places of the thread within a cell. Free nodes vary more than elastic tissue.
  double offsets() const {
    using Probe = CouplingProbe<ThreadInTissue<Laws_>, T>;
    double sum = 0, sum2 = 0;
    for (int n = 0; n < 16; ++n) {
      Probe p(case_);
      Samples random(5);
      p.fill(random, 100.0, 0.0);
      int const row = n / 4;
      Vec3<double> const at = vec(4.0, 8.0 + (n % 4 + 0.5) / 4, 8.0 + (row + 0.5) / 4);
      p.lay_thread(Probe::dx * at, Probe::dx * vec(8.0, 0.0, 0.0), {}, 1e6 * Probe::node_mass);
      for (int k = 0; k < Probe::beads; ++k)
        p.state().template set<bead::Velocity>(0, k, cast<T>(vec(0.0, Probe::speed, 0.0)));
      p.couple();
      double const J = p.of_grid().linear[1];
      sum += J / 16;
      sum2 += J * J / 16;
    }
    return sum > 0 ? std::sqrt(max(sum2 - sum * sum, 0.0)) / sum
                   : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  static constexpr double scale_ = 1e-3;  // forces below this share of the motion count as rounding

  template <class Probe> static void lay(Probe& p, int n, bool reversed) {
    Samples random(static_cast<std::uint64_t>(n) + 10);
    p.fill(random, 9.5, 0.3);
    p.stir(random);
    std::vector<Vec3<T>> v;
    for (int k = 0; k < Probe::beads; ++k)
      v.push_back(p.state().template get<bead::Velocity>(0, k));
    p.lay_thread(Probe::dx * (vec(4.0, 6.0, 5.0) + random.matrix<3>(0.0, 1.0)),
                 Probe::dx * (vec(4.0, 2.0, 6.0) + random.matrix<3>(-0.5, 0.5)),
                 Probe::dx * random.matrix<3>(-3.0, 3.0),
                 random.log_uniform(0.1, 10.0) * Probe::node_mass, reversed);
    for (int k = 0; k < Probe::beads; ++k)
      p.state().template set<bead::Velocity>(
          0, k, v[static_cast<std::size_t>(reversed ? Probe::beads - 1 - k : k)]);
  }

  CouplingCase<Laws_> case_;
};

}  // namespace testing

// `claim` selects the conservation laws; by default what the strategy claims itself.
template <class Laws_, class T>
Laws coupling_laws(CouplingCase<Laws_> const& c, Conserves claim = Laws_::Strategy::conserves) {
  testing::CouplingSuite<Laws_, T> const suite(c);
  bool const wide = sizeof(T) == 8;
  double const rounding = wide ? 1e-12 : 1e-5;
  Laws laws;
  auto const momentum = suite.momentum(5e-4);
  if (claim != Conserves::none)
    laws.push_back(
        {"linear momentum, thread and free needle through a free surface", momentum[0], rounding});
  if (claim == Conserves::momentum_and_angular) {
    laws.push_back(
        {"angular momentum, thread and free needle through a free surface", momentum[1], rounding});
    // Tension that acts along the thread's next direction keeps it as well as any implicit step.
    laws.push_back({"angular momentum of a taut thread: error at dt/10 over that at dt",
                    suite.momentum(5e-5)[2] / momentum[2], 0.15});
  }
  for (double const ratio : {1e-4, 1e-2, 1.0, 1e2, 1e4}) {
    char name[64];
    std::snprintf(name, sizeof name, "gain of energy, bead/node mass %g", ratio);
    laws.push_back({name, suite.energy(ratio), rounding});
  }
  if constexpr (testing::CouplingSuite<Laws_, T>::needles) {
    auto const reaction = suite.reaction();
    laws.push_back(
        {"reported force = - impulse on the grid / dt", reaction[0], wide ? 1e-11 : 1e-4});
    laws.push_back(
        {"reported moment = - moment on the grid / dt", reaction[1], wide ? 1e-11 : 1e-4});
  }
  auto const free = suite.without_touch();
  laws.push_back({"no force without touch [m/s]", free[0], 0.0});
  // A velocity found from positions is right to an ulp of the position per dt.
  laws.push_back({"free flight of thread and needle", free[1], wide ? 1e-12 : 1e-3});
  laws.push_back({"thread numbered from its other end", suite.reversal(), wide ? 1e-9 : 1e-3});
  laws.push_back({"impulse over 16 places in a cell: variation", suite.offsets(), 0.1});
  return laws;
}

}  // namespace mpmpbd
