// A2.12, A3.15: a block slides on a wall with friction, down a slope (matter's case: 24 degrees, mu = tan 15 degrees, 5 s:
// 19.859471 m within 1e-3) and to a stop after v^2 / (2 mu g) (within 1 %).
// seconds: 10
// on a device
#include "catch.hpp"
#include "physics/back_end.hpp"

#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/frictional_wall.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/scene/totals.hpp>

using namespace mpmpbd;

namespace {

constexpr double dx = 0.16, g = 9.81, density = 1050.0;
constexpr int points = 144;
using Ground = FrictionalWall<2, Side::low>;
struct Sliding : Scene<Mpm<FixedCorotated>, Gravity, Damping, Ground> {};

// A stiff block of 3 x 3 x 2 cells on the ground, which is the third plane of nodes.
class Block {
 public:
  explicit Block(int length)
      : run_({.environments = 1,
              .cell_size = dx,
              .nodes = {length, 10, 9},
              .capacity = {{"particle", points}}}) {
    run_.set<FixedCorotated>(lame(2e5, 0.3));
    std::vector<Vec3<double>> at;
    for (int n = 0; n < points; ++n)
      at.push_back(dx *
                   (vec(3.0, 3.0, 2.0) + 0.5 * vec(n % 6 + 0.5, n / 6 % 6 + 0.5, n / 36 + 0.5)));
    run_.add_particles(0, at, density, dx * dx * dx / 8);
  }

  // Pressed and pulled [m/s^2] until it is at rest.
  void settle(double along, double onto, double friction) {
    load(along, onto, friction, 20.0);
    run(1.0);
    for (std::int64_t p = 0; p < points; ++p) {
      run_.state().set<particle::Velocity>(0, p, {});
      run_.state().set<particle::Affine>(0, p, {});
    }
  }
  void push(double speed) {
    for (std::int64_t p = 0; p < points; ++p)
      run_.state().set<particle::Velocity>(0, p, vec(speed, 0.0, 0.0));
  }
  void load(double along, double onto, double friction, double damping = 0.0) {
    run_.set<Gravity>({{along, 0.0, -onto}});
    run_.set<Ground>({2 * dx, friction});
    run_.set<Damping>({damping});
  }
  // Symplectic Euler is ahead of a constant acceleration by a dt t / 2: short steps.
  void run(double time) {
    for (int n = 0; n < std::lround(time / 1e-3); ++n) run_.step(1e-3);
  }
  double place() const {
    double x = 0.0;
    for (std::int64_t p = 0; p < points; ++p)
      x += run_.state().get<particle::Position>(0, p)[0] / points;
    return x;
  }
  double kinetic() const { return tissue_totals(run_, 0).kinetic; }
  std::uint32_t status() const { return run_.status(0); }

 private:
  Simulation<Sliding, test::BackEnd, double> run_;
};

}  // namespace

// It starts settled and in motion: at rest its foot would stick while its head already slides.
TEST_CASE("A2.12: a block slides down a slope", "[mpm][friction]") {
  double const slope = 24 * pi<double> / 180, mu = std::tan(15 * pi<double> / 180);
  double const along = g * std::sin(slope), onto = g * std::cos(slope), speed = 1.0, time = 5.0;
  Block block(180);
  block.settle(0.0, onto, 0.0);
  block.load(along, onto, mu);
  block.push(speed);
  double const start = block.place();
  block.run(time);
  double const exact = 0.5 * (along - mu * onto) * time * time;
  CHECK(exact == Approx(19.859471).epsilon(1e-6));
  CHECK(block.place() - start - speed * time == Approx(exact).epsilon(1e-3));
  CHECK(block.status() == 0);
}

TEST_CASE("A2.12: a block stays on a slope that is not steep enough", "[mpm][friction]") {
  double const slope = 14 * pi<double> / 180;
  Block block(14);
  block.settle(g * std::sin(slope), g * std::cos(slope), 1e3);
  block.load(g * std::sin(slope), g * std::cos(slope), std::tan(15 * pi<double> / 180));
  double const start = block.place();
  block.run(5.0);
  CHECK(std::abs(block.place() - start) < 0.01 * dx);
}

TEST_CASE("A2.12: a sliding block stops where its energy is spent", "[mpm][friction]") {
  for (double mu : {0.2, 0.5}) {
    double const speed = 3.0, stop = speed * speed / (2 * mu * g);
    Block block(30);
    block.settle(0.0, g, 0.0);
    block.load(0.0, g, mu);
    block.push(speed);
    double const start = block.place(), kinetic = block.kinetic();
    block.run(3.0);
    CAPTURE(mu);
    CHECK(block.place() - start == Approx(stop).epsilon(0.01));
    CHECK(block.kinetic() < 1e-4 * kinetic);
  }
}

// m (a - mu g)^2 t^2 / 2, and nothing below mu g, where an elastic block still trembles: 1e-9 of what friction holds back.
TEST_CASE("A3.15: what friction leaves of a pull becomes motion", "[mpm][friction]") {
  double const mu = 0.3, time = 2.0, mass = density * 18 * dx * dx * dx;
  for (double const pull : {0.9, 2.0, 3.0}) {  // of mu g
    Block block(110);
    block.settle(0.9 * mu * g, g, mu);
    block.load(pull * mu * g, g, mu);
    block.run(time);
    double const held = mu * g * time, speed = std::max(0.0, pull - 1.0) * held;
    auto const energy = [&](double v) { return 0.5 * mass * v * v; };
    CAPTURE(pull);
    CHECK(block.kinetic() == Approx(energy(speed)).epsilon(0.02).margin(1e-9 * energy(held)));
    CHECK(block.status() == 0);
  }
}
