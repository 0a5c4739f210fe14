// The laws of a MaterialModel. docs/concepts/material.md says where each comes from.
#pragma once

#include <mpmpbd/core/sym_eigen.hpp>
#include <mpmpbd/mpm/concepts.hpp>
#include <mpmpbd/mpm/materials/lame.hpp>
#include <mpmpbd/testing/law.hpp>
#include <mpmpbd/testing/samples.hpp>

namespace mpmpbd {

namespace testing {

// What the suite does to the other fields of an item before it sets F; user materials with fields of
// their own give such a function, for precision T and for double.
struct UnitFibre {
  template <class P> void operator()(P& p) const {
    using T = typename P::Scalar;
    if constexpr (contains<typename P::List, particle::Fibre>)
      p[particle::Fibre{}] = {{T(0.36), T(0.48), T(0.8)}};
  }
};

template <class M, class Prepare> class MaterialProbe {
 public:
  using K = parameters_t<M, double>;
  using Matrix9 = Mat<double, 9, 9>;

  MaterialProbe(K const& parameters, Prepare set_fields, bool with_fibres = true)
      : k_(parameters), prepare_(set_fields), fibres_(with_fibres) {}

  template <class T> auto item(Mat3<double> const& F) const {
    detail::Archetype<M, T> p{};
    prepare_(p);
    if constexpr (contains<typename detail::Archetype<M, T>::List, particle::Fibre>)
      if (!fibres_) p[particle::Fibre{}] = {};
    p[particle::Deformation{}] = cast<T>(F);
    return p;
  }
  template <class T> Mat3<T> stress(Mat3<double> const& F) const {
    return M::kirchhoff(item<T>(F), cast_parameters<M, T, double>(k_));
  }
  template <class T> T energy(Mat3<double> const& F) const {
    return M::energy(item<T>(F), cast_parameters<M, T, double>(k_));
  }
  template <class T> Stiffness<T> stiffness(Mat3<double> const& F) const {
    return M::stiffness(item<T>(F), cast_parameters<M, T, double>(k_));
  }

  // tau = P F^T with P by central differences of the energy, in double.
  Mat3<double> stress_from_energy(Mat3<double> const& F) const {
    Mat3<double> P{};
    for (int i = 0; i < 9; ++i) {
      double const h = 6e-6;
      auto plus = F, minus = F;
      plus.m[i] += h;
      minus.m[i] -= h;
      P.m[i] = (energy<double>(plus) - energy<double>(minus)) / (plus.m[i] - minus.m[i]);
    }
    return P * transpose(F);
  }
  // Columns: dtau along F' = L F for each entry of L, by central differences.
  Matrix9 tangent(Mat3<double> const& F) const {
    Matrix9 A{};
    double const h = 1e-6;
    for (int c = 0; c < 9; ++c) {
      Mat3<double> L{};
      L.m[c] = h;
      auto const d = stress<double>(F + L * F) - stress<double>(F - L * F);
      for (int r = 0; r < 9; ++r) A(r, c) = d.m[r] / (2 * h);
    }
    return A;
  }
  static double largest_eigenvalue(Matrix9 const& A) {
    return symmetric_eigen(0.5 * (A + transpose(A))).values[0];
  }
  // Largest eigenvalue of the acoustic tensor over directions n.
  double fastest_wave(Matrix9 A, Mat3<double> const& tau, Samples& random, int directions) const {
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l)
        for (int i = 0; i < 3; ++i) A(i + 3 * k, k + 3 * l) -= tau(i, l);  // - tau L^T
    double fastest = -1e300;
    for (int d = 0; d < directions; ++d) {
      auto const n = random.unit_vector();
      Mat3<double> Q{};
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
          for (int j = 0; j < 3; ++j)
            for (int l = 0; l < 3; ++l) Q(i, k) += n[j] * A(i + 3 * j, k + 3 * l) * n[l];
      fastest = max(fastest, symmetric_eigen(0.5 * (Q + transpose(Q))).values[0]);
    }
    return fastest;
  }
  double scale(Mat3<double> const& F) const {
    auto const s = stiffness<double>(F);
    return max(s.bulk3, s.longitudinal);
  }
  // Small-strain constants, where the material says them.
  static constexpr bool knows_moduli = requires(K const& k) { M::at_rest(k); }
  || requires(K const& k) { k.mu, k.lambda; }
  || requires(K const& k) { k.matrix.mu, k.matrix.lambda; };
  Lame<double> moduli() const {
    if constexpr (requires { M::at_rest(k_); })
      return M::at_rest(k_);
    else if constexpr (requires { k_.matrix.mu; })
      return {k_.matrix.mu, k_.matrix.lambda};
    else
      return {k_.mu, k_.lambda};
  }

