// The mixed chain solve against one dense matrix.
// seconds: 5
#include "catch.hpp"

#include <cstring>

#include "coupling/random_chain.hpp"
#include "support/lanes.hpp"

namespace {

using test::ChainOptions;
using test::Ends;

struct Errors {
  double velocity = 0;  // against the dense solution, relative to the largest velocity
  double impulse = 0;   // the same for link impulses
  double residual = 0;  // backward error: |M x - b| / (|M| |x| + |b|), largest entries
  int solved = 0;
};

// Solves one random chain both ways and keeps the largest errors.
template <class T, bool bends>
void compare(std::mt19937& random, ChainOptions const& o, Errors& worst) {
  auto c = test::random_chain<T, bends>(random, o);
  test::DenseChain<T, bends> const dense(c);
  auto const solution = test::solve(c);
  if (!solution.regular) {
    // Refused chains must really be singular: a link that cannot stretch between two held beads.
    Eigen::JacobiSVD<Eigen::MatrixXd> const svd(dense.matrix);
    CAPTURE(svd.singularValues().minCoeff(), o.beads, o.inextensible, int(o.ends));
    REQUIRE(svd.singularValues().minCoeff() <
            100 * mpmpbd::epsilon<T> * svd.singularValues().maxCoeff());
    return;
  }
  Eigen::VectorXd const exact = dense.matrix.fullPivLu().solve(dense.rhs);
  Eigen::VectorXd found = exact;
  int const n = c.beads();
  double speed = 0, pull = 0;
  for (int k = 0; k < n; ++k) {
    auto const i = static_cast<std::size_t>(k);
    bool const swaged = c.end.swaged && k == n - 1;
    if (!swaged) {
      found.segment<3>(dense.bead(k)) = test::eigen(solution.V[i]);
      speed = std::max(speed, exact.segment<3>(dense.bead(k)).norm());
      worst.velocity = std::max(worst.velocity, (exact - found).segment<3>(dense.bead(k)).norm() /
                                                    std::max(1.0, exact.head(3 * n).norm()));
    }
    if (k + 1 < n) {
      found(dense.link(k)) = double(solution.lambda[i]);
      pull = std::max(pull, std::abs(exact(dense.link(k))));
    }
  }
  if (c.end.present)
    for (int i = 0; i < 6; ++i) found(dense.body() + i) = double(solution.y[i]);
  for (int k = 0; k + 1 < n; ++k)
    worst.impulse =
        std::max(worst.impulse, std::abs((exact - found)(dense.link(k))) / std::max(1.0, pull));
  Eigen::VectorXd const residual = dense.matrix * found - dense.rhs;
  double const size =
      dense.matrix.cwiseAbs().rowwise().sum().maxCoeff() * found.cwiseAbs().maxCoeff() +
      dense.rhs.cwiseAbs().maxCoeff();
  worst.residual = std::max(worst.residual, residual.cwiseAbs().maxCoeff() / size);
  worst.solved += 1;
}

template <class T, bool bends> Errors survey(ChainOptions const& o, int count = 400) {
  std::mt19937 random(7);
  Errors worst;
  for (int i = 0; i < count; ++i) compare<T, bends>(random, o, worst);
  return worst;
}

template <class T, bool bends> void check(ChainOptions const& o, double residual, double error) {
  Errors const e = survey<T, bends>(o);
  CAPTURE(o.beads, o.inextensible, o.straight, int(o.ends), e.velocity, e.impulse, e.residual);
  CHECK(e.solved > 250);
  CHECK(e.residual < residual);
  CHECK(e.velocity < error);
  CHECK(e.impulse < error);
}

}  // namespace

TEMPLATE_TEST_CASE_SIG("a chain solve equals the dense solve", "[coupling][chain]",
                       ((bool bends), bends), false, true) {
  for (Ends ends : {Ends::free, Ends::body, Ends::swaged})
    for (bool inextensible : {false, true}) {
      ChainOptions o;
      o.ends = ends;
      o.inextensible = inextensible;
      // A residual allows velocities to be off by as much times the spread of the masses. (The states
      // drawn differ between compilers, which evaluate arguments in different orders.)
      auto const spread = [&o] { return o.mass_high / o.mass_low; };
      check<double, bends>(o, 1e-9, 1e-9 * spread());  // light beads, some in no contact
      o.mass_low = 1e-1;
      check<double, bends>(o, 1e-12, 1e-12 * spread());
      o.beads = 3;
      check<double, bends>(o, 1e-12, 1e-12 * spread());
    }
}

