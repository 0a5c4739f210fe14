// Momentum, order, limits: what one exchange must keep besides energy.
#include "catch.hpp"

#include <algorithm>

#include "coupling/random_rig.hpp"

namespace {

using namespace test;
using mpmpbd::cross;
using mpmpbd::dot;
using mpmpbd::norm;

using Q = mpmpbd::QuadraticBSpline;
using Slippery = mpmpbd::EmbeddedForm<Q, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;
using Rough = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::NoDrag, false>;
using RoughDragged = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::Drag, false>;
using Stiff = mpmpbd::EmbeddedForm<Q, mpmpbd::NoFriction, mpmpbd::NoDrag, true>;
using Bending = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::NoDrag, true>;

Units const unit{};

template <class T> Vec3<double> wide(Vec3<T> const& a) { return mpmpbd::cast<double>(a); }

struct Momenta {
  Vec3<double> linear{}, angular{};
  double linear_size = 0, angular_size = 0;
  void add(double m, Vec3<double> const& x, Vec3<double> const& v) {
    linear += m * v;
    angular += m * cross(x, v);
    linear_size += m * norm(v);
    angular_size += m * norm(cross(x, v));
  }
};

// Angular momentum about the origin, with the thread at the given bead positions.
template <class T, class Form>
Momenta momenta(Rig<T, Form> const& r, std::vector<Vec3<T>> const& bead) {
  Momenta sum;
  int const nx = r.lattice.nodes[0], ny = r.lattice.nodes[1];
  for (std::size_t i = 0; i < r.mass.size(); ++i) {
    int const n = static_cast<int>(i);
    auto const x = r.lattice.position(n % nx, n / nx % ny, n / nx / ny);
    if (r.mass[i] > 0) sum.add(double(r.mass[i]), wide(x), wide(r.velocity[i]));
  }
  for (std::size_t k = 0; k < bead.size(); ++k)
    sum.add(double(r.bead_mass[k]), wide(bead[k]), wide(r.bead_velocity[k]));
  if (r.needle.motion == Motion::dynamic) {
    sum.add(double(r.needle.mass), wide(r.needle.centre), wide(r.needle.velocity));
    sum.angular += wide(r.needle.inertia * r.needle.spin);
  }
  return sum;
}

// What exchanges change of both momenta, relative to the sizes of their parts: the worst of all.
struct Changes {
  double linear = 0, turning = 0, size = 0;  // size: of the last one [kg m/s]

  template <class T, class Form> void couple(Rig<T, Form>& r) {
    auto const bead = r.bead;
    auto const before = momenta(r, bead);
    REQUIRE(r.couple(0.0) == 0u);
    auto const after = momenta(r, bead);
    size = std::max(before.linear_size, after.linear_size);
    linear = std::max(linear, norm(after.linear - before.linear) / size);
    turning = std::max(turning, norm(after.angular - before.angular) /
                                    std::max(before.angular_size, after.angular_size));
  }
};

template <class T, class Form> void conserves(Extras const& extra, bool angular) {
  Draw d(3);
  double const tolerance = sizeof(T) == 4 ? 1e-5 : 1e-12;
  Changes changes;
  double exchanged = 0;
  for (int n = 0; n < 300; ++n) {
    auto r = random_rig<T, Form>(d, extra);
    changes.couple(r);
    for (auto const& p : r.points) exchanged += double(norm(p.impulse)) / changes.size;
  }
  CAPTURE(changes.linear, changes.turning, exchanged, sizeof(T));
  CHECK(changes.linear < tolerance);
  if (angular) CHECK(changes.turning < tolerance);
  CHECK(exchanged > 1);  // momentum did pass between tissue and thread
}

}  // namespace

// Tension and bending stiffen the thread across its direction, implicitly: that part conserves linear
// momentum exactly and angular momentum to second order in dt, like every implicit Euler step. Everything
// else conserves both to rounding.
TEMPLATE_TEST_CASE("momentum and angular momentum pass through a free surface",
                   "[coupling][momentum]", double, float) {
  Extras const slack{.surface = true, .tension = false};
  conserves<TestType, Slippery>(slack, true);
  conserves<TestType, RoughDragged>(slack, true);
  conserves<TestType, Rough>({.needle = true, .surface = true, .tension = false}, true);
  conserves<TestType, Rough>({.needle = true, .swage = true, .surface = true, .tension = false},
                             true);
  conserves<TestType, Rough>({.one_sided = true, .surface = true, .tension = false}, true);
  conserves<TestType, Bending>({.needle = true, .surface = true}, false);
}

