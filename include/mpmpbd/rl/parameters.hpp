// The numbers of a policy, set for one environment from code that runs anywhere.
#pragma once

#include <mpmpbd/core/state.hpp>

namespace mpmpbd::rl {

template <class P, class Env>
MPMPBD_HD void set_parameters(Env const& env, parameters_t<P, typename Env::Scalar> const& k) {
  auto const& environments = env.template domain<Environments>();
  auto const* numbers = reinterpret_cast<typename Env::Scalar const*>(&k);
  for (int i = 0; i < static_cast<int>(parameter_count<P>); ++i)
    environments.view.template plane<ParametersField<P>>(i)[environments.first] = numbers[i];
}

}  // namespace mpmpbd::rl