TEMPLATE_TEST_CASE_SIG("a straight inextensible chain behind a known bead is solved",
                       "[coupling][chain]", ((bool bends), bends), false, true) {
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i) {
    ChainOptions o;
    o.straight = o.inextensible = true;
    o.known = o.gaps = false;
    auto c = test::random_chain<double, bends>(random, o);
    c.known_bytes[0] = 1;
    test::DenseChain<double, bends> const dense(c);
    auto const solution = test::solve(c);
    REQUIRE(solution.regular);
    auto const& V = solution.V;
    Eigen::VectorXd const exact = dense.matrix.fullPivLu().solve(dense.rhs);
    for (std::size_t k = 0; k < V.size(); ++k)
      REQUIRE((exact.segment<3>(3 * int(k)) - test::eigen(V[k])).norm() < 1e-7 * exact.norm());
  }
}

TEMPLATE_TEST_CASE_SIG("in float the equations hold to rounding", "[coupling][chain]",
                       ((bool bends), bends), false, true) {
  for (Ends ends : {Ends::free, Ends::swaged})
    for (bool inextensible : {false, true}) {
      ChainOptions o;
      o.ends = ends;
      o.inextensible = inextensible;
      o.mass_low = 1e-1;
      check<float, bends>(o, 1e-5, 3e-2);
      o.held_by_tissue = true;  // the case that matters: a light thread, all of it in tissue
      o.mass_low = 1e-4;
      check<float, bends>(o, 1e-5, 5e-4);
    }
}

namespace {

// A light thread that bends stiffly and is held by tissue in its middle: beads of mass 1, and a joint's resistance
// dt^2 EI / l^3 in such masses. It lies along a random direction and turns a little at every bead.
test::RandomChain<float, true> stiff_thread(std::mt19937& random, float bending) {
  std::normal_distribution<float> normal;
  auto const arrow = [&] {
    float const x = normal(random), y = normal(random), z = normal(random);
    return mpmpbd::vec(x, y, z);
  };
  std::size_t const n = 12;
  test::RandomChain<float, true> c;
  c.blocks.resize(n);
  c.links.resize(n);
  c.known_bytes.assign(n, 0);
  c.g.assign(n, 0.0f);
  auto heading = mpmpbd::direction(arrow());
  for (std::size_t k = 0; k < n; ++k) {
    bool const held = k > 2 && k < 9, end = k == 0 || k + 1 == n;
    c.blocks[k].A += (end ? 0.5f : 1.0f) * mpmpbd::Mat3<float>::identity();
    if (held) c.blocks[k].A += 30.0f * mpmpbd::Mat3<float>::identity();
    c.r.push_back(arrow());
    auto const before = heading;
    heading = mpmpbd::direction(heading + 0.01f * arrow());
    if (k + 1 < n) c.links[k] = {heading, 1e-5f};
    if (end) continue;
    float const w[3] = {1, -2, 1};
    auto const H = bending * (mpmpbd::Mat3<float>::identity() - mpmpbd::outer(before, before));
    for (std::size_t i = 0; i < 3; ++i) c.blocks[k - 1 + i].A += w[i] * w[i] * H;
    c.blocks[k - 1].U += w[0] * w[1] * H;
    c.blocks[k].U += w[1] * w[2] * H;
    c.blocks[k - 1].W += w[0] * w[2] * H;
  }
  return c;
}

}  // namespace