TEST_CASE("the order of points and beads does not matter", "[coupling]") {
  Draw d(5);
  double worst = 0;
  for (int n = 0; n < 200; ++n) {
    auto a = random_rig<double, Bending>(d, {.needle = true});
    auto b = a;
    std::reverse(b.bead.begin(), b.bead.end());
    std::reverse(b.bead_velocity.begin(), b.bead_velocity.end());
    std::reverse(b.bead_mass.begin(), b.bead_mass.end());
    std::reverse(b.rest_angle.begin(), b.rest_angle.end());
    std::reverse(b.rest_length.begin(), b.rest_length.end() - 1);
    std::reverse(b.impulse.begin(), b.impulse.end() - 1);
    auto const needle = b.points.begin() + b.thread_points();
    std::reverse(b.points.begin(), needle);
    std::reverse(needle, b.points.end());
    REQUIRE(a.couple(0.0) == 0u);
    REQUIRE(b.couple(0.0) == 0u);
    double scale = 0, apart = 0;
    for (std::size_t i = 0; i < a.velocity.size(); ++i) {
      scale = std::max(scale, norm(a.velocity[i]));
      apart = std::max(apart, norm(a.velocity[i] - b.velocity[i]));
    }
    for (std::size_t k = 0; k < a.bead.size(); ++k)
      apart = std::max(apart, norm(a.bead_velocity[k] - b.bead_velocity[a.bead.size() - 1 - k]));
    worst = std::max(worst, apart / scale);
  }
  CHECK(worst < 1e-8);
}

TEST_CASE("a thread outside the tissue and the tissue itself do not feel each other",
          "[coupling]") {
  Draw d(7);
  auto r = random_rig<double, Rough>(d, {});
  std::fill(r.mass.begin(), r.mass.end(), 0.0);
  std::fill(r.inverse_mass.begin(), r.inverse_mass.end(), Vec3<double>{});
  std::fill(r.impulse.begin(), r.impulse.end(), 0.0);
  r.stretch_compliance = 1e6;  // no stretch forces worth a bit either
  auto const grid = r.velocity;
  auto const free = r.bead_velocity;
  REQUIRE(r.couple() == 0u);
  for (std::size_t i = 0; i < grid.size(); ++i) REQUIRE(r.velocity[i] == grid[i]);
  for (std::size_t k = 0; k < free.size(); ++k) REQUIRE(norm(r.bead_velocity[k] - free[k]) < 1e-4);
  for (auto const& p : r.points) REQUIRE(norm(p.impulse) == 0.0);
}

TEST_CASE("walls take no velocity from contact", "[coupling]") {
  Draw d(9);
  int held = 0, free = 0;
  for (int n = 0; n < 100; ++n) {
    auto r = random_rig<double, Rough>(d, {.walls = true});
    auto const before = r.velocity;
    REQUIRE(r.couple(0.0) == 0u);
    for (std::size_t i = 0; i < before.size(); ++i)
      for (int a = 0; a < 3; ++a) {
        if (r.inverse_mass[i][a] == 0.0) {
          REQUIRE(r.velocity[i][a] == before[i][a]);
          held += 1;
        } else {
          free += r.velocity[i][a] != before[i][a];
        }
      }
  }
  CHECK(held > 1000);
  CHECK(free > 1000);
}

TEST_CASE("one-sided points never pull and a tip keeps its cap", "[coupling]") {
  Draw d(11);
  int pushing = 0, capped = 0;
  for (int n = 0; n < 300; ++n) {
    auto r = random_rig<double, Rough>(d, {.needle = true, .one_sided = true});
    REQUIRE(r.couple(0.0) == 0u);
    auto const x = r.view();
    for (int q = 0; q < x.count(); ++q) {
      auto const& p = r.points[static_cast<std::size_t>(q)];
      if (!x.on[q]) continue;
      double const along = dot(p.axis, p.impulse);
      if (p.contact == Contact::tip) {
        CHECK(along >= -1e-12 * unit.impulse());
        CHECK(along <= p.force_cap * r.dt * (1 + 1e-9));
        capped += x.work[q].hold == mpmpbd::Hold::full;
      }
      if (p.contact == Contact::surface) {
        CHECK(along >= -1e-12 * unit.impulse());
        pushing += along > 0;
      }
    }
  }
  CHECK(pushing > 100);
  CHECK(capped > 10);
}

