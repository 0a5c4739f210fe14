// Rows of the verification again, against computations that share no line with the library or its tests: matrices by
// Eigen, rods and pendulums as ordinary differential equations, a bar by finite elements.
//
// Prints a table; exit status 1 if a row is off by more than it may.
#include <Eigen/Dense>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <fmt/core.h>

#include <mpmpbd/core/polar.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/prony.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>
#include <mpmpbd/pbd/access.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/pbd/solvers/direct_banded.hpp>
#include <mpmpbd/scene/simulation.hpp>

namespace {

using namespace mpmpbd;
using Eigen::Matrix3d;
using Eigen::VectorXd;

struct Row {
  char const* id;
  char const* what;
  double library, independent;
  double difference, allowed;
};
std::vector<Row> rows;

void compare(char const* id, char const* what, double library, double independent, double allowed) {
  rows.push_back({id, what, library, independent, std::abs(library / independent - 1), allowed});
}
// Where many numbers are compared, the largest difference of them.
void largest(char const* id, char const* what, double difference, double allowed) {
  rows.push_back({id, what, 0.0, 0.0, difference, allowed});
}

Matrix3d to_eigen(Mat3<double> const& a) {
  Matrix3d b;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) b(i, j) = a(i, j);
  return b;
}
Mat3<double> from_eigen(Matrix3d const& a) {
  Mat3<double> b{};
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) b(i, j) = a(i, j);
  return b;
}

