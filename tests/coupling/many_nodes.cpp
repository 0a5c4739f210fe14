// A body whose points lie in many nodes, or many in the same ones (B20).
#include "catch.hpp"

#include <algorithm>
#include <cmath>

#include "coupling/random_rig.hpp"

namespace {

using namespace test;

using Slippery =
    mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;

Units const unit{};

// Control: every point of the needle takes its slip away with its own effective mass, all at once.
template <class Form> void all_at_once(Rig<double, Form>& r) {
  auto x = r.view();
  int const count = static_cast<int>(r.points.size());
  mpmpbd::embed_points(mpmpbd::Solo{}, x, r.nodes());
  std::vector<char> on(r.points.size(), 1);
  mpmpbd::connect(mpmpbd::Solo{}, x.incidence, count, reinterpret_cast<bool*>(on.data()),
                  [](int) { return 1.0; });
  auto& c = x.incidence;
  for (int i = 0; i < c.count(); ++i) {
    c.nodes[i].velocity = r.velocity[std::size_t(c.nodes[i].index)];
    c.nodes[i].free_inverse_mass = 1 / r.mass[std::size_t(c.nodes[i].index)];
  }
  std::vector<Vec3<double>> J;
  for (int q = 0; q < count; ++q) {
    double const of_tissue = mpmpbd::sum_over_nodes<double>(
        c, q,
        [](double sum, double w, auto const& n) { return sum + w * w * n.free_inverse_mass; });
    double const yields = 1 / r.needle.mass + of_tissue;
    J.push_back(1 / yields * (r.needle.velocity - mpmpbd::grid_velocity(c, q)));
  }
  for (int i = 0; i < c.count(); ++i)
    r.velocity[std::size_t(c.nodes[i].index)] +=
        c.nodes[i].free_inverse_mass *
        mpmpbd::sum_over_points(c, i, [&](int q) { return J[std::size_t(q)]; });
  for (auto const& j : J) r.needle.velocity -= 1 / r.needle.mass * j;
}

// A body that cannot turn, at rest, in tissue that moves past it, with `count` points that share no nodes; what a
// point feels of the tissue is a hundred times as heavy as the body. With slip d, all at once makes it
// (1 - (100 N + 1)/101) d.
constexpr double heavier = 100;
Rig<double, Slippery> body_in_many_nodes(int count, double& felt) {
  auto r = full_rig<Slippery>(unit, 17);
  std::vector<mpmpbd::ContactPoint<double>> points;
  for (int i = 0; i < count; ++i) {
    mpmpbd::ContactPoint<double> p{};  // in the middle of 3 x 3 x 3 nodes of its own
    p.position = unit.length * vec(2.0 + 3 * (i % 5), 2.0 + 3 * (i / 5 % 5), 2.0 + 3 * (i / 25));
    p.segment = -1;
    p.contact = Contact::tied;
    points.push_back(p);
  }
  double const w = 0.75 * 0.75 + 2 * 0.125 * 0.125;  // sum of the squares of an axis' weights
  felt = unit.mass() / (w * w * w);
  r.needle.motion = Motion::dynamic;
  r.needle.centre = unit.length * vec(8.0, 8.0, 5.0);
  r.needle.mass = felt / heavier;
  r.needle.inertia = 1e20 * r.needle.mass * mpmpbd::square(unit.length) * Mat3<double>::identity();
  std::fill(r.velocity.begin(), r.velocity.end(), unit.speed() * vec(0.3, 0.0, 0.0));
  r.allocate(points);
  return r;
}

}  // namespace

// What is left of the energy that its points feel: exactly that of the common motion, 100 N/(100 N + 1).
TEST_CASE("a light body in many nodes at once loses its slip and no more", "[coupling][B20]") {
  struct Row {
    int count;
    double unsplit, split;  // of verification.md; 0: not given there
  };
  for (Row const& row : {Row{1, 0, 0}, Row{2, 0, 0}, Row{3, 13, 0.9967}, Row{8, 1.5e7, 0.9987},
                         Row{27, 3e13, 0.9996}, Row{81, 0, 0}}) {
    double felt = 0;
    auto r = body_in_many_nodes(row.count, felt);
    auto unsplit = r;
    double const N = row.count, relative = 1 / (heavier * N + 1);
    double const start = kinetic_energy(r),
                 of_points = 0.5 * N * felt * mpmpbd::square(0.3 * unit.speed());
    for (int n = 0; n < 6; ++n) {
      REQUIRE(r.couple() == 0u);
      all_at_once(unsplit);
    }
    double const left = 1 + (kinetic_energy(r) - start) / of_points;
    double const made = 1 + (kinetic_energy(unsplit) - start) / of_points;
    CAPTURE(row.count, left, made);
    CHECK(left == Approx(1 - relative).epsilon(1e-9));
    if (row.split > 0) CHECK(left == Approx(row.split).margin(1e-4));
    double const factor = 1 - (heavier * N + 1) / (heavier + 1);
    CHECK(made == Approx(1 - relative + relative * std::pow(factor, 12)).epsilon(1e-6));
    if (row.unsplit > 0) CHECK(made == Approx(row.unsplit).epsilon(0.07));
  }
}

// Many points in the same nodes at once: splitting must share the nodes among them, for a body that outweighs them most of all.
TEST_CASE("points that share nodes do not over-count", "[coupling][B20]") {
  auto const mass = GENERATE(0.01, 1.0, 100.0);
  for (int count : {1, 2, 3, 8, 27, 81}) {
    auto r = full_rig<Slippery>(unit, 10);
    r.needle.motion = Motion::dynamic;
    r.needle.centre = unit.length * vec(4.6, 4.7, 4.8);
    r.needle.mass = mass * unit.mass();
    r.needle.inertia = r.needle.mass * unit.length * unit.length * Mat3<double>::identity();
    r.needle.velocity = unit.speed() * vec(1.0, 0.5, 0.0);
    std::vector<mpmpbd::ContactPoint<double>> points;
    for (int i = 0; i < count; ++i) {
      mpmpbd::ContactPoint<double> p{};
      p.position = unit.length * vec(4.6, 4.7, 4.3 + (i + 0.5) / count);
      p.axis = vec(0.0, 0.0, 1.0);
      p.segment = -1;
      p.contact = Contact::member;
      points.push_back(p);
    }
    r.allocate(points);
    auto unsplit = r;
    double const start = kinetic_energy(r);
    double last = start;
    for (int n = 0; n < 6; ++n) {
      REQUIRE(r.couple() == 0u);
      CHECK(kinetic_energy(r) <= last * (1 + 1e-12));
      last = kinetic_energy(r);
    }

    for (int n = 0; n < 6; ++n) all_at_once(unsplit);
    CAPTURE(mass, count, kinetic_energy(unsplit) / start, last / start);
    if (count >= 3) CHECK(kinetic_energy(unsplit) > 3 * start);
  }
}
