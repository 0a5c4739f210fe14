// A state told in other units: every number multiplied by what the unit that its field or parameter declares is in
// them. So it is also a test of what fields and parameters declare.
#pragma once

#include <cctype>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

#include <mpmpbd/core/state.hpp>
#include <mpmpbd/pbd/fields.hpp>

namespace test {

// How many of its units of length, mass and time a metre, a kilogram and a second are.
struct UnitSystem {
  double length, mass, time;

  UnitSystem inverse() const { return {1 / length, 1 / mass, 1 / time}; }

  // How many units one of `unit` is: "kg/m^3", "N s", "rad/(N m)". Throws for a symbol that it does not know.
  double of(std::string_view unit) const {
    double factor = 1.0;
    bool below = false, group = false;
    for (std::size_t i = 0; i < unit.size();) {
      char const c = unit[i];
      if (std::isalpha(static_cast<unsigned char>(c))) {
        std::size_t end = i;
        while (end < unit.size() && std::isalpha(static_cast<unsigned char>(unit[end]))) ++end;
        double power = below ? -1.0 : 1.0;
        double const one = symbol(unit.substr(i, end - i));
        if (end + 1 < unit.size() && unit[end] == '^') power *= unit[end + 1] - '0', end += 2;
        factor *= std::pow(one, power);
        below = below && group;
        i = end;
        continue;
      }
      if (c == '/') below = true;
      if (c == '(') group = true;
      if (c == ')') group = below = false;
      ++i;
    }
    return factor;
  }

 private:
  double symbol(std::string_view s) const {
    double const force = mass * length / (time * time);
    if (s == "m") return length;
    if (s == "kg") return mass;
    if (s == "s") return time;
    if (s == "N") return force;
    if (s == "J") return force * length;
    if (s == "Pa") return force / (length * length);
    if (s == "rad" || s == "bits") return 1.0;
    throw std::invalid_argument("no unit is called '" + std::string(s) + "'");
  }
};

namespace detail {
template <class F> inline constexpr bool is_parameters = false;
template <class P> inline constexpr bool is_parameters<mpmpbd::ParametersField<P>> = true;
template <class P> P policy_of(mpmpbd::ParametersField<P>);
template <class C> C constraint_of(mpmpbd::Instances<C>);

// The unit of component `c` of a field: those of parameters are declared one by one.
template <class F> std::string_view component_unit(std::size_t c) {
  using Domain = typename F::Domain;
  if constexpr (is_parameters<F>) {
    return decltype(policy_of(F{}))::parameter_info[c].unit;
  } else if constexpr (requires { constraint_of(Domain{}); }) {
    using C = decltype(constraint_of(Domain{}));
    if constexpr (std::is_same_v<F, typename mpmpbd::instance<C>::Parameters>)
      return C::parameter_info[c].unit;
    else
      return F::unit.view();
  } else {
    return F::unit.view();
  }
}

template <class F, class Numbers> void tell_field_in(UnitSystem const& system, Numbers& numbers) {
  using T = typename Numbers::value_type;
  if constexpr (std::is_same_v<
                    F, mpmpbd::environment::Time>) {  // a whole number of 1e-12 units of time
    for (auto& t : numbers) t = std::llround(system.time * static_cast<double>(t));
  } else if constexpr (std::is_floating_point_v<T> && F::unit.view() != "J/C") {
    auto const items = numbers.size() / static_cast<std::size_t>(F::components);
    for (std::size_t c = 0; c < static_cast<std::size_t>(F::components); ++c) {
      double const factor = system.of(component_unit<F>(c));
      for (std::size_t i = c * items; i < (c + 1) * items; ++i)
        numbers[i] = static_cast<T>(factor * static_cast<double>(numbers[i]));
    }
  }
}
}  // namespace detail

// Tells a state that is told in SI in the units of `system`. Multipliers of constraints stay: a substep starts them
// from 0.
template <class State> void tell_in(UnitSystem const& system, State& state) {
  mpmpbd::for_each_type(typename State::Domains{}, [&]<class D>(std::type_identity<D>) {
    auto& table = state.template table<D>();
    [&]<class... Fs>(mpmpbd::Fields<Fs...>) {
      (detail::tell_field_in<Fs>(system, table.template planes<Fs>()), ...);
    }(typename std::remove_reference_t<decltype(table)>::List{});
  });
}

}  // namespace test
