// A2.11: Cook's membrane against finite elements of second order, in plane strain and in plane stress. Here up to
// nu = 0.49; what is closer to incompressible takes longer steps: mpm_cook_long.
// seconds: 30
// on a device
#include <mpmpbd/mpm/materials/lame.hpp>

#include "physics/cook.hpp"

using namespace test;

namespace {

// Neo-Hookean tissue in plane stress: where F has no stretch across the layer (F_33 = 1), the tissue takes the s at
// which tau_33 = mu (s^2 - 1) + lambda ln(s det F) = 0. There dpsi/ds = 0, so its stress is that of the stretched F.
struct ThinSheet {
  using Role = role::Material;
  static constexpr FixedString name = "neo-Hookean sheet";
  using Reads = Fields<particle::Deformation>;
  using Writes = Fields<>;
  static constexpr bool needs_positive_volume = true;

  template <class T> using Parameters = Lame<T>;
  static constexpr auto parameter_info = lame_info;

  template <class P, class K> MPMPBD_HD static auto kirchhoff(P const& p, K const& k) {
    return NeoHookean::kirchhoff(stretched(p, k), k);
  }
  template <class P, class K> MPMPBD_HD static auto energy(P const& p, K const& k) {
    return NeoHookean::energy(stretched(p, k), k);
  }
  // Free to move across, it is not stiffer.
  template <class P, class K> MPMPBD_HD static auto stiffness(P const& p, K const& k) {
    return NeoHookean::stiffness(stretched(p, k), k);
  }

 private:
  template <class P, class K> MPMPBD_HD static auto stretched(P const& p, K const& k) {
    using T = typename P::Scalar;
    Local<T, Reads> q;
    auto& F = q[particle::Deformation{}];
    F = p[particle::Deformation{}];
    T const J = determinant(F);
    if (!(J > T(0))) return q;
    T log_s = T(0);
    for (int n = 0; n < 6; ++n) {  // Newton: convex and rising
      T const s2 = exp(2 * log_s);
      log_s -= (k.mu * (s2 - T(1)) + k.lambda * (log(J) + log_s)) / (2 * k.mu * s2 + k.lambda);
    }
    for (int i = 0; i < 3; ++i) F(i, 2) *= exp(log_s);
    return q;
  }
};

template <class Form> void check_plane_strain() {
  double previous = 1e300;
  for (auto const& panel :
       {Panel{0.3, 21.944}, Panel{0.4, 20.505}, Panel{0.45, 19.58}, Panel{0.49, 18.72}}) {
    double const now = share<Form>(panel);
    CAPTURE(Form::name.view(), panel.poisson, now);
    CHECK_THAT(now, WithinAbs(1.0, 0.03));
    CHECK(now < previous);
    previous = now;
  }
}

template <class Form> void check_plane_stress() {
  double const now =
      Membrane<Mpm<ThinSheet, QuadraticBSpline, Apic, Form>>(1.0 / 3.0).displacement() / 23.965;
  CAPTURE(Form::name.view(), now);
  CHECK_THAT(now, WithinAbs(1.0, 0.03));
}

}  // namespace

// Ratios at nu = 0.3, 0.4, 0.45, 0.49: 1.019, 1.017, 1.014, 1.007 with the weight gradient, 1.012, 1.009, 1.006, 0.994
// with MLS. The page expects less than 0.7 at nu = 0.49 without a cure of locking: quadratic shapes lose 2 % to there.
TEST_CASE("Cook's membrane bends, and hardly locks", "[mpm]") {
  check_plane_strain<WeightGradient>();
  check_plane_strain<Mls>();
}

// 1.019 with the weight gradient, 1.012 with MLS; plane strain is at 0.90 of plane stress.
TEST_CASE("Cook's membrane bends more where its thickness is free", "[mpm]") {
  check_plane_stress<WeightGradient>();
  check_plane_stress<Mls>();
}
