// Parameters of a policy: a plain struct of numbers, beside a table that names and bounds each one.
//
// A policy is stateless code; its numbers live once per environment (so that every parameter can be
// randomised), or per particle through PerParticle<Policy>. One table serves validation, config
// files and the printed plan.
#pragma once

#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

#include <mpmpbd/core/config.hpp>

namespace mpmpbd {

// One number of a policy's Parameters, in the order of the struct's members.
struct ParameterInfo {
  std::string_view name;
  std::string_view unit;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_is_allowed = true;
  bool high_is_allowed = true;
};

namespace bound {
inline constexpr double none = std::numeric_limits<double>::infinity();
constexpr ParameterInfo any(std::string_view name, std::string_view unit) { return {name, unit}; }
constexpr ParameterInfo positive(std::string_view name, std::string_view unit) {
  return {name, unit, 0.0, none, false, false};
}
constexpr ParameterInfo not_negative(std::string_view name, std::string_view unit) {
  return {name, unit, 0.0, none, true, false};
}
constexpr ParameterInfo between(std::string_view name, std::string_view unit, double low,
                                double high) {
  return {name, unit, low, high};
}
}  // namespace bound

template <class P> concept HasParameters = requires { typename P::template Parameters<double>; };

namespace detail {
struct NoParameters {};
template <class P, class T, bool = HasParameters<P>> struct ParametersOf {
  using type = NoParameters;
};
template <class P, class T> struct ParametersOf<P, T, true> {
  using type = typename P::template Parameters<T>;
};
}  // namespace detail

// The numbers of policy P in precision T; an empty struct when it has none.
template <class P, class T> using parameters_t = typename detail::ParametersOf<P, T>::type;

template <class P>
inline constexpr std::size_t parameter_count = [] {
  if constexpr (HasParameters<P>) {
    static_assert(sizeof(parameters_t<P, double>) == 2 * sizeof(parameters_t<P, float>) &&
                      std::is_trivially_copyable_v<parameters_t<P, float>>,
                  "mpmpbd Parameters<T>: write a plain struct whose members are all of type T");
    return sizeof(parameters_t<P, double>) / sizeof(double);
  } else {
    return std::size_t{0};
  }
}();

// The same numbers in another precision.
template <class P, class To, class From>
MPMPBD_HD parameters_t<P, To> cast_parameters(parameters_t<P, From> const& from) {
  parameters_t<P, To> to{};
  if constexpr (parameter_count < P >> 0) {
    auto const* source = reinterpret_cast<From const*>(&from);
    auto* target = reinterpret_cast<To*>(&to);
    for (std::size_t i = 0; i < parameter_count<P>; ++i) target[i] = static_cast<To>(source[i]);
  }
  return to;
}

inline std::string bound_text(ParameterInfo const& info) {
  auto number = [](double v) {
    std::string s = std::to_string(v);
    s.erase(s.find_last_not_of('0') + 1);
    if (s.back() == '.') s.pop_back();
    return s;
  };
  auto const low =
      info.low == -bound::none ? "(-inf" : (info.low_is_allowed ? "[" : "(") + number(info.low);
  auto const high =
      info.high == bound::none ? "inf)" : number(info.high) + (info.high_is_allowed ? "]" : ")");
  return low + ", " + high;
}

// Refuses a number outside its bounds (NaN and infinity included) with its name, value and range.
inline void check_parameter(std::string_view owner, ParameterInfo const& info, double value) {
  bool const above = info.low_is_allowed ? value >= info.low : value > info.low;
  bool const below = info.high_is_allowed ? value <= info.high : value < info.high;
  if (above && below && value - value == 0.0) return;
  throw std::invalid_argument("mpmpbd " + std::string(owner) + ": " + std::string(info.name) +
                              " = " + std::to_string(value) + " " + std::string(info.unit) +
                              " is not allowed; give a finite number in " + bound_text(info));
}

// Refuses parameters out of bounds; throws std::invalid_argument, nothing is applied.
template <class P, class T> void check_parameters(parameters_t<P, T> const& k) {
  if constexpr (parameter_count < P >> 0) {
    static_assert(std::size(P::parameter_info) == parameter_count<P>,
                  "mpmpbd Parameters<T>: `parameter_info` needs one entry per number, in order");
    auto const* numbers = reinterpret_cast<T const*>(&k);
    for (std::size_t i = 0; i < parameter_count<P>; ++i)
      check_parameter(P::name.view(), P::parameter_info[i], static_cast<double>(numbers[i]));
    // Optional: a condition on several numbers together; it throws std::invalid_argument.
    if constexpr (requires { P::check_together(k); }) P::check_together(k);
  }
}

}  // namespace mpmpbd
