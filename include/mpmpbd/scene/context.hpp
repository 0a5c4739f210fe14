// What policies and stages are told about their environment: its clock, its grid and the numbers of every policy.
#pragma once

#include <mpmpbd/core/state.hpp>
#include <mpmpbd/core/tick.hpp>
#include <mpmpbd/mpm/lattice.hpp>

namespace mpmpbd {

// The parameters of all policies of a scene, for one environment.
template <class T, class Policies> struct ParameterBlock;
template <class T, class... Ps> struct ParameterBlock<T, TypeList<Ps...>> {
  template <class P> struct Held { parameters_t<P, T> k; };
  struct All : Held<Ps>... {};
  All all;

  template <class P> MPMPBD_HD auto const& get() const {
    return static_cast<Held<P> const&>(all).k;
  }
  template <class P> MPMPBD_HD auto& get() { return static_cast<Held<P>&>(all).k; }
};

// What every stage is told about its environment.
template <class T, class Policies> struct Context {
  using Scalar = T;
  Tick<T> tick;
  Lattice<T> lattice;
  ParameterBlock<T, Policies> parameters;

  template <class P> MPMPBD_HD auto const& of() const { return parameters.template get<P>(); }
};

namespace detail {
template <class P, class Block, class Env>
MPMPBD_HD void load_parameters_of([[maybe_unused]] Block& block, [[maybe_unused]] Env const& env) {
  using T = typename Env::Scalar;
  if constexpr (parameter_count < P >> 0) {
    auto const& d = env.template domain<Environments>();
    auto* const numbers = reinterpret_cast<T*>(&block.template get<P>());
    for (int i = 0; i < static_cast<int>(parameter_count<P>); ++i)
      numbers[i] = d.view.template plane<ParametersField<P>>(i)[d.first];
  }
}
template <class Block, class Env, class... Ps>
MPMPBD_HD void load_parameters_of_all(Block& block, Env const& env, TypeList<Ps...>) {
  (load_parameters_of<Ps>(block, env), ...);
}
}  // namespace detail

// The context of an environment, from its fields (pbd/access.hpp); the clock is not set.
template <class Policies, class Env, class T = typename Env::Scalar>
MPMPBD_HD Context<T, Policies> load_context(Env const& env, Lattice<T> const& lattice) {
  Context<T, Policies> c{};
  c.lattice = lattice;
  detail::load_parameters_of_all(c.parameters, env, Policies{});
  return c;
}

}  // namespace mpmpbd
