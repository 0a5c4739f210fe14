// Singular values, polar decomposition and symmetric eigenvalues at the hard cases of B15.
#include "catch.hpp"

#include <mpmpbd/core/polar.hpp>
#include <mpmpbd/core/sym_eigen.hpp>
#include <mpmpbd/testing/samples.hpp>

#include <limits>
#include <vector>

namespace {
using mpmpbd::Mat3;
using mpmpbd::Vec3;
using mpmpbd::testing::Samples;
using D3 = Mat3<double>;

template <class T> constexpr double limit = sizeof(T) == sizeof(float) ? 1e-6 : 1e-13;

std::vector<D3> hard_cases() {
  auto const I = D3::identity();
  std::vector<D3> cases{D3::zero(),
                        Samples::diagonal(2.5, 0, 0),
                        Samples::diagonal(2.5, 0.3, 0),
                        Samples::diagonal(-1, 1, 1),
                        Samples::diagonal(1, 1, -1e-8),
                        -I,
                        I,
                        1e-20 * I,
                        1e10 * I,
                        Samples::diagonal(1, 1, 1 + 1e-7),
                        Samples::diagonal(1 + 1e-7, 1, 1 - 1e-7),
                        Samples::diagonal(1e10, 1, 1e-10)};
  for (int axis = 0; axis < 3; ++axis) {
    Vec3<double> e{};
    e[axis] = 1;
    cases.push_back(Samples::rotation_by(e, mpmpbd::pi<double>));
    cases.push_back(Samples::rotation_by(e, mpmpbd::pi<double>) * Samples::diagonal(0.5, 2, 0.7));
  }
  Samples random(11);
  auto const n = cases.size();
  for (std::size_t i = 0; i < n; ++i)  // the same cases away from the axes
    for (int k = 0; k < 20; ++k) cases.push_back(random.rotation() * cases[i] * random.rotation());
  for (int k = 0; k < 20000; ++k) {
    auto const R = random.rotation(), Q = random.rotation();
    double const a = random.log_uniform(1e-12, 1e3), b = random.log_uniform(1e-12, 1e3);
    double const tiny = random.uniform(-1e-7, 1e-7);
    switch (k % 5) {
      case 0:
        cases.push_back(random.matrix<3, 3>(-3, 3));
        break;
      case 1:
        cases.push_back(R * Samples::diagonal(a, a * (1 + tiny), b) * Q);
        break;
      case 2:
        cases.push_back(R * Samples::diagonal(a, a, a * (tiny - 1)) * Q);
        break;
      case 3:
        cases.push_back(R * Samples::diagonal(1, tiny, -tiny * tiny) * Q);
        break;
      default:
        cases.push_back(R * Samples::diagonal(a, b, random.log_uniform(1e-12, 1e3)) * Q);
    }
  }
  return cases;
}

// Entries are compared in double, so that the check's own rounding is out of the picture.
double from_identity(D3 const& a) { return norm(a - D3::identity()); }
}  // namespace

TEMPLATE_TEST_CASE("svd and polar hold at every F", "[core][svd]", float, double) {
  using T = TestType;
  double rotation = 0, reflection = 0, residual = 0, order = 0, vectors = 0;
  for (auto const& exact : hard_cases()) {
    auto const F = mpmpbd::cast<T>(exact);
    auto const wide = mpmpbd::cast<double>(F);
    double const size = norm(wide) > 0 ? norm(wide) : 1;
    auto const p = mpmpbd::polar(F);
    auto const d = mpmpbd::svd(F);
    auto const R = mpmpbd::cast<double>(p.R), S = mpmpbd::cast<double>(p.S);
    rotation = std::max(rotation, from_identity(transpose(R) * R));
    reflection = std::max(reflection, std::abs(determinant(R) - 1));
    residual = std::max(residual, norm(R * S - wide) / size);
    REQUIRE(p.S == transpose(p.S));
    REQUIRE(is_finite(p.S));
    auto const U = mpmpbd::cast<double>(d.U), V = mpmpbd::cast<double>(d.V);
    auto const s = mpmpbd::cast<double>(d.sigma);
    vectors =
        std::max({vectors, from_identity(transpose(U) * U), from_identity(transpose(V) * V),
                  std::abs(determinant(U) - 1), std::abs(determinant(V) - 1),
                  norm(U * Samples::diagonal(s[0], s[1], s[2]) * transpose(V) - wide) / size});
    order = std::max({order, (s[1] - s[0]) / size, (std::abs(s[2]) - s[1]) / size});
  }
  CAPTURE(rotation, reflection, residual, vectors, order);
  CHECK(rotation <= limit<T>);
  CHECK(reflection <= limit<T>);
  CHECK(residual <= limit<T>);
  CHECK(vectors <= limit<T>);
  CHECK(order <= limit<T>);
}

