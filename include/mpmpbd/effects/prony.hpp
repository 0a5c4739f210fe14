// Viscoelastic shear: the deviatoric stress of any material relaxes by a Prony series,
// G(t) = G0 (1 - sum g_i + sum g_i exp(-t/tau_i)). Simo 1987; Simo and Hughes, Computational
// Inelasticity, 10.3.
#pragma once

#include <array>
#include <stdexcept>

#include <mpmpbd/core/polar.hpp>
#include <mpmpbd/effects/concepts.hpp>

namespace mpmpbd {

// The material gives the instantaneous stress, so its stiffness bounds stay bounds: no new limit of dt.
// With s = R^T dev(tau) R, R the rotation in F, each branch obeys dq/dt + q/tau_i = ds/dt, solved
// exactly for s linear in time over a step; tau loses R sum g_i (s - q_i) R^T. History is stored in the
// frame of R and is objective at any step and rotation: no rate, no spin is integrated.
// Limits: the same g for all deviatoric stress, bulk response elastic; a history of 5 (N + 1) numbers and
// one polar decomposition per particle and step. Energies reported by the material are instantaneous.
template <int N = 1> struct Prony {
  static_assert(N >= 1 && N <= 4, "mpmpbd Prony<N>: give one to four branches");

  // Deviatoric symmetric tensors: xx, yy, xy, xz, yz.
  struct Previous : Field<"Prony s", "Pa", Numbers<5>, Particles> {};
  struct Overstress : Field<"Prony q", "Pa", Numbers<5 * N>, Particles> {};

  using Role = role::Effect;
  static constexpr FixedString name = "Prony";
  static constexpr Slot slot = Slot::before_scatter;
  using Reads = Fields<particle::Deformation, particle::Stress, Previous, Overstress>;
  using Writes = Fields<particle::Stress, Previous, Overstress>;

  template <class T> struct Parameters {
    T g[N];    // share of the instantaneous shear modulus that relaxes [1]; their sum is at most 1
    T tau[N];  // relaxation times [s]
  };
  static constexpr auto parameter_info = [] {
    constexpr std::string_view shares[] = {"g_1", "g_2", "g_3", "g_4"};
    constexpr std::string_view times[] = {"tau_1", "tau_2", "tau_3", "tau_4"};
    std::array<ParameterInfo, 2 * N> info{};
    for (std::size_t i = 0; i < N; ++i) {
      info[i] = bound::between(shares[i], "1", 0.0, 1.0);
      info[N + i] = bound::positive(times[i], "s");
    }
    return info;
  }();
  // Throws std::invalid_argument when more than everything would relax.
  template <class T> static void check_together(Parameters<T> const& k) {
    double sum = 0.0;
    for (T const share : k.g) sum += static_cast<double>(share);
    check_parameter("Prony", {"sum of g_i", "1", 0.0, 1.0 + 1e-6}, sum);
  }

  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& p, K const& k, Tick<T> const& tick) {
    Mat3<T>& tau = p[particle::Stress{}];
    Mat3<T> const R = rotation_of(p[particle::Deformation{}]);
    Vec<T, 5> const s = packed(transpose(R) * deviator(tau) * R);
    Vec<T, 5> const change = s - p[Previous{}];
    p[Previous{}] = s;
    auto& history = p[Overstress{}];
    Vec<T, 5> relaxed{};
    for (int i = 0; i < N; ++i) {
      T const x = tick.dt / k.tau[i];
      T const keep = exp(-x), gain = x > T(0) ? -expm1(-x) / x : T(1);
      for (int c = 0; c < 5; ++c) {
        T const q = multiply_add(gain, change[c], keep * history[5 * i + c]);
        history[5 * i + c] = q;
        relaxed[c] = multiply_add(T(k.g[i]), s[c] - q, relaxed[c]);
      }
    }
    tau -= R * unpacked(relaxed) * transpose(R);
  }

 private:
  template <class T> MPMPBD_HD static Vec<T, 5> packed(Mat3<T> const& a) {
    return {{a(0, 0), a(1, 1), (a(0, 1) + a(1, 0)) / 2, (a(0, 2) + a(2, 0)) / 2,
             (a(1, 2) + a(2, 1)) / 2}};
  }
  template <class T> MPMPBD_HD static Mat3<T> unpacked(Vec<T, 5> const& v) {
    return {{v[0], v[2], v[3], v[2], v[1], v[4], v[3], v[4], -v[0] - v[1]}};
  }
};

}  // namespace mpmpbd