// A stiff thread held by many points pulls at some of them. When these let go it turns about the others, and some of those
// pull in their turn: who touches is found only when points also take hold again.
TEST_CASE("at the end of a sweep no point pulls and none that let go goes in", "[coupling]") {
  Draw d(17);
  int touching = 0, open = 0;
  for (int n = 0; n < 2000; ++n) {
    auto r = random_rig<double, Stiff>(d, {.one_sided = true});
    mpmpbd::Solo const team;
    auto const x = r.view();
    auto const nodes = r.nodes();
    mpmpbd::place_thread_points(team, x);
    mpmpbd::embed_points(team, x, nodes);
    mpmpbd::detail::Exchange<mpmpbd::Solo, double, Stiff, GridNodes<double>> const e(team, x,
                                                                                     nodes);
    REQUIRE(e.begin() == 0u);
    e.move_alone();
    e.warm_start();
    e.observe();
    e.sweep(true);
    for (int q = 0; q < x.thread_points(); ++q) {
      auto const& p = r.points[std::size_t(q)];
      auto const& w = x.work[q];
      if (!x.on[q] || p.contact != Contact::surface) continue;
      CAPTURE(n, q);
      double const apart = dot(p.axis, w.u + w.D * w.dJ - e.body_velocity(q));
      CHECK(dot(p.axis, w.J) > -1e-12 * unit.impulse());
      CHECK(apart > -1e-9 * unit.speed());
      ++(w.hold == mpmpbd::Hold::open ? open : touching);
    }
  }
  CHECK(touching > 300);
  CHECK(open > 300);
}

TEST_CASE("the needle's wrench is what the grid lost", "[coupling]") {
  Draw d(13);
  for (int n = 0; n < 50; ++n) {
    auto r = random_rig<double, Rough>(d, {.needle = true, .kinematic = true});
    for (int q = 0; q < r.thread_points(); ++q)
      r.points[static_cast<std::size_t>(q)].contact = Contact::off;
    auto x = r.view();
    auto const grid = r.velocity;
    mpmpbd::place_thread_points(mpmpbd::Solo{}, x);
    mpmpbd::embed_points(mpmpbd::Solo{}, x, r.nodes());
    REQUIRE(mpmpbd::exchange(mpmpbd::Solo{}, x, r.nodes()) == 0u);
    Vec3<double> const about = vec(1.0, 2.0, 3.0);
    Vec3<double> force{}, moment{};
    int const nx = 12, ny = 12;
    double size = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      int const m = static_cast<int>(i);
      Vec3<double> const f = r.mass[i] / r.dt * (r.velocity[i] - grid[i]);
      force -= f;
      moment -= cross(r.lattice.position(m % nx, m / nx % ny, m / nx / ny) - about, f);
      size += norm(f);
    }
    auto const w = mpmpbd::needle_wrench(x, about);
    CHECK(norm(w.force - force) < 1e-12 * size);
    CHECK(norm(w.moment - moment) < 1e-11 * size * unit.length);
    CHECK(size > 1e-3 * unit.force());
  }
}

TEST_CASE("known beads keep their velocity and the rest follows them", "[coupling]") {
  Draw d(15);
  auto r = random_rig<double, Rough>(d, {});
  r.known[0] = 1;
  r.bead_velocity[0] = vec(0.3, -0.2, 0.1);
  auto const x0 = r.bead[0];
  REQUIRE(r.couple() == 0u);
  CHECK(r.bead_velocity[0] == vec(0.3, -0.2, 0.1));
  CHECK(norm(r.bead[0] - x0 - r.dt * r.bead_velocity[0]) < 1e-15);
}

