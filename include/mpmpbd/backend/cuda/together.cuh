// Which stages of a scene concern an environment as a whole: its coupling.
#pragma once

#include <mpmpbd/scene/stage.hpp>

namespace mpmpbd::cuda {

namespace detail {
template <class Stages> struct TogetherOf;
template <class... Ss> struct TogetherOf<TypeList<Ss...>> {
  using type = join_t<std::conditional_t<concerns_environment<Ss>, TypeList<Ss>, TypeList<>>...>;
};

// Whether a stage names no field of a domain.
template <class S, class Domain>
inline constexpr bool names_none_of =
    on_t<union_t<typename S::Reads, typename S::Writes>, Domain>::count == 0;

// Stages before the first that goes item by item, that one, and those after it.
template <class Stages> struct AtItemWise {
  using Before = TypeList<>;
  using ItemWise = TypeList<>;
  using After = TypeList<>;
};
template <class S, class... Ss> struct AtItemWise<TypeList<S, Ss...>> {
  using Rest = AtItemWise<TypeList<Ss...>>;
  using Before = join_t<TypeList<S>, typename Rest::Before>;
  using ItemWise = typename Rest::ItemWise;
  using After = typename Rest::After;
};
template <class S, class... Ss>
  requires std::is_same_v<typename S::Kind, kind::ItemWise>
struct AtItemWise<TypeList<S, Ss...>> {
  using Before = TypeList<>;
  using ItemWise = TypeList<S>;
  using After = TypeList<Ss...>;
  static_assert(
      names_none_of<S, Particles> && on_t<typename S::Writes, Nodes>::count == 0,
      "mpmpbd Simulation<Scene, Cuda>: a stage of kind::ItemWise names fields of particles or writes "
      "nodes, while particles gather from them; leave that to a stage of kind::Together before it");
  static_assert(
      ((names_none_of<Ss, Nodes> && names_none_of<Ss, Particles>)&&...),
      "mpmpbd Simulation<Scene, Cuda>: a stage after one of kind::ItemWise reads or writes nodes "
      "or particles, which are those of the next substep by then; put it before that stage");
};
template <class Scene>
inline constexpr bool couples = TogetherOf<typename Scene::Substep::Stages>::type::size > 0;
}  // namespace detail

}  // namespace mpmpbd::cuda
