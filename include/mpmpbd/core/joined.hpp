// Names of composed policies: joined("per-particle ", M::name) at compile time.
#pragma once

#include <mpmpbd/core/fixed_string.hpp>

namespace mpmpbd {

template <std::size_t A, std::size_t B>
constexpr FixedString<A + B - 1> joined(FixedString<A> const& a, FixedString<B> const& b) {
  char text[A + B - 1]{};
  for (std::size_t i = 0; i + 1 < A; ++i) text[i] = a.text[i];
  for (std::size_t i = 0; i < B; ++i) text[A - 1 + i] = b.text[i];
  return FixedString<A + B - 1>(text);
}
template <std::size_t A, std::size_t B, class... Rest>
constexpr auto joined(FixedString<A> const& a, FixedString<B> const& b, Rest const&... rest) {
  return joined(joined(a, b), rest...);
}

}  // namespace mpmpbd