TEST_CASE("an attachment to tissue moves with it", "[coupling]") {
  auto r = full_rig<Slippery>(unit, 12);
  auto const speed = unit.speed() * vec(0.5, 0.0, 0.0);
  std::fill(r.velocity.begin(), r.velocity.end(), speed);
  for (int k = 0; k < 5; ++k) r.add_bead(unit.length * vec(3.0 + k, 6.0, 6.0), 1e-3 * unit.mass());
  r.stretch_compliance = 1e-3 / unit.force();
  mpmpbd::ContactPoint<double> tie{};
  tie.contact = Contact::tied;
  tie.segment = 4 - 1;
  tie.along = 1;
  tie.position = r.bead[4];
  r.allocate({}, {tie});
  for (int q = 0; q < r.thread_points(); ++q)
    r.points[static_cast<std::size_t>(q)].contact = Contact::off;
  auto x = r.view();
  mpmpbd::place_thread_points(mpmpbd::Solo{}, x);
  for (int q = 0; q < r.thread_points(); ++q)
    r.points[static_cast<std::size_t>(q)].contact = Contact::off;
  mpmpbd::embed_points(mpmpbd::Solo{}, x, r.nodes());
  REQUIRE(mpmpbd::exchange(mpmpbd::Solo{}, x, r.nodes()) == 0u);
  CHECK(norm(r.bead_velocity[4] - speed) < 0.02 * norm(speed));
  CHECK(r.bead_velocity[0][0] > 0.9 * speed[0]);  // and draws its thread along
  CHECK(norm(r.bead_velocity[0] - r.bead_velocity[4]) < 0.1 * norm(speed));
}

TEST_CASE("too many touched nodes are reported, in the same way every time", "[coupling]") {
  Draw d(17);
  auto r = random_rig<double, Rough>(d, {});
  r.touched_nodes = 25;
  r.allocate();
  auto again = r;
  auto const before = momenta(r, r.bead);
  auto const bead = r.bead;
  REQUIRE(r.couple(0.0) == static_cast<std::uint32_t>(mpmpbd::Fault::overflow));
  auto const after = momenta(r, bead);
  CHECK(norm(after.linear - before.linear) < 1e-12 * after.linear_size);
  REQUIRE(again.couple(0.0) != 0u);
  for (std::size_t i = 0; i < r.velocity.size(); ++i) REQUIRE(r.velocity[i] == again.velocity[i]);
}

TEST_CASE("a singular thread changes nothing and reports no impulse", "[coupling]") {
  Draw d(19);
  auto r = random_rig<double, Rough>(d, {});
  for (auto& p : r.points) p.impulse = vec(1e-6, -2e-6, 3e-6);
  r.impulse.assign(r.impulse.size(), 1e-6);
  r.stretch_compliance = 0;
  r.known[1] = r.known[2] = 1;
  auto const grid = r.velocity;
  auto const bead = r.bead;
  REQUIRE(r.couple() == static_cast<std::uint32_t>(mpmpbd::Fault::solver));
  for (std::size_t i = 0; i < grid.size(); ++i) REQUIRE(r.velocity[i] == grid[i]);
  for (std::size_t k = 0; k < bead.size(); ++k) REQUIRE(r.bead[k] == bead[k]);
  for (auto const& p : r.points) CHECK(p.impulse == Vec3<double>{});
  for (double const impulse : r.impulse) CHECK(impulse == 0.0);
}

TEST_CASE("float agrees with double", "[coupling]") {
  Draw d(21), f(21);
  double worst = 0;
  for (int n = 0; n < 100; ++n) {
    auto a = random_rig<double, Slippery>(d, {.needle = true});
    auto b = random_rig<float, Slippery>(f, {.needle = true});
    REQUIRE(a.couple() == 0u);
    REQUIRE(b.couple() == 0u);
    double scale = 0, apart = 0;
    for (std::size_t i = 0; i < a.velocity.size(); ++i) {
      scale = std::max(scale, norm(a.velocity[i]));
      apart = std::max(apart, norm(a.velocity[i] - wide(b.velocity[i])));
    }
    worst = std::max(worst, apart / scale);
  }
  CHECK(worst < 1e-3);
}