TEMPLATE_TEST_CASE("polar finds what is known", "[core][svd]", float, double) {
  using T = TestType;
  auto const tolerance = limit<T>;
  Samples random(12);
  for (int k = 0; k < 200; ++k) {
    auto const Q = random.rotation();
    auto const stretch = random.rotation() * Samples::diagonal(1.3, 0.6, 0.2);
    auto const S = stretch * transpose(stretch);  // positive definite
    auto const p = mpmpbd::polar(mpmpbd::cast<T>(Q * S));
    // Smallest eigenvalue 0.04 of 1.69: R is known to rounding times 1.69 / (0.04 + 0.36).
    CHECK(norm(mpmpbd::cast<double>(p.R) - Q) <= 10 * tolerance);
    CHECK(norm(mpmpbd::cast<double>(p.S) - S) <= 10 * tolerance);
  }
  // A reflection is not a rotation: R stays the nearest rotation and S takes the sign.
  auto const mirrored = mpmpbd::polar(mpmpbd::cast<T>(Samples::diagonal(1.5, 1.2, -0.4)));
  CHECK(norm(mpmpbd::cast<double>(mirrored.R) - D3::identity()) <= tolerance);
  CHECK(double(mirrored.S(2, 2)) == Approx(-0.4).epsilon(tolerance));
}

TEMPLATE_TEST_CASE("the rotation does not jump between nearly equal stretches", "[core][svd]",
                   float, double) {
  using T = TestType;
  double jump = 0;
  for (int k = -50; k <= 50; ++k) {
    auto const Q = Samples::rotation_by({{0.6, 0.0, 0.8}}, 0.7);
    auto const F = Q * Samples::diagonal(1, 1 + 1e-7 * k, 1 - 0.5e-7 * k);
    jump = std::max(jump, norm(mpmpbd::cast<double>(mpmpbd::rotation_of(mpmpbd::cast<T>(F))) - Q));
  }
  CHECK(jump <= limit<T>);
}

TEMPLATE_TEST_CASE("NaN and infinity show and do not hang", "[core][svd]", float, double) {
  using T = TestType;
  for (T const bad : {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity(),
                      -std::numeric_limits<T>::infinity()}) {
    for (int i = 0; i < 9; ++i) {
      auto F = Mat3<T>::identity();
      F.m[i] = bad;
      auto const p = mpmpbd::polar(F);
      for (int j = 0; j < 9; ++j) {
        CHECK_FALSE(mpmpbd::is_finite(p.R.m[j]));
        CHECK_FALSE(mpmpbd::is_finite(p.S.m[j]));
      }
    }
  }
}

TEST_CASE("the largest and smallest numbers of float survive", "[core][svd]") {
  for (float const size : {1e-44f, 1e-38f, 1e-20f, 1e20f, 3e38f}) {
    auto const p = mpmpbd::polar(size * Mat3<float>::identity());
    CHECK(norm(p.R - Mat3<float>::identity()) <= 1e-6f);
    CHECK(p.S(0, 0) == Approx(size).epsilon(1e-6));
  }
}

TEMPLATE_TEST_CASE("symmetric eigenvalues", "[core][sym_eigen]", float, double) {
  using T = TestType;
  Samples random(13);
  double residual = 0, orthogonal = 0;
  auto const check = [&]<int N>(mpmpbd::Mat<double, N, N> const& exact) {
    auto const A = mpmpbd::cast<T>(exact);
    auto const e = mpmpbd::symmetric_eigen(A);
    mpmpbd::Mat<double, N, N> D{};
    for (int i = 0; i < N; ++i) D(i, i) = double(e.values[i]);
    for (int i = 0; i + 1 < N; ++i) REQUIRE(e.values[i] >= e.values[i + 1]);
    auto const V = mpmpbd::cast<double>(e.vectors);
    double const size = std::max(norm(mpmpbd::cast<double>(A)), 1e-300);
    residual = std::max(residual, norm(V * D * transpose(V) - mpmpbd::cast<double>(A)) / size);
    orthogonal =
        std::max(orthogonal, norm(transpose(V) * V - mpmpbd::Mat<double, N, N>::identity()));
  };
  for (int k = 0; k < 500; ++k) {
    auto const a = random.matrix<3, 3>(-2, 2);
    check(a + transpose(a));
    auto const b = random.matrix<9, 9>(-2, 2);
    check(b + transpose(b));
    auto const v = random.unit_vector();
    check(outer(v, v));
    check(1e-12 * outer(v, v) + D3::identity());
  }
  check(D3::zero());
  // 3 or 36 rotations per sweep, each of a rounding error: N sqrt(turns) ulp, generously.
  double const eps = double(mpmpbd::epsilon<T>);
  CHECK(residual <= 200 * eps);
  CHECK(orthogonal <= 200 * eps);
}