// Elimination takes stiffness from stiffness, twice for a joint, and leaves the masses: of a stiffness k their error
// is of the order eps k^2. What rounding makes unsymmetric in them grows from bead to bead. Left there, it made the
// error five times as large at k = 3000 and ate up the last bead's mass at 6000.
TEST_CASE("in float a light thread keeps its masses however stiffly it bends",
          "[coupling][chain]") {
  for (float const bending : {100.0f, 300.0f, 1000.0f, 3000.0f, 6000.0f}) {
    std::mt19937 random(13);
    int refused = 0;
    double worst = 0;
    for (int i = 0; i < 400; ++i) {
      auto c = stiff_thread(random, bending);
      test::DenseChain<float, true> const dense(c);
      auto const solution = test::solve(c);
      if (!solution.regular) {
        ++refused;
        continue;
      }
      auto const& V = solution.V;
      Eigen::VectorXd const exact = dense.matrix.fullPivLu().solve(dense.rhs);
      for (std::size_t k = 0; k < V.size(); ++k)
        worst = std::max(worst, (exact.segment<3>(3 * int(k)) - test::eigen(V[k])).norm() /
                                    exact.head(3 * c.beads()).cwiseAbs().maxCoeff());
    }
    CAPTURE(bending, refused, worst);
    CHECK(refused == 0);
    CHECK(worst < 0.5 * double(mpmpbd::epsilon<float> * bending * bending));
  }
}

// The alternative that the mixed form replaces: stiffness added to masses. It must be visibly worse in
// float, otherwise the mixed form would not be worth its links.
TEST_CASE("float needs the mixed form", "[coupling][chain]") {
  int const n = 16;
  float const mass = 1e-4f, stiff = 3e4f;  // dt^2 EA / l0 in node masses
  test::RandomChain<float, false> c;
  c.blocks.resize(n);
  c.links.resize(n);
  c.known_bytes.assign(n, 0);
  c.g.assign(n, 0.0f);
  c.r.resize(n);
  auto const x = mpmpbd::vec(1.0f, 0.0f, 0.0f);
  for (std::size_t k = 0; k < n; ++k) {
    c.blocks[k].A = mass * mpmpbd::Mat3<float>::identity();
    c.links[k] = {x, 1 / stiff};
  }
  c.r[0] = -1.0f * x;  // the chain is pulled at one end with 1 and drawn along at the other
  c.r[n - 1] = -10.0f * x;
  c.known_bytes[n - 1] = 1;
  auto const solution = test::solve(c);
  REQUIRE(solution.regular);
  test::DenseChain<float, false> const dense(c);
  Eigen::VectorXd const exact = dense.matrix.fullPivLu().solve(dense.rhs);

  Eigen::VectorXf diagonal = Eigen::VectorXf::Constant(n, mass), b = Eigen::VectorXf::Zero(n), v(n);
  for (int k = 0; k + 1 < n; ++k) {
    diagonal(k) += stiff;
    diagonal(k + 1) += stiff;
  }
  b(0) = -1;
  for (int k = 1; k < n - 1; ++k) {  // Thomas; the last bead is known
    float const f = stiff / diagonal(k - 1);
    diagonal(k) -= f * stiff;
    b(k) += f * b(k - 1);
  }
  v(n - 1) = -10;
  for (int k = n - 2; k >= 0; --k) v(k) = (b(k) + stiff * v(k + 1)) / diagonal(k);

  double mixed = 0, plain = 0;
  for (int k = 0; k + 1 < n; ++k) {
    double const pull = exact(dense.link(k));
    mixed = std::max(mixed, std::abs(double(solution.lambda[std::size_t(k)]) / pull - 1));
    plain = std::max(plain, std::abs(double(stiff * (v(k + 1) - v(k))) / pull - 1));
  }
  CAPTURE(mixed, plain);
  CHECK(mixed < 1e-5);
  CHECK(plain > 1e-3);
}

TEST_CASE("a singular chain is refused", "[coupling][chain]") {
  std::mt19937 random(5);
  ChainOptions o;
  o.known = o.gaps = false;
  o.inextensible = true;
  auto c = test::random_chain<double, false>(random, o);
  c.known_bytes[4] = c.known_bytes[5] = 1;
  REQUIRE_FALSE(test::solve(c).regular);

  auto massless = test::random_chain<double, false>(random, o);
  for (auto& b : massless.blocks) b = {};
  REQUIRE_FALSE(test::solve(massless).regular);
}

TEST_CASE("chains separated by a gap do not see each other", "[coupling][chain]") {
  std::mt19937 random(11);
  ChainOptions o;
  o.known = o.gaps = false;
  auto c = test::random_chain<double, false>(random, o);
  c.links[5] = {{}, 1.0};
  c.g[5] = 0;
  c.blocks[5].U = {};
  auto const before = test::solve(c);
  for (std::size_t k = 6; k < c.r.size(); ++k) c.r[k] += mpmpbd::vec(1.0, 2.0, 3.0);
  auto const after = test::solve(c);
  for (std::size_t k = 0; k <= 5; ++k) REQUIRE(before.V[k] == after.V[k]);
  REQUIRE(before.lambda[5] == 0.0);
  for (std::size_t k = 6; k < c.r.size(); ++k) REQUIRE_FALSE(before.V[k] == after.V[k]);
}