// Ping-pong: a light thread between two exchanges must not answer with -(grid mass / thread mass), as that of the
// paper does (grid_projection.cpp).
TEST_CASE("slip never grows, whatever the mass ratio", "[coupling][B19]") {
  for (double ratio : {1e-4, 1e-2, 1.0, 1e2, 1e4}) {
    auto r = full_rig<Slippery>(unit, 10);
    for (double z : {4.1, 5.1}) r.add_bead(unit.length * vec(4.3, 4.6, z), ratio * unit.mass());
    for (auto& v : r.bead_velocity) v = vec(unit.speed(), 0.0, 0.0);
    r.stretch_compliance = 1e-3 / unit.force();
    r.allocate();
    double energy = kinetic_energy(r);
    auto const slip = [&] { return std::max(norm(r.slip(0)), norm(r.slip(1))); };
    auto const before = momenta(r, r.bead);
    for (int n = 0; n < 10; ++n) {
      mpmpbd::place_thread_points(mpmpbd::Solo{}, r.view());
      double const before_it = slip();
      REQUIRE(r.couple() == 0u);
      double const e = kinetic_energy(r);
      CAPTURE(ratio, n, before_it, slip());
      CHECK(slip() <= before_it);
      CHECK(e <= energy * (1 + 1e-12));
      energy = e;
    }
    CHECK(norm(momenta(r, r.bead).linear - before.linear) < 1e-12 * before.linear_size);
  }
}

// A point between two beads acts on both by its place between them. On the nearer one alone the moment
// J x (x_i - x_c) would be lost.
TEMPLATE_TEST_CASE("points between beads keep momentum and angular momentum", "[coupling][A4.8]",
                   double, float) {
  using T = TestType;
  Draw d(25);
  double const tolerance = sizeof(T) == 4 ? 1e-5 : 1e-12;
  Changes changes;
  double exchanged = 0;
  for (int n = 0; n < 100; ++n) {
    auto r = random_rig<T, Slippery>(d, {.tension = false});
    std::vector<mpmpbd::ContactPoint<T>> between;
    for (int k = 0; k + 1 < r.beads(); ++k) {
      mpmpbd::ContactPoint<T> p{};
      p.contact = Contact::tied;
      p.segment = k;
      p.along = T(d.uniform());
      auto const& a = r.bead[std::size_t(k)];
      p.position = a + p.along * (r.bead[std::size_t(k) + 1] - a);
      between.push_back(p);
    }
    r.allocate({}, between);
    changes.couple(r);
    for (int q = r.thread_points(); q < r.view().count(); ++q)
      exchanged += double(norm(r.points[std::size_t(q)].impulse)) / changes.size;
  }
  CAPTURE(changes.linear, changes.turning, exchanged, sizeof(T));
  CHECK(changes.linear < tolerance);
  CHECK(changes.turning < tolerance);
  CHECK(exchanged > 0.1);
}

// What is carried from substep to substep are forces: with twice the impulses of a step twice as long before, an
// exchange is the same to the bit.
TEST_CASE("carried impulses follow the length of the step", "[coupling][warm_start]") {
  Draw d(27);
  double carried = 0;
  for (int n = 0; n < 100; ++n) {
    auto a = random_rig<double, Bending>(d, {.needle = true, .one_sided = true});
    auto b = a;
    b.previous_dt = 2 * b.dt;
    for (auto& impulse : b.impulse) impulse *= 2;
    for (auto& p : b.points) {
      carried += norm(p.impulse) / unit.impulse();
      p.impulse *= 2;
    }
    REQUIRE(a.couple(0.0) == 0u);
    REQUIRE(b.couple(0.0) == 0u);
    for (std::size_t i = 0; i < a.velocity.size(); ++i) REQUIRE(a.velocity[i] == b.velocity[i]);
    for (std::size_t k = 0; k < a.bead.size(); ++k) {
      REQUIRE(a.bead_velocity[k] == b.bead_velocity[k]);
      REQUIRE(a.impulse[k] == b.impulse[k]);
    }
    REQUIRE(a.needle.velocity == b.needle.velocity);
  }
  CHECK(carried > 1);
}

