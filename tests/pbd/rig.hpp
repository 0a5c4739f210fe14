// Rods alone, for tests: one environment, a team, gravity as the only force.
#pragma once

#include <mpmpbd/coupling/team.hpp>
#include <mpmpbd/pbd/access.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/pbd/solvers/direct_banded.hpp>
#include <mpmpbd/pbd/solvers/gauss_seidel.hpp>
#include <mpmpbd/pbd/solvers/jacobi.hpp>
#include <mpmpbd/testing/samples.hpp>

namespace rods {
using namespace mpmpbd;

using Line = std::vector<Vec3<double>>;
using V3 = Vec3<double>;
inline constexpr double gravity = 9.81;  // [m/s^2], along -z

inline Line straight(V3 const& from, V3 const& to, int beads) {
  Line const ends{from, to};
  return along(ends, beads);
}

// Lanes that take turns in another order than one lane would: what a group of threads may do.
struct Lanes {
  int count;
  template <class F> void each(int n, F const& f) const {
    for (int lane = count - 1; lane >= 0; --lane)
      for (int i = lane; i < n; i += count) f(i);
  }
  template <class F> void one(F const& f) const { f(); }
  void sync() const {}
};

// What is asked of beads in `store`, the state of one environment.
template <class Self> class Measured {
  auto const& store() const { return static_cast<Self const&>(*this).store; }

 public:
  std::int64_t beads() const { return store().template table<Beads>().live(0); }
  auto x(std::int64_t b) const { return store().template get<bead::Position>(0, b); }
  auto v(std::int64_t b) const { return store().template get<bead::Velocity>(0, b); }

  double length() const {
    double sum = 0;
    for (std::int64_t b = 1; b < beads(); ++b) sum += double(norm(x(b) - x(b - 1)));
    return sum;
  }
  double fastest() const {
    double most = 0;
    for (std::int64_t b = 0; b < beads(); ++b) most = max(most, double(norm(v(b))));
    return most;
  }
  bool finite() const {
    for (std::int64_t b = 0; b < beads(); ++b)
      if (!is_finite(x(b)) || !is_finite(v(b))) return false;
    return true;
  }
};

template <class Body, class T = double, class Team = Solo>
class Rig : public Measured<Rig<Body, T, Team>> {
 public:
  using Store = State<T, typename Body::AllFields>;

  explicit Rig(RodAssembly<Body> const& rod, VisitOrder order = VisitOrder::coloured,
               Team team = {})
      : team_(team) {
    for_each_type(typename Store::Domains{}, [&]<class D>(std::type_identity<D>) {
      for (auto const& c : rod.capacity())
        if (c.domain == D::name.view()) store.template table<D>().resize(1, c.slots);
    });
    rod.write(store, 0, order);
  }

  auto environment() { return access_environment(store, 0, typename Store::Domains{}); }
  void step(double dt, double g = gravity) {
    auto const env = environment();
    Tick<T> const tick{T(dt), T(dt), steps++};
    faults |= Body::step(team_, env, tick, [&](auto const& team, auto const& e, Tick<T> const& t) {
      team.each(static_cast<int>(e.template live<Beads>()), [&](std::int64_t b) {
        if (!(e.template get<bead::InverseMass>(b) > T(0))) return;
        auto u = e.template get<bead::Velocity>(b);
        u[2] -= T(g) * t.dt;
        e.template set<bead::Velocity>(b, u);
      });
    });
  }
  // One predict and solve, without forces and without the new velocity.
  void project(double dt) {
    auto const env = environment();
    Tick<T> const tick{T(dt), T(dt), steps++};
    faults |= Body::predict(team_, env, tick) | Body::solve(team_, env, tick);
  }

  template <class C> double residual() { return double(Body::template residual<C>(environment())); }

  Store store{1};
  std::int64_t steps = 0;
  std::uint32_t faults = 0;

 private:
  Team team_;
};

// Gives the beads that are free random velocities of up to `speed` [m/s] along each axis.
template <class Body, class T, class Team> void shake(Rig<Body, T, Team>& rig, double speed) {
  mpmpbd::testing::Samples samples(3);
  for (std::int64_t b = 0; b < rig.beads(); ++b) {
    auto const v = cast<T>(speed * samples.matrix<3>(-1.0, 1.0));
    if (rig.store.template get<bead::InverseMass>(0, b) > 0)
      rig.store.template set<bead::Velocity>(0, b, v);
  }
}
// The farthest that two runs have a bead apart [m].
template <class A, class B> double distance(A const& a, B const& b) {
  double most = 0;
  for (std::int64_t i = 0; i < a.beads(); ++i) most = max(most, double(norm(a.x(i) - b.x(i))));
  return most;
}

// Beads of equal mass on a line with Distance of the given compliance, the first one fixed.
template <class Body> RodAssembly<Body> chain(Line const& points, double mass, double compliance) {
  RodAssembly<Body> rod;
  for (auto const& p : points) rod.add_bead(p, mass);
  for (std::int64_t b = 0; b + 1 < rod.beads(); ++b)
    rod.template add<Distance>({b, b + 1},
                               {norm(rod.position(b + 1) - rod.position(b)), compliance});
  rod.prescribe(0);
  return rod;
}

}  // namespace rods
