// Which stages of a scene concern an environment as a whole: its coupling.
#pragma once

#include <mpmpbd/scene/stage.hpp>

namespace mpmpbd::cuda {

namespace detail {
// Stages over the whole environment, and whether the rest of the block may go on meanwhile: those that change
// nodes must say which (announces_nodes).
template <class Stages> struct TogetherOf;
template <class... Ss> struct TogetherOf<TypeList<Ss...>> {
  template <class S>
  static constexpr bool is_together = std::is_same_v<typename S::Kind, kind::Together>;
  template <class S> static consteval bool may_overlap() {
    if constexpr (!is_together<S> || !contains<typename S::Writes, node::Velocity>)
      return true;
    else if constexpr (requires { S::announces_nodes; })
      return S::announces_nodes;
    else
      return false;
  }
  using type = join_t<std::conditional_t<is_together<Ss>, TypeList<Ss>, TypeList<>>...>;
  static constexpr bool overlap = (may_overlap<Ss>() && ...) && type::size > 0;
};
template <class Scene>
inline constexpr bool couples = TogetherOf<typename Scene::Substep::Stages>::type::size > 0;
}  // namespace detail

}  // namespace mpmpbd::cuda