// B5: within half a cell of the border a stencil lacks a node. int(x/dx - 1/2) instead of floor would find one there,
// with weights (0.98, -0.06, 0.08).
TEST_CASE("a point that lacks a node is not in the grid", "[coupling][B5]") {
  auto r = full_rig<Slippery>(unit, 10);
  double w[27];
  int node[27];
  for (int axis = 0; axis < 3; ++axis) {
    auto const mass_around = [&](double cells) {
      auto x = unit.length * vec(4.3, 4.7, 4.2);
      x[axis] = cells * unit.length;
      return mpmpbd::embedding_weights<Q>(r.lattice, x, r.nodes(), w, node);
    };
    for (double const beyond : {-40.0, -0.4, 0.02, 0.3, 0.49, 8.51, 9.4, 1e12}) {
      CAPTURE(axis, beyond);
      CHECK(mass_around(beyond) == 0.0);
    }
    for (double const within : {0.51, 0.9, 4.0, 8.49}) {
      CAPTURE(axis, within);
      CHECK(mass_around(within) == Approx(unit.mass()).epsilon(1e-12));
    }
  }
}

// One impulse near a free surface: with corrected weights force and moment reach the grid whole.
TEST_CASE("an impulse and its moment arrive whole", "[coupling][A4.8]") {
  Draw d(23);
  double corrected = 0, plain = 0;
  int used = 0;
  for (int n = 0; n < 500; ++n) {
    auto r = random_rig<double, Slippery>(d, {.surface = true});
    Vec3<double> const x =
        unit.length * vec(3 + 5 * d.uniform(), 3 + 5 * d.uniform(), 3 + 2.8 * d.uniform());
    Vec3<double> const J = d.arrow<double>();
    double w[27];
    int node[27];
    double const total = mpmpbd::embedding_weights<Q>(r.lattice, x, r.nodes(), w, node);
    if (!(total > 0)) continue;
    used += 1;
    Vec3<double> sum{}, moment{}, plain_sum{}, plain_moment{};
    auto const s = mpmpbd::detail::neighbourhood<Q>(r.lattice, x);
    mpmpbd::detail::for_each_node<Q>(
        r.lattice, s, [&](int a, int i, double plain_w, Vec3<double> const& offset) {
          sum += w[a] * J;
          moment += w[a] * cross(x + offset, J);
          double const pw =
              r.mass[std::size_t(i)] > 0 ? plain_w : 0;  // an empty node takes nothing
          plain_sum += pw * J;
          plain_moment += pw * cross(x + offset, J);
        });
    auto const lost = [&](Vec3<double> const& force, Vec3<double> const& turn) {
      return (norm(force - J) + norm(turn - cross(x, J)) / unit.length) / norm(J);
    };
    corrected = std::max(corrected, lost(sum, moment));
    plain = std::max(plain, lost(plain_sum, plain_moment));
  }
  CHECK(used > 300);
  CHECK(corrected < 1e-11);
  CHECK(plain > 1e-2);
}

// In one visit of the nodes, with sums instead of weights.
TEST_CASE("the mean around a point is the one that its weights give", "[coupling][A4.8]") {
  Draw d(29);
  int used = 0;
  double worst = 0, least_mass = 1;
  for (int n = 0; n < 500; ++n) {
    auto r = random_rig<double, Slippery>(d, {.surface = true});
    Vec3<double> const x =
        unit.length * vec(3 + 5 * d.uniform(), 3 + 5 * d.uniform(), 3 + 3.2 * d.uniform());
    double const nothing = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < r.mass.size(); ++i)
      if (r.mass[i] == 0) r.velocity[i] = vec(nothing, nothing, nothing);
    double w[27];
    int node[27];
    double const mass = mpmpbd::embedding_weights<Q>(r.lattice, x, r.nodes(), w, node);
    auto const mean = mpmpbd::embedded_mean<Q>(r.lattice, x, r.nodes(),
                                               [&](int i) { return r.velocity[std::size_t(i)]; });
    CHECK(mean.mass == mass);
    if (!(mass > 0)) continue;
    used += 1;
    least_mass = std::min(least_mass, mass / unit.mass());
    Vec3<double> sum{};
    double size = 0;
    for (int a = 0; a < 27; ++a)
      if (w[a] != 0) {
        Vec3<double> const v = r.velocity[std::size_t(node[a])];
        sum += w[a] * v, size += std::abs(w[a]) * norm(v);
      }
    worst = std::max(worst, norm(mean.value - sum) / size);
  }
  CHECK(used > 300);
  CHECK(used < 500);
  CHECK(least_mass < 0.1);  // also where the correction is great
  CHECK(worst < 1e-13);
}
