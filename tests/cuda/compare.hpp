// How far apart two stores are.
#pragma once

#include <cmath>
#include <cstring>

#include <mpmpbd/core/state.hpp>
#include <mpmpbd/testing/worst.hpp>

namespace test {

// Largest difference of a field over all environments [unit of the field]; a NaN is the largest.
template <class F, class Store> double difference(Store const& a, Store const& b) {
  auto const& x = a.template table<typename F::Domain>().template planes<F>();
  auto const& y = b.template table<typename F::Domain>().template planes<F>();
  mpmpbd::testing::Worst worst;
  for (std::size_t i = 0; i < x.size(); ++i)
    worst.include(std::fabs(static_cast<double>(x[i]) - static_cast<double>(y[i])));
  return worst.value();
}

// Whether environments of two stores hold the same bits in all fields.
template <class Store>
bool same_bits(Store const& a, std::int64_t env_a, Store const& b, std::int64_t env_b) {
  bool same = true;
  mpmpbd::for_each_field(typename Store::List{}, [&]<class F>(F) {
    auto const& x = a.template table<typename F::Domain>();
    auto const& y = b.template table<typename F::Domain>();
    auto const n = static_cast<std::size_t>(x.capacity());
    for (int c = 0; c < F::components; ++c) {
      auto const* p = x.template planes<F>().data() + (c * a.environments() + env_a) * x.capacity();
      auto const* q = y.template planes<F>().data() + (c * b.environments() + env_b) * y.capacity();
      same = same && std::memcmp(p, q, n * sizeof(*p)) == 0;
    }
  });
  return same;
}

}  // namespace test