 private:
  K k_;
  Prepare prepare_;
  bool fibres_;
};

}  // namespace testing

// Runs every law of a material in precision T, with parameters k. Stresses and energies are compared
// relative to the larger stiffness bound at that F: it is how much the stress reacts to a relative
// change of F, rounding included.
template <class M, class T, class Prepare = testing::UnitFibre>
Laws material_laws(parameters_t<M, double> const& k, Prepare prepare = {}) {
  using testing::Samples;
  using Probe = testing::MaterialProbe<M, Prepare>;
  static_assert(check_material<M>());
  Probe const probe(k, prepare);
  constexpr double eps = double(epsilon<T>);
  auto const I = Mat3<double>::identity();
  Laws laws;

  {
    double const scale = probe.scale(I);
    auto const at_rest = cast<double>(probe.template stress<T>(I));
    laws.push_back(
        {"no stress at rest, relative to the stiffness", norm(at_rest) / scale, 8 * eps});
    laws.push_back({"no energy at rest, relative to the stiffness",
                    abs(double(probe.template energy<T>(I))) / scale, 8 * eps});
  }
  {
    // Stretches in [0.4, 2.5] and J in [0.2, 5]. F is rounded when it is turned: a few ulp times its
    // condition number, at most 6.25, per entry; the determinant adds as much again.
    Samples random(1);
    double turned = 0, turned_energy = 0, turned_bound = 0, unsymmetric = 0, slope = 0;
    for (int s = 0; s < 200;) {
      auto const F = cast<double>(cast<T>(random.deformation(0.4, 2.5)));
      double const J = determinant(F);
      if (J < 0.2 || J > 5.0) continue;
      ++s;
      auto const R = random.rotation();
      double const scale = probe.scale(F);
      auto const tau = cast<double>(probe.template stress<T>(F));
      auto const tau_turned = cast<double>(probe.template stress<T>(R * F));
      turned = max(turned, norm(tau_turned - R * tau * transpose(R)) / scale);
      turned_energy = max(turned_energy, abs(double(probe.template energy<T>(R * F)) -
                                             double(probe.template energy<T>(F))) /
                                             scale);
      auto const b = probe.template stiffness<T>(F), b_turned = probe.template stiffness<T>(R * F);
      turned_bound = max(turned_bound, abs(double(b.bulk3 - b_turned.bulk3)) / scale);
      unsymmetric = max(unsymmetric, norm(tau - transpose(tau)) / scale);
      slope = max(slope, norm(tau - probe.stress_from_energy(F)) / scale);
    }
    laws.push_back({"objective stress, tau(R F) = R tau R^T", turned, 512 * eps});
    laws.push_back({"objective energy, psi(R F) = psi(F)", turned_energy, 512 * eps});
    laws.push_back({"objective stiffness bound", turned_bound, 512 * eps});
    laws.push_back({"symmetric stress", unsymmetric, 64 * eps});
    laws.push_back({"stress is the slope of the energy", slope, 1e-8 + 512 * eps});
  }
  if constexpr (Probe::knows_moduli) {
    // Fibres taken out: they add to lambda and mu in tension only.
    Probe const matrix(k, prepare, false);
    auto const A = matrix.tangent(I);
    auto const expected = matrix.moduli();
    double const lambda = A(4, 0), shear = 0.5 * (A(1, 1) + A(1, 3)), axial = A(0, 0);
    double const scale = expected.lambda + 2 * expected.mu;
    double const error = max(max(abs(lambda - expected.lambda), abs(shear - expected.mu)),
                             abs(axial - expected.lambda - 2 * expected.mu));
    laws.push_back({"moduli at F = 1 are lambda and mu", error / scale, 1e-6});
    auto const bound = matrix.template stiffness<double>(I);
    double const mode = bound.bulk3 / (3 * expected.lambda + 2 * expected.mu);
    double const wave = bound.longitudinal / scale;
    laws.push_back({"stiffness bounds at rest, excess over the exact values",
                    min(mode, wave) < 1 - 1e-12 ? 1.0 : max(mode, wave) - 1, 0.3});
  }
  {
    // Differences of step h err by h^2 and by rounding / h: 1e-6 of the bound covers both. In T, exp(x)
    // up to x = 20 multiplies the rounding of its argument by 2 x.
    Samples random(2);
    double mode = -1, wave = -1;
    for (int s = 0; s < 1000; ++s) {
      auto F = random.deformation(0.15, 4.0);
      if (!needs_positive_volume<M> && s % 4 == 0) F = F * Samples::diagonal(1, 1, -1);
      F = cast<double>(cast<T>(F));
      auto const bound = probe.template stiffness<T>(F);
      auto const A = probe.tangent(F);
      double const scale = probe.scale(F);
      mode = max(mode, (Probe::largest_eigenvalue(A) - double(bound.bulk3)) / scale);
      wave = max(wave, (probe.fastest_wave(A, probe.template stress<double>(F), random, 20) -
                        double(bound.longitudinal)) /
                           scale);
    }
    laws.push_back({"largest eigenvalue of dtau/dL above its bound", mode, 1e-6 + 256 * eps});
    laws.push_back({"fastest wave above its bound", wave, 1e-6 + 256 * eps});
  }
  {
    // Where the exact result is too large for T, infinity or NaN is the right answer: the run flags it.
    double wrong = 0;
    auto const check = [&](Mat3<double> const& F) {
      auto const fits = [](double exact, T found) {
        return is_finite(found) || !(abs(exact) < 0.01 / (eps * eps * eps * eps * eps));
      };
      auto const tau = probe.template stress<T>(F);
      auto const exact = probe.template stress<double>(F);
      for (int i = 0; i < 9; ++i) wrong += fits(norm(exact), tau.m[i]) ? 0 : 1;
      auto const b = probe.template stiffness<T>(F);
      auto const b_exact = probe.template stiffness<double>(F);
      wrong += fits(b_exact.bulk3, b.bulk3) && fits(b_exact.longitudinal, b.longitudinal) ? 0 : 1;
      wrong += b.bulk3 < T(0) || b.longitudinal < T(0) ? 1 : 0;
      wrong += fits(probe.template energy<double>(F), probe.template energy<T>(F)) ? 0 : 1;
    };
    Samples random(3);
    Vec3<double> const axes[3] = {{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
    check(Mat3<double>::zero());
    check(Samples::diagonal(1, 0, 0));
    check(Samples::diagonal(1, 1, 0));
    check(Samples::diagonal(-1, 1, 1));
    check(Samples::diagonal(1, 1, -1e-8));
    check(Samples::diagonal(1, 1, 1 + 1e-7));
    check(-I);
    for (double const size : {1e-20, 1e-6, 1e-3, 0.1, 10.0, 1e3, 1e10}) check(size * I);
    for (auto const& axis : axes) check(Samples::rotation_by(axis, pi<double>));
    for (int s = 0; s < 100; ++s) check(random.template matrix<3, 3>(-2, 2));
    for (int s = 0; s < 100; ++s) {
      auto const a = random.unit_vector(), b = random.unit_vector();
      check(outer(a, b));
    }
    laws.push_back({"finite at any F: numbers that are not", wrong, 0});
    auto broken = I;
    broken(1, 2) = std::numeric_limits<double>::quiet_NaN();
    laws.push_back({"NaN in F shows in the stress",
                    is_finite(probe.template stress<T>(broken)) ? 1.0 : 0.0, 0});
  }
  {
    // Nominal stress in uniaxial strain along x; a law that softens loses uniqueness.
    double drop = 0;
    double const scale = probe.scale(I);
    double previous = -1e300;
    for (int s = 0; s <= 280; ++s) {
      double const stretch = 0.2 + 0.01 * s;
      double const P =
          probe.template stress<double>(Samples::diagonal(stretch, 1, 1))(0, 0) / stretch;
      drop = max(drop, (previous - P) / scale);
      previous = P;
    }
    laws.push_back({"force grows with stretch on [0.2, 3]: largest fall per 0.01", drop, 0});
  }
  return laws;
}

}  // namespace mpmpbd
