// The state of a run as planes of words in one piece of memory, whatever its scene stores: what puts environments back to
// a remembered state is one kernel for all.
#pragma once

#include <cstdint>
#include <vector>

#include <mpmpbd/backend/cuda/memory.cuh>
#include <mpmpbd/backend/cuda/tables.cuh>
#include <mpmpbd/scene/run_state.hpp>

namespace mpmpbd::cuda {

// Where the planes of a store lie within one piece of memory.
template <class Store> struct Layout {
  template <class F> static std::size_t bytes_of(Store const& store) {
    return store.template table<typename F::Domain>().template planes<F>().size() *
           sizeof(element_t<F, typename Store::Scalar>);
  }
  static std::size_t aligned(std::size_t n) { return (n + 255) / 256 * 256; }

  // Calls f(F, bytes, offset) for every field and g(D, bytes, offset) for the live counts of every domain; returns
  // the bytes of all.
  template <class OnField, class OnDomain>
  static std::size_t walk(Store const& store, OnField&& f, OnDomain&& g) {
    std::size_t at = 0;
    for_each_field(typename Store::List{}, [&]<class F>(F field) {
      std::size_t const n = bytes_of<F>(store);
      f(field, n, at);
      at += aligned(n);
    });
    for_each_type(typename Store::Domains{}, [&]<class D>(std::type_identity<D> domain) {
      std::size_t const n = static_cast<std::size_t>(store.environments()) * sizeof(std::int64_t);
      g(domain, n, at);
      at += aligned(n);
    });
    return at;
  }
  static std::size_t bytes(Store const& store) {
    return walk(
        store, [](auto...) {}, [](auto...) {});
  }
};

// What an environment has of a plane: words of environment 0, and as many for each after it.
struct Plane {
  std::int64_t first, words;
};

// All that is put back: which episode it is goes on.
template <class Store> std::vector<Plane> planes_of_environment(Store const& store) {
  using Word = std::uint32_t;
  std::vector<Plane> all;
  auto const add = [&](std::size_t at, std::size_t bytes) {
    all.push_back({static_cast<std::int64_t>(at / sizeof(Word)),
                   static_cast<std::int64_t>(bytes / sizeof(Word))});
  };
  auto const environments = static_cast<std::size_t>(store.environments());
  Layout<Store>::walk(
      store,
      [&]<class F>(F, std::size_t n, std::size_t at) {
        static_assert(sizeof(element_t<F, typename Store::Scalar>) % sizeof(Word) == 0);
        if constexpr (!std::is_same_v<F, environment::Episode>)
          for (std::size_t c = 0; c < F::components; ++c)
            add(at + c * (n / F::components), n / F::components / environments);
      },
      [&](auto, std::size_t n, std::size_t at) { add(at, n / environments); });
  return all;
}

// Puts environments back to a remembered state; several blocks each, which share out its planes. `Word`: so that all that
// include this have one kernel.
template <class Word>
__global__ void reset(Word* now, Word const* remembered, Plane const* planes, int count,
                      std::int64_t* episodes, unsigned char const* mask, int parts) {
  std::int64_t const env = blockIdx.x / static_cast<unsigned>(parts);
  int const part = static_cast<int>(blockIdx.x) % parts;
  if (mask != nullptr && mask[env] == 0) return;
  for (int p = part; p < count; p += parts) {
    auto const words = planes[p].words, first = planes[p].first + env * words;
    for (std::int64_t i = threadIdx.x; i < words; i += blockDim.x)
      now[first + i] = remembered[first + i];
  }
  if (part == 0 && threadIdx.x == 0) episodes[env] += 1;
}

}  // namespace mpmpbd::cuda
