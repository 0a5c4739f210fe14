// Lateral push of a needle: the force must not depend on where the needle lies between grid nodes.
// seconds: 25
// on a device
#include "catch.hpp"

#include "physics/needle_in_block.hpp"

namespace {

using namespace test;
using Q = mpmpbd::QuadraticBSpline;
using Slippery = mpmpbd::EmbeddedForm<Q, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;

struct Spread {
  double mean = 0, variation = 0, least = 1e300, rough = 0;
};

// Mean force between 0.2 and 0.3 cells of displacement, over 16 positions between the nodes.
template <class T> Spread push(double spacing, int sweeps) {
  Spread s;
  double squares = 0;
  for (int o = 0; o < 16; ++o) {
    NeedleInBlock<T, Slippery> block({.x = 7.03 + 0.25 * (o % 4),
                                      .y = 7.03 + 0.25 * (o / 4),
                                      .spacing = spacing,
                                      .sweeps = sweeps});
    double const speed = 0.02;
    double sum = 0;
    int n = 0;
    while (block.time * speed < 0.3) {
      block.step(mpmpbd::vec(speed, 0.0, 0.0));
      if (block.time * speed < 0.2) continue;
      sum -= block.force[0];
      ++n;
      s.rough = std::max(s.rough, block.rough);
    }
    sum /= n;
    s.mean += sum / 16;
    squares += sum * sum / 16;
    s.least = std::min(s.least, sum);
  }
  s.variation = std::sqrt(std::max(0.0, squares - s.mean * s.mean)) / s.mean;
  return s;
}

// The reference scheme for contrast: nodes closer than a radius are projected, nothing else happens.
double push_nodes(double radius, int o) {
  NeedleInBlock<double, Slippery> block({.x = 7.03 + 0.25 * (o % 4), .y = 7.03 + 0.25 * (o / 4)});
  auto& r = block.rig;
  auto const& u = block.u;
  double const speed = 0.02, dt = block.c.dt;
  double sum = 0, x = block.c.x;
  int n = 0;
  for (; block.time * speed < 0.3; block.time += dt, x += speed * dt) {
    block.tissue.scatter(r);
    double force = 0;
    for (int k = 0, i = 0; k < 14; ++k)
      for (int b = 0; b < 16; ++b)
        for (int a = 0; a < 16; ++a, ++i) {
          auto& v = r.velocity[std::size_t(i)];
          double const m = r.mass[std::size_t(i)], step = dt / u.speed();
          auto const away = mpmpbd::vec(a + step * v[0] - x, b + step * v[1] - block.c.y, 0.0);
          if (m < 1e-4 * u.mass() || block.tissue.fixed[std::size_t(i)] ||
              mpmpbd::norm(away) >= radius)
            continue;
          auto const wanted = mpmpbd::vec(u.speed() * speed, 0.0, v[2]);
          if (mpmpbd::dot(v - wanted, away) >= 0) continue;
          force += m * (wanted - v)[0] / (r.dt * u.force());
          v = wanted;
        }
    block.tissue.gather(r);
    if (block.time * speed < 0.2) continue;
    sum += force;
    ++n;
  }
  return sum / n;
}

}  // namespace

TEMPLATE_TEST_CASE("lateral force is the same between the nodes", "[coupling][push]", double,
                   float) {
  Spread const fine = push<TestType>(0.5, 2), coarse = push<TestType>(1.0, 2);
  CAPTURE(fine.mean, fine.variation, fine.least / fine.mean, fine.rough, coarse.mean,
          coarse.variation, coarse.least / coarse.mean);
  for (Spread const& s : {fine, coarse}) {
    CHECK(s.variation < 0.06);
    CHECK(s.least > 0.9 * s.mean);
    CHECK(s.rough < 1.02);  // impulses do not fight each other
  }
  CHECK(std::abs(coarse.mean / fine.mean - 1) < 0.04);
  if (sizeof(TestType) == 8) {
    Spread const converged = push<TestType>(0.5, 40);
    CAPTURE(converged.mean, converged.variation);
    CHECK(std::abs(fine.mean / converged.mean - 1) < 0.03);
  }
}

TEST_CASE("node projection with a radius leaks between the nodes", "[coupling][push][control]") {
  double mean = 0, squares = 0;
  for (int o = 0; o < 16; ++o) {
    double const f = push_nodes(0.25, o);
    mean += f / 16;
    squares += f * f / 16;
  }
  CAPTURE(mean, squares);
  CHECK(std::sqrt(squares - mean * mean) > mean);
}