// The state after `steps` Runge-Kutta steps of fourth order.
template <class State>
State integrate(std::function<State(double, State const&)> const& rate, State y, double from,
                double to, int steps) {
  double const h = (to - from) / steps;
  for (int n = 0; n < steps; ++n) {
    double const t = from + n * h;
    State const k1 = rate(t, y), k2 = rate(t + h / 2, y + h / 2 * k1),
                k3 = rate(t + h / 2, y + h / 2 * k2), k4 = rate(t + h, y + h * k3);
    y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return y;
}

// B15: singular values and the nearest rotation, by Eigen's two-sided Jacobi.
void singular_values() {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  double values = 0, rotations = 0;
  for (int n = 0; n < 20000; ++n) {
    Matrix3d F;
    for (int i = 0; i < 9; ++i) F(i) = normal(random) * std::pow(10.0, n % 7 - 3);
    Eigen::JacobiSVD<Matrix3d> const by(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    auto const mine = svd(from_eigen(F));
    Matrix3d turn = Matrix3d::Identity();
    turn(2, 2) = (by.matrixU() * by.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    Matrix3d const R = by.matrixU() * turn * by.matrixV().transpose();
    double const most = by.singularValues()(0);
    for (int i = 0; i < 3; ++i)
      values = std::max(values, std::abs(std::abs(mine.sigma[i]) - by.singularValues()(i)) / most);
    // The rotation is as well defined as the gap between its two smallest stretches, signed.
    double const gap = (by.singularValues()(1) + turn(2, 2) * by.singularValues()(2)) / most;
    rotations = std::max(rotations, gap * (to_eigen(polar(from_eigen(F)).R) - R).norm());
  }
  largest("B15", "singular values of 20,000 matrices", values, 1e-14);
  largest("B15", "their rotations, times the gap that defines them", rotations, 1e-14);
}

// A1.6: Kirchhoff stress by central differences of energies that are written down here again, with Eigen.
template <class Material, class Energy> double stress_difference(Energy const& energy) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-0.35, 0.35);
  Lame<double> const k{.mu = 2.1e3, .lambda = 4.3e3};
  double most = 0;
  for (int n = 0; n < 500; ++n) {
    Matrix3d F = Matrix3d::Identity();
    for (int i = 0; i < 9; ++i) F(i) += uniform(random);
    if (F.determinant() < 0.2) continue;
    Matrix3d P;
    for (int i = 0; i < 9; ++i) {
      auto at = [&](double step) {
        Matrix3d moved = F;
        moved(i) += step;
        return energy(moved, k);
      };
      double const h = 1e-4;  // fourth order
      P(i) = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
    }
    Local<double, Fields<particle::Deformation>> p{};
    p[particle::Deformation{}] = from_eigen(F);
    Matrix3d const tau = to_eigen(Material::kirchhoff(p, k));
    most = std::max(most, (tau - P * F.transpose()).norm() / k.mu);
  }
  return most;
}
void stresses() {
  using K = Lame<double>;
  largest("A1.6", "stress of neo-Hookean tissue [mu]",
          stress_difference<NeoHookean>([](Matrix3d const& F, K const& k) {
            double const ln = std::log(F.determinant());
            return k.mu / 2 * ((F.transpose() * F).trace() - 3) - k.mu * ln +
                   k.lambda / 2 * ln * ln;
          }),
          1e-9);
  largest("A1.6", "stress of fixed corotated tissue [mu]",
          stress_difference<FixedCorotated>([](Matrix3d const& F, K const& k) {
            auto const s = Eigen::JacobiSVD<Matrix3d>(F).singularValues();
            double const J = F.determinant();
            return k.mu * (s.array() - 1).square().sum() + k.lambda / 2 * (J - 1) * (J - 1);
          }),
          1e-9);
  largest("A1.6", "stress of stable neo-Hookean tissue [mu]",
          stress_difference<StableNeoHookean>([](Matrix3d const& F, K const& k) {
            // Smith, de Goes and Kim 2018, eq. 14 with the constants of their section 3.4.
            double const mu = 4 * k.mu / 3, lambda = k.lambda + 5 * k.mu / 6;
            double const I = (F.transpose() * F).trace(), J = F.determinant();
            double const alpha = 1 + mu / lambda - mu / (4 * lambda);
            return mu / 2 * (I - 3) + lambda / 2 * (J - alpha) * (J - alpha) -
                   mu / 2 * std::log(I + 1);
          }),
          1e-9);
}

// A1.7: the stress after a shear that rises and falls, as the convolution of its rate with the relaxation
// function, by Simpson's rule on a fine grid.
void relaxation() {
  double const G = 2.3e3, amplitude = 1e-3, period = 0.31, end = 0.47;
  double const g[] = {0.3, 0.4}, tau[] = {0.05, 0.8};
  auto const shear = [&](double t) {
    return amplitude * std::pow(std::sin(pi<double> * t / period), 2);
  };
  auto const rate = [&](double t) {
    return amplitude * pi<double> / period * std::sin(2 * pi<double> * t / period);
  };
  auto const G_of = [&](double t) {
    return G * (1 - g[0] - g[1] + g[0] * std::exp(-t / tau[0]) + g[1] * std::exp(-t / tau[1]));
  };
  int const pieces = 20000;
  double stress = 0;
  for (int n = 0; n <= pieces; ++n) {
    double const t = end * n / pieces, weight = n == 0 || n == pieces ? 1 : n % 2 ? 4 : 2;
    stress += weight * end / pieces / 3 * G_of(end - t) * rate(t);
  }
  using Effect = Prony<2>;
  detail::Archetype<Effect, double> p{};
  int const steps = 400;
  for (int n = 1; n <= steps; ++n) {
    auto F = Mat3<double>::identity();
    F(0, 1) = shear(end * n / steps);
    p[particle::Deformation{}] = F;
    Local<double, Fields<particle::Deformation>> q{};
    q[particle::Deformation{}] = F;
    p[particle::Stress{}] = NeoHookean::kirchhoff(q, Lame<double>{.mu = G, .lambda = 4e3});
    Effect::apply(p, Effect::Parameters<double>{{g[0], g[1]}, {tau[0], tau[1]}},
                  Tick<double>{end / steps, end / steps, n});
  }
  compare("A1.7", "shear stress of a relaxing solid [Pa]", p[particle::Stress{}](0, 1), stress,
          1e-4);
}

// A thread alone: one environment, its own gravity, velocities scaled by `keep` after each step.
template <class Body> class Thread {
 public:
  using Store = State<double, typename Body::AllFields>;
  explicit Thread(RodAssembly<Body> const& rod) {
    for_each_type(typename Store::Domains{}, [&]<class D>(std::type_identity<D>) {
      for (auto const& c : rod.capacity())
        if (c.domain == D::name.view()) store_.template table<D>().resize(1, c.slots);
    });
    rod.write(store_, 0);
  }
  Vec3<double> x(std::int64_t b) const { return store_.template get<bead::Position>(0, b); }
  // Every free bead gains dt a(bead).
  template <class Acceleration> void step(double dt, Acceleration const& a, double keep = 1) {
    auto const env = access_environment(store_, 0, typename Store::Domains{});
    Tick<double> const tick{dt, dt, steps_++};
    Body::step(Solo{}, env, tick, [&](auto const& team, auto const& e, auto const&) {
      team.each(static_cast<int>(e.template live<Beads>()), [&](std::int64_t b) {
        if (!(e.template get<bead::InverseMass>(b) > 0)) return;
        e.template set<bead::Velocity>(b, keep * e.template get<bead::Velocity>(b) + dt * a(b));
      });
    });
  }

 private:
  Store store_{1};
  std::int64_t steps_ = 0;
};

// A3.5: EI theta'' = -P cos(theta) from the clamp, theta'(L) = 0, by shooting.
double elastica_drop(double load) {
  using S = Eigen::Vector4d;  // theta, theta', x, y along s in [0, 1]
  auto const shot = [&](double curvature) {
    return integrate<S>(
        [&](double, S const& y) {
          return S{y[1], -load * std::cos(y[0]), std::cos(y[0]), std::sin(y[0])};
        },
        S{0, curvature, 0, 0}, 0, 1, 2000);
  };
  double low = 0, high = load;  // the moment at the clamp is below P L
  for (int n = 0; n < 60; ++n) {
    double const middle = (low + high) / 2;
    (shot(middle)[1] > 0 ? high : low) = middle;
  }
  return shot(low)[3];
}
void cantilever() {
  struct Rod : Pbd<Constraints<Distance, Bend>, DirectBanded<3>> {};
  int const segments = 64;
  double const length = 0.23, l = length / segments, stiffness = 3e-6, mass = 2e-5;
  for (double load : {1.0, 5.0}) {
    RodAssembly<Rod> rod;
    for (int b = -1; b <= segments; ++b) rod.add_bead({{b * l, 0, 0}}, mass);
    for (int b = 0; b <= segments; ++b) rod.add<Distance>({b, b + 1}, {l, 0.0});
    for (int b = 0; b < segments; ++b)  // the joint at the wall stands for half a segment
      rod.add<Bend>({b, b + 1, b + 2}, {0.0, (b == 0 ? 0.5 : 1.0) * l / stiffness});
    rod.prescribe(0);
    rod.prescribe(1);
    Thread<Rod> thread(rod);
    double const force = load * stiffness / (length * length);
    for (int n = 0; n < 8000; ++n)
      thread.step(
          2e-3,
          [&](std::int64_t b) { return vec(0.0, b == segments + 1 ? force / mass : 0.0, 0.0); },
          0.997);
    compare("A3.5", load == 1.0 ? "drop of a cantilever, P L^2 / EI = 1 [L]" : "the same, 5 [L]",
            thread.x(segments + 1)[1] / length, elastica_drop(load), 2e-3);
  }
}

// A3.3, far from small: a chain of three beads let go from the side, as angles in Lagrange's equations.
void chain() {
  struct Links : Pbd<Constraints<Distance>, DirectBanded<4>> {};
  constexpr int N = 3;
  double const g = 9.81, l = 0.11, end = 0.35;
  using S = Eigen::Matrix<double, 2 * N, 1>;
  auto const rate = [&](double, S const& y) {
    Eigen::Matrix3d M;
    Eigen::Vector3d f;
    for (int i = 0; i < N;
         ++i) {  // angles from the vertical; N - max(i, j) beads hang below both links
      f[i] = -(N - i) * g / l * std::sin(y[i]);
      for (int j = 0; j < N; ++j) {
        double const below = N - std::max(i, j);
        M(i, j) = below * std::cos(y[i] - y[j]);
        f[i] -= below * std::sin(y[i] - y[j]) * y[N + j] * y[N + j];
      }
    }
    S d;
    d << y.tail<N>(), M.ldlt().solve(f);
    return d;
  };
  S start = S::Zero();
  start.head<N>().setConstant(1.2);
  S const y = integrate<S>(rate, start, 0, end, 4000);
  double exact = 0;
  for (int i = 0; i < N; ++i) exact += l * std::sin(y[i]);

  auto const by_library = [&](int steps) {
    RodAssembly<Links> rod;
    for (int b = 0; b <= N; ++b)
      rod.add_bead({{b * l * std::sin(1.2), 0, -b * l * std::cos(1.2)}}, 3e-3);
    for (int b = 0; b < N; ++b) rod.add<Distance>({b, b + 1}, {l, 0.0});
    rod.prescribe(0);
    Thread<Links> thread(rod);
    for (int n = 0; n < steps; ++n)
      thread.step(end / steps, [&](std::int64_t) { return vec(0.0, 0.0, -g); });
    return thread.x(N)[0];
  };
  double const coarse = by_library(4000), fine = by_library(8000);  // first order in the step
  compare("A3.3", "place of a triple pendulum's bob [m]", 2 * fine - coarse, exact, 1e-3);
}

// A2.5 with an amplitude that no formula covers: a bar of neo-Hookean tissue in uniaxial strain, pulled by its
// own weight, by linear finite elements and by MPM.
constexpr double bar_length = 0.2, bar_time = 0.11, bar_density = 1040, bar_gravity = 9.81;
Lame<double> const bar_material = lame(9e3, 0.3);

double bar_by_elements(int n) {
  double const h = bar_length / n,
               wave = std::sqrt((bar_material.lambda + 2 * bar_material.mu) / bar_density);
  VectorXd u = VectorXd::Zero(n + 1), v = VectorXd::Zero(n + 1);
  VectorXd mass = VectorXd::Constant(n + 1, bar_density * h);
  mass[n] /= 2;
  int const steps = static_cast<int>(std::ceil(bar_time / (0.4 * h / wave)));
  double const dt = bar_time / steps;
  auto const accelerations = [&] {
    VectorXd f = bar_gravity * mass;
    for (int e = 0; e < n; ++e) {
      double const F = 1 + (u[e + 1] - u[e]) / h;
      double const P = bar_material.mu * (F - 1 / F) + bar_material.lambda * std::log(F) / F;
      f[e] += P, f[e + 1] -= P;
    }
    VectorXd a = f.cwiseQuotient(mass);
    a[0] = 0;
    return a;
  };
  VectorXd a = accelerations();
  for (int k = 0; k < steps; ++k) {  // velocity Verlet
    v += dt / 2 * a;
    u += dt * v;
    a = accelerations();
    v += dt / 2 * a;
  }
  return u[n];
}
double bar_by_mpm(int n) {
  struct Bar : Scene<Mpm<NeoHookean>, Gravity, Wall<Sticky, 0, Side::low>, Walls<Slip>> {};
  double const dx = bar_length / n;
  auto const count = static_cast<std::int64_t>(32) * n;  // 2 x 2 cells across
  Simulation<Bar, Serial, double> run({.environments = 1,
                                       .cell_size = dx,
                                       .nodes = {n + n / 4 + 8, 8, 8},
                                       .capacity = {{"particle", count}}});
  run.set<NeoHookean>(bar_material);
  run.set<Gravity>({{bar_gravity, 0, 0}});
  run.set<Wall<Sticky, 0, Side::low>>({3 * dx});
  run.set<Walls<Slip>>({{0, 3 * dx, 3 * dx}, {1e3, 5 * dx, 5 * dx}});
  std::vector<Vec3<double>> at;
  for (int i = 0; i < 2 * n; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k)
        at.push_back(dx * (vec(3.0, 3.0, 3.0) + 0.5 * vec(i + 0.5, j + 0.5, k + 0.5)));
  run.add_particles(0, at, bar_density, dx * dx * dx / 8);
  int const steps = 40;
  for (int k = 0; k < steps; ++k) run.step(bar_time / steps);
  double const before = at.back()[0];
  // The last particle lies a quarter of a cell from the end; strain there is zero.
  return run.state().get<particle::Position>(0, static_cast<std::int64_t>(at.size()) - 1)[0] -
         before;
}
void bar() {
  double const reference = bar_by_elements(800);
  compare("A2.5", "end of a falling bar after most of a swing [m]", bar_by_mpm(40), reference,
          0.02);
}

}  // namespace

int main() {
  singular_values();
  stresses();
  relaxation();
  cantilever();
  chain();
  bar();
  bool good = true;
  fmt::print(
      "| row | what | library | independent | difference | allowed | |\n|---|---|---|---|---|---|---|\n");
  for (auto const& r : rows) {
    bool const holds = r.difference <= r.allowed;
    good = good && holds;
    auto const number = [](double x) {
      return x == 0.0 ? std::string() : fmt::format("{:.7g}", x);
    };
    fmt::print("| {} | {} | {} | {} | {:.2g} | {:.2g} | {} |\n", r.id, r.what, number(r.library),
               number(r.independent), r.difference, r.allowed, holds ? "holds" : "**off**");
  }
  return good ? 0 : 1;
}
