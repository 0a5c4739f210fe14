// Friction and drag of a needle that is drawn along itself through tissue.
// seconds: 60
// on a device
#include "catch.hpp"

#include "physics/needle_in_block.hpp"

namespace {

using namespace test;
using Q = mpmpbd::QuadraticBSpline;
using Rough = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::NoDrag, false>;
using Dragged = mpmpbd::EmbeddedForm<Q, mpmpbd::NoFriction, mpmpbd::Drag, false>;
using Both = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::Drag, false>;

NeedleCase const base{.top = 7, .damping = 0.1};
constexpr double length = 4;  // of needle in tissue [cells]

struct Pull {
  double axial = 0, lateral = 0;
};

// Moves sideways by `shift`, then draws along z until steady; mean forces of the last 20 time units.
template <class B> Pull draw(B& block, double shift, double speed, double settle) {
  double const sideways = shift > 0 ? 0.01 : 0, moving = sideways > 0 ? shift / sideways : 0;
  Pull sum;
  int n = 0;
  while (block.time < moving + settle) {
    block.step(mpmpbd::vec(block.time < moving ? sideways : 0, 0.0, speed));
    if (block.time < moving + settle - 20) continue;
    sum.axial -= block.force[2];
    sum.lateral -= block.force[0];
    ++n;
  }
  return {sum.axial / n, sum.lateral / n};
}

}  // namespace

TEST_CASE("friction is mu times the lateral load", "[coupling][friction]") {
  double xx = 0, xy = 0, yy = 0, sx = 0, sy = 0;
  int n = 0;
  for (double mu : {0.05, 0.2, 0.4})
    for (double shift : {0.2, 0.4}) {
      NeedleInBlock<double, Rough> block(base);
      block.rub(mu, 0);
      Pull const f = draw(block, shift, 0.02, 80);
      double const x = mu * f.lateral, y = f.axial;
      CAPTURE(mu, shift, f.lateral, f.axial, y / x);
      CHECK(std::abs(y / x - 1) < 0.01);
      xx += x * x, xy += x * y, yy += y * y, sx += x, sy += y, ++n;
    }
  double const slope = xy / xx, correlation = (xy - sx * sy / n) /
                                              std::sqrt((xx - sx * sx / n) * (yy - sy * sy / n));
  CAPTURE(slope, correlation);
  CHECK(std::abs(slope - 1) < 0.01);
  CHECK(correlation * correlation > 0.999);
}

TEST_CASE("clamp pressure adds mu times pressure times area", "[coupling][friction]") {
  for (double squeeze : {0.0, 0.3, -0.5}) {  // the tissue's own pressure; tension may not pull
    NeedleCase c = base;
    c.pressure = squeeze;
    NeedleInBlock<double, Rough> block(c);
    block.rub(0.3, 0.2);
    Pull const f = draw(block, 0, 0.02, 80);
    double const expected =
        0.3 * std::max(0.0, 0.2 + squeeze) * 2 * mpmpbd::pi<double> * 0.1 * length;
    CAPTURE(squeeze, f.axial, expected);
    CHECK(std::abs(f.axial - expected) < 0.01 * expected + 1e-6);
  }
}

TEST_CASE("drag is proportional to speed for any time step", "[coupling][drag]") {
  for (double dt : {0.2, 0.1, 0.05, 0.025}) {
    NeedleCase c = base;
    c.dt = dt;
    NeedleInBlock<double, Dragged> block(c);
    block.drag(1);
    Pull const f = draw(block, 0, 0.02, 70);
    CAPTURE(dt, f.axial / (0.02 * length));
    CHECK(std::abs(f.axial / (0.02 * length) - 1) < 0.01);
  }
}

TEST_CASE("friction and drag add up", "[coupling][drag][friction]") {
  NeedleInBlock<double, Both> block(base);
  block.rub(0.3, 0.2);
  block.drag(1);
  Pull const f = draw(block, 0, 0.02, 80);
  double const expected = 0.3 * 0.2 * 2 * mpmpbd::pi<double> * 0.1 * length + 0.02 * length;
  CHECK(std::abs(f.axial / expected - 1) < 0.01);
}

// Saw: 10 cycles, 20 strokes, along z, with and without lateral load. The tissue may not be pumped away.
TEST_CASE("sawing does not pump the tissue", "[coupling][friction][saw]") {
  for (double shift : {0.0, 0.3}) {
    NeedleInBlock<double, Rough> block(base);
    block.rub(0.2, 0.5);
    double const speed = 0.05, half = 1.0, period = 4 * half / speed;
    double const moving = shift > 0 ? shift / 0.01 : 0;
    while (block.time < moving) block.step(mpmpbd::vec(0.01, 0.0, 0.0));
    double const start = block.time;
    auto const middle = [&] {
      double z = 0;
      for (auto const& p : block.tissue.particles) z += double(p.x[2]);
      return z / (block.u.length * double(block.tissue.particles.size()));
    };
    double loop = 0, at_cycle[11] = {}, least_force = 0, most_force = 0;
    for (int cycle = 0; cycle < 10; ++cycle) {
      at_cycle[cycle] = middle();
      while (block.time - start < (cycle + 1) * period) {
        double const phase = std::fmod(block.time - start, period) / period;
        double const v = phase < 0.25 || phase >= 0.75 ? speed : -speed;
        block.step(mpmpbd::vec(0.0, 0.0, v));
        if (cycle == 9) {
          loop -= block.force[2] * v * block.c.dt;
          least_force = std::min(least_force, block.force[2]);
          most_force = std::max(most_force, block.force[2]);
        }
      }
    }
    at_cycle[10] = middle();
    double const friction = (most_force - least_force) / 2;
    CAPTURE(shift, at_cycle[10] - at_cycle[1], loop, friction);
    CHECK(std::abs(at_cycle[10] - at_cycle[1]) < 0.018);
    CHECK(friction > 0.1);
    CHECK(loop < 4 * friction * half);  // the tissue follows elastically a little
    CHECK(loop > 0.8 * 4 * friction * half);
  }
}
