// Which stages of a scene concern an environment as a whole: its coupling.
#pragma once

#include <mpmpbd/scene/stage.hpp>

namespace mpmpbd::cuda {

namespace detail {
template <class Stages> struct TogetherOf;
template <class... Ss> struct TogetherOf<TypeList<Ss...>> {
  template <class S>
  static constexpr bool is_together = std::is_same_v<typename S::Kind, kind::Together>;
  using type = join_t<std::conditional_t<is_together<Ss>, TypeList<Ss>, TypeList<>>...>;
};
template <class Scene>
inline constexpr bool couples = TogetherOf<typename Scene::Substep::Stages>::type::size > 0;
}  // namespace detail

}  // namespace mpmpbd::cuda
