// A string that can be a template argument: how a field or a policy carries its name.
#pragma once

#include <cstddef>
#include <string_view>

namespace mpmpbd {

template <std::size_t N> struct FixedString {
  char text[N]{};
  constexpr FixedString(char const (&s)[N]) {
    for (std::size_t i = 0; i < N; ++i) text[i] = s[i];
  }
  constexpr std::string_view view() const { return {text, N - 1}; }
};

}  // namespace mpmpbd
