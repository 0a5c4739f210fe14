// Runs are moved and looked at, and how far apart two stores are.
#pragma once

#include <cmath>
#include <string_view>
#include <vector>

#include <mpmpbd/core/state.hpp>
#include <mpmpbd/testing/worst.hpp>

namespace test {

// The state as it is looked at: a run on a device fetches it, and sends nothing back.
template <class Run> auto const& read(Run const& run) { return run.state(); }

template <class Run> void step_on(Run& run, int steps, double h) {  // of h [s]
  for (int s = 0; s < steps; ++s) run.step(h);
}

// Largest difference of a field over all environments [unit of the field]; a NaN is the largest.
template <class F, class Store> double difference(Store const& a, Store const& b) {
  auto const& x = a.template table<typename F::Domain>().template planes<F>();
  auto const& y = b.template table<typename F::Domain>().template planes<F>();
  mpmpbd::testing::Worst worst;
  for (std::size_t i = 0; i < x.size(); ++i)
    worst.include(std::fabs(static_cast<double>(x[i]) - static_cast<double>(y[i])));
  return worst.value();
}

// The bytes of all fields of an environment, component by component.
template <class Store> std::vector<std::string_view> rows_of(Store const& store, std::int64_t env) {
  std::vector<std::string_view> rows;
  mpmpbd::for_each_field(typename Store::List{}, [&]<class F>(F) {
    auto const& table = store.template table<typename F::Domain>();
    auto const* const planes = table.template planes<F>().data();
    for (int c = 0; c < F::components; ++c)
      rows.emplace_back(reinterpret_cast<char const*>(planes + (c * store.environments() + env) *
                                                                   table.capacity()),
                        static_cast<std::size_t>(table.capacity()) * sizeof(*planes));
  });
  return rows;
}
// Whether environments of two stores hold the same bits in all fields.
template <class Store>
bool same_bits(Store const& a, std::int64_t env_a, Store const& b, std::int64_t env_b) {
  return rows_of(a, env_a) == rows_of(b, env_b);
}

}  // namespace test
