// B9: free fall is a parabola, exactly the one of the integrator, and nothing strains.
// on a device
#include <vector>

#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/flip.hpp>
#include <mpmpbd/mpm/transfer/pic.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include "catch.hpp"
#include "physics/back_end.hpp"

using namespace mpmpbd;

namespace {

constexpr double dx = 3.7e-3, g = 9.81;

template <class Body> struct Fall : Scene<Body, Gravity> {};

// Symplectic Euler: v_n = v0 - n g dt, x_n = x0 + n v0 dt - g dt^2 n (n + 1) / 2. Errors add up over the
// steps like a random walk at worst linearly: n roundings of x and of v.
template <class Body, class T> void check_fall(int particles_per_axis) {
  Simulation<Fall<Body>, test::BackEnd, T> run({.environments = 1,
                                                .cell_size = dx,
                                                .nodes = {11, 11, 15},
                                                .capacity = {{"particle", 64}},
                                                .substeps = 1});
  run.template set<NeoHookean>(lame(1.3e4, 0.4));
  run.template set<Gravity>({{0.0, 0.0, -g}});
  if constexpr (std::is_same_v<typename Body::Transfer, Flip>) run.template set<Flip>({1.0});
  std::vector<Vec3<double>> at;
  int const n = particles_per_axis;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        at.push_back(dx * vec(3.11 + 0.5 * i, 3.37 + 0.5 * j, 8.05 + 0.5 * k));
  run.add_particles(0, at, 1050.0, dx * dx * dx / 8);
  auto const v0 = vec(0.11, -0.07, 0.2);
  for (std::size_t p = 0; p < at.size(); ++p)
    run.state().template set<particle::Velocity>(0, static_cast<std::int64_t>(p), cast<T>(v0));

  double const dt = 1.25e-4;
  int const steps = 200;
  for (int s = 0; s < steps; ++s) run.step(dt);
  // Particles of a linear shape come so close to nodes that no given step is stable, and the run says so.
  constexpr bool smooth = Body::Shape::inverse_inertia > 0.0;
  CHECK(run.status(0) == (smooth ? 0u : static_cast<std::uint32_t>(Fault::time_step)));
  double const roundings = 4.0 * steps * double(epsilon<T>);
  // Where momentum is rounded when it is shared out, the velocity of a particle walks at random, and C too, whose sum F
  // is. TPIC takes C from slopes: at the edge of a stencil these are many times the weight that a velocity was divided by.
  constexpr double spread = std::is_same_v<typename Body::Transfer, Tpic> ? 300.0 : 12.0;
  double const walk = test::fixed_point_noise(dx, dt, steps, 27, test::quantum<T>),
               walk_of_F = spread * test::quantum<T> * std::pow(steps, 1.5);
  double const size = 14.0 * dx, speed = g * dt * steps;
  for (std::size_t p = 0; p < at.size(); ++p) {
    auto const slot = static_cast<std::int64_t>(p);
    auto const x = cast<double>(run.state().template get<particle::Position>(0, slot));
    auto const v = cast<double>(run.state().template get<particle::Velocity>(0, slot));
    auto const F = cast<double>(run.state().template get<particle::Deformation>(0, slot));
    auto const h = double(T(dt));
    auto const fall = vec(0.0, 0.0, g * h * h * steps * (steps + 1) / 2.0);
    CHECK(norm(x - (at[p] + steps * h * v0 - fall)) < roundings * size + walk * steps * dt);
    CHECK(norm(v - (v0 - vec(0.0, 0.0, steps * g * h))) < roundings * speed + walk);
    // A velocity that is uniform to rounding has gradients of rounding / dx.
    CHECK(norm(F - Mat3<double>::identity()) <
          roundings * speed * dt / dx * 16.0 + roundings + walk_of_F);
  }
}

template <class... Policies> using Body = Mpm<NeoHookean, Policies...>;

}  // namespace

TEMPLATE_TEST_CASE("Free fall is the exact parabola", "", float, double) {
  using T = TestType;
  for (int const n : {1, 3}) {
    CAPTURE(n);
    check_fall<Body<Apic, QuadraticBSpline, Mls>, T>(n);
    check_fall<Body<Apic, CubicBSpline, WeightGradient>, T>(n);
    check_fall<Body<Tpic, QuadraticBSpline, WeightGradient>, T>(n);
    check_fall<Body<Flip, QuadraticBSpline, Mls>, T>(n);
    check_fall<Body<Pic, CubicBSpline, Mls>, T>(n);
#ifndef MPMPBD_PHYSICS_ON_DEVICE  // which refuses linear splines
    check_fall<Body<Flip, LinearBSpline>, T>(n);
#endif
  }
}