TEMPLATE_TEST_CASE_SIG("a head eliminated beforehand changes no bit", "[coupling][chain]",
                       ((bool bends), bends), false, true) {
  std::mt19937 random(17);
  for (Ends ends : {Ends::free, Ends::body, Ends::swaged})
    for (int i = 0; i < 50; ++i) {
      ChainOptions o;
      o.ends = ends;
      auto const c = test::random_chain<double, bends>(random, o);
      auto const whole = test::solve(c);
      REQUIRE(whole.regular);
      for (int head = 1; head < o.beads; ++head) {
        auto const parts = test::solve(c, head);
        REQUIRE(parts.regular);
        CAPTURE(head, int(ends));
        REQUIRE(parts.V == whole.V);
        REQUIRE(parts.lambda == whole.lambda);
        REQUIRE(parts.y == whole.y);
      }
    }
}

TEMPLATE_TEST_CASE_SIG("several right-hand sides are solved as one alone", "[coupling][chain]",
                       ((bool bends), bends), false, true) {
  std::mt19937 random(19);
  for (Ends ends : {Ends::free, Ends::swaged})
    for (int i = 0; i < 50; ++i) {
      ChainOptions o;
      o.ends = ends;
      auto c = test::random_chain<double, bends>(random, o);
      auto const first = test::solve(c);
      REQUIRE(first.regular);
      auto other = c;
      for (auto& r : other.r) r = 2.0 * r + mpmpbd::vec(0.1, -0.2, 0.3);
      other.y = 3.0 * other.y;
      auto const second = test::solve(other);
      auto const both = test::solve_all<double, bends>({c, other}, 0);
      REQUIRE(both[0].V == first.V);
      REQUIRE(both[1].V == second.V);
      REQUIRE(both[0].lambda == first.lambda);
      REQUIRE(both[1].lambda == second.lambda);
      REQUIRE(both[0].y == first.y);
      REQUIRE(both[1].y == second.y);
    }
}

TEMPLATE_TEST_CASE_SIG("lanes of a group find together what one finds", "[coupling][chain]",
                       ((bool bends), bends), false, true) {
  std::mt19937 random(23);
  for (Ends ends : {Ends::free, Ends::swaged})
    for (int lanes : {2, 5, 12}) {
      ChainOptions o;
      o.ends = ends;
      auto const c = test::random_chain<double, bends>(random, o);
      auto other = c;
      for (auto& r : other.r) r = 2.0 * r;
      auto const alone = test::solve_all<double, bends>({c, other}, 4);
      REQUIRE(alone[0].regular);
      test::ChainRun<double, bends> run({c, other}, 4);
      std::vector<char> regular(static_cast<std::size_t>(lanes));
      test::run_on_lanes(lanes, [&](auto const& lane) {
        regular[static_cast<std::size_t>(lane.number)] = run.solve(lane);
      });
      CAPTURE(lanes, int(ends));
      REQUIRE(regular == std::vector<char>(regular.size(), true));
      auto const together = run.found(true);
      for (std::size_t j = 0; j < 2; ++j) {
        REQUIRE(together[j].V == alone[j].V);
        REQUIRE(together[j].lambda == alone[j].lambda);
        REQUIRE(together[j].y == alone[j].y);
      }
    }
}

TEST_CASE("a rigid body without a chain is solved alone", "[coupling][chain]") {
  std::mt19937 random(29);
  ChainOptions o;
  o.beads = 0;
  o.ends = Ends::body;
  auto const c = test::random_chain<double, false>(random, o);
  auto const found = test::solve(c);
  REQUIRE(found.regular);
  for (int i = 0; i < 6; ++i) {
    double sum = -c.y[i];
    for (int j = 0; j < 6; ++j) sum += c.end.matrix(i, j) * found.y[j];
    CHECK(std::abs(sum) < 1e-12);
  }
}
