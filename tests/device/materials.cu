// Every material, and gravity, damping, viscosity, Prony, pinned regions and walls compute on the device what they compute on the host.
//
// A kernel that nvcc silently leaves empty gives zeros here. Host and device round differently (FMA,
// their own log and exp), so results agree to rounding times the conditioning of F, not to the bit.
#include <cmath>
#include <cstdio>

#include <mpmpbd/core/sym_eigen.hpp>
#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/pinned_region.hpp>
#include <mpmpbd/effects/prony.hpp>
#include <mpmpbd/effects/viscosity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/fibre_reinforced.hpp>
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/per_particle.hpp>
#include <mpmpbd/mpm/materials/st_venant_kirchhoff.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>
#include <mpmpbd/mpm/materials/weakly_compressible_fluid.hpp>

#include "device/report.hpp"

using namespace mpmpbd;

namespace {

constexpr int count = 256;  // deformations

// Deformations that need no host library, stretched and sheared; every fourth one inverted. All of them
// are far from where a result may jump: det F = 0, and two stretches s and -s.
template <class T> MPMPBD_HD Mat3<T> deformation(int i) {
  T const a = T(0.37) * T(i);
  bool const inverted = i % 4 == 0;
  Mat3<T> F = T(1.2) * Mat3<T>::identity();
  for (int c = 0; c < 9; ++c) F.m[c] += T(inverted ? 0.1 : 0.35) * sin(a * T(c + 1) + T(c));
  if (inverted) {
    for (int c = 0; c < 3; ++c) {
      F(c, 1) *= T(0.8);
      F(c, 2) *= T(-0.4);
    }
  }
  return i == 0 ? Mat3<T>::zero() : F;
}

constexpr int results = 24;

template <class M, class T> MPMPBD_HD void material(int i, parameters_t<M, T> const& k, T* out) {
  detail::Archetype<M, T> p{};
  if constexpr (contains<typename M::Reads, particle::Fibre>)
    p[particle::Fibre{}] = {{T(0.36), T(0.48), T(0.8)}};
  if constexpr (requires { typename M::Values; })
    for (int c = 0; c < M::count; ++c) p[typename M::Values{}][c] = T(1000 * (c + 1));
  p[particle::Deformation{}] = deformation<T>(i);
  auto const tau = M::kirchhoff(p, k);
  auto const bound = M::stiffness(p, k);
  for (int c = 0; c < 9; ++c) out[c] = tau.m[c];
  out[9] = bound.bulk3;
  out[10] = bound.longitudinal;
  out[11] = M::energy(p, k);
  if constexpr (UpdatesHistory<M>) {
    M::after_update(p, k, Tick<T>{T(1e-4), T(1e-4), 3});
    out[12] = p[particle::Deformation{}](0, 0);
  }
}

template <class E, class T> MPMPBD_HD void effect(int i, parameters_t<E, T> const& k, T* out) {
  using Item = detail::Archetype<E, T>;
  Item item{};
  auto const F = deformation<T>(i);
  if constexpr (contains<typename Item::List, particle::Deformation>)
    item[particle::Deformation{}] = F;
  if constexpr (contains<typename Item::List, particle::Stress>)
    item[particle::Stress{}] = T(1e3) * (F + transpose(F));
  if constexpr (contains<typename Item::List, particle::Affine>)
    item[particle::Affine{}] = T(10) * F;
  if constexpr (contains<typename Item::List, node::Velocity>)
    item[node::Velocity{}] = {{F(0, 0), F(1, 0), F(2, 0)}};
  if constexpr (contains<typename Item::List, node::Position>)
    item[node::Position{}] = {{F(0, 1), F(1, 1), F(2, 1)}};
  for (int n = 0; n < 3; ++n) E::apply(item, k, Tick<T>{T(2e-3), T(2e-3), n});
  if constexpr (contains<typename Item::List, particle::Stress>)
    for (int c = 0; c < 9; ++c) out[c] = item[particle::Stress{}].m[c];
  if constexpr (contains<typename Item::List, node::Velocity>)
    for (int c = 0; c < 3; ++c) out[c] = item[node::Velocity{}][c];
}

template <class M, class T> MPMPBD_HD void compute(int i, parameters_t<M, T> const& k, T* out) {
  if constexpr (HasRole<M, role::Material>)
    material<M, T>(i, k, out);
  else
    effect<M, T>(i, k, out);
}
// Policies and their numbers. All are computed by one kernel, a block each: kernels are what compiling takes long for.
template <class P, class T> struct Case { parameters_t<P, T> parameters; };
template <class P, class T> Case<P, T> with(parameters_t<P, T> const& k) { return {k}; }

template <class T, class... Ps> struct CasesOf : Case<Ps, T>... {
  static constexpr int count_of_all = sizeof...(Ps);
  static constexpr char const* names[] = {Ps::name.text...};

  MPMPBD_HD void compute_one(int which, int i, T* out) const {
    int place = 0;
    ((place++ == which ? compute<Ps, T>(i, static_cast<Case<Ps, T> const&>(*this).parameters, out)
                       : void()),
     ...);
  }
};
template <class T, class... Ps> CasesOf<T, Ps...> join(Case<Ps, T> const&... each) {
  return {each...};
}

template <class T> auto cases() {
  Lame<T> const k{T(6.1e3), T(2.4e4)};
  return join<T>(
      with<NeoHookean, T>(k), with<StableNeoHookean, T>(k), with<FixedCorotated, T>(k),
      with<StVenantKirchhoff, T>(k), with<FibreReinforced<>, T>({k, T(4e3), T(1.7)}),
      with<WeaklyCompressibleFluid, T>({T(2e3), T(7)}), with<PerParticle<NeoHookean>, T>({}),
      with<Gravity, T>({{T(0.3), T(-1), T(-9.81)}}), with<Damping, T>({T(35)}),
      with<Viscosity, T>({T(12)}), with<Prony<1>, T>({{T(0.6)}, {T(0.05)}}),
      with<Prony<3>, T>({{T(0.3), T(0.2), T(0.1)}, {T(1e-4), T(0.05), T(10)}}),
      with<PinnedRegion, T>({{T(-1), T(-1), T(-1)}, {T(1), T(1), T(1)}}),
      with<DrivenRegion, T>({{T(-1), T(-1), T(-1)}, {T(1), T(1), T(1)}, {T(0.1), T(0.2), T(0.3)}}),
      with<Wall<Sticky, 0, Side::low>, T>({T(0.1)}),
      with<Wall<Separating, 2, Side::high>, T>({T(0.1)}),
      with<Walls<Slip>, T>({{T(-1), T(-1), T(-1)}, {T(1), T(1), T(1)}}));
}
template <class T> using Cases = decltype(cases<T>());

template <class T> MPMPBD_HD void compute_row(Cases<T> const& all, int which, int i, T* out) {
  all.compute_one(which, i, out + (which * count + i) * results);
}
__global__ void on_device(Cases<float> single, float* singles, Cases<double> twice,
                          double* doubles) {
  int const place = static_cast<int>(blockIdx.x), i = static_cast<int>(threadIdx.x);
  compute_row(single, place, i, singles);
  compute_row(twice, place, i, doubles);
}

constexpr int places = Cases<float>::count_of_all;
static_assert(Cases<double>::count_of_all == places);
template <class T> struct Results {
  static constexpr int numbers = places * count * results;
  T host[numbers], device[numbers];
  T* memory = nullptr;

  Results() {
    for (auto& h : host) h = T(0);
    for (int place = 0; place < places; ++place)
      for (int i = 0; i < count; ++i) compute_row(cases<T>(), place, i, host);
    cudaMalloc(&memory, sizeof device);
    cudaMemset(memory, 0, sizeof device);
  }
  ~Results() { cudaFree(memory); }
  void fetch() { cudaMemcpy(device, memory, sizeof device, cudaMemcpyDeviceToHost); }

  void compare(char const* name, int place) const {
    bool ok = true;
    double worst = 0, size = 0;
    for (int i = place * count * results; i < (place + 1) * count * results; ++i) {
      ok = ok && is_finite(host[i]) && is_finite(device[i]);
      worst = std::fmax(worst, std::fabs(double(host[i]) - double(device[i])));
      size = std::fmax(size, std::fabs(double(host[i])));
    }
    // Relative to the largest number of all: some stresses are differences that nearly cancel.
    ok = ok && size > 0 && worst <= 1000 * double(epsilon<T>) * size;
    test::report.count(ok);
    std::printf("%s  %-40s %-6s  %.2g of %.2g\n", test::word(ok), name,
                sizeof(T) == 4 ? "float" : "double", worst, size);
  }
};
template <class T> void compare_all(Results<T>& found) {
  found.fetch();
  for (int place = 0; place < places; ++place) found.compare(Cases<T>::names[place], place);
}
}  // namespace

int main() {
  static Results<float> singles;
  static Results<double> doubles;
  on_device<<<places, count>>>(cases<float>(), singles.memory, cases<double>(), doubles.memory);
  bool const launched = cudaGetLastError() == cudaSuccess;
  test::report.count(launched);
  compare_all(singles);
  compare_all(doubles);
  return test::report.end();
}
