// A scene is a type: bodies, rods, needle, coupling and effects, by role and in any order.
//
// From it follow the pipeline of a substep, the stored state and the parameters - and nothing that it
// does not name.
#pragma once

#include <mpmpbd/core/state.hpp>
#include <mpmpbd/scene/pipeline.hpp>
#include <mpmpbd/scene/rod_stage.hpp>
#include <mpmpbd/scene/stage.hpp>

namespace mpmpbd {

namespace detail {
struct Absent {};
template <class T> inline constexpr bool present = !std::is_same_v<T, Absent>;

template <class P> struct LeavesOf { using type = TypeList<P>; };
template <class P>
  requires requires { typename P::Leaves; }
struct LeavesOf<P> {
  using type = typename P::Leaves;
};

template <class List> struct ParameterFields;
template <class... Ps> struct ParameterFields<TypeList<Ps...>> {
  using type = union_t<
      std::conditional_t<(parameter_count<Ps> > 0), Fields<ParametersField<Ps>>, Fields<>>...>;
};

template <class Body, class Effects> struct MpmStages {
  using Before = TypeList<ParticlesToGrid<Body, Effects>, MoveNodes<Body, Effects>>;
  using After = TypeList<GridToParticles<Body, Effects>>;
};
template <class Effects> struct MpmStages<Absent, Effects> {
  using Before = TypeList<>;
  using After = TypeList<>;
};

template <class Rods, class Effects> struct RodStages {
  using type = TypeList<MoveRods<Rods, Effects>>;
};
template <class Effects> struct RodStages<Absent, Effects> { using type = TypeList<>; };

// Effects of a scene, and the second halves of those that act on beads too when there are any.
template <class Effects, bool beads> struct WithBeads { using type = Effects; };
template <class E> struct OnBeadsOf { using type = TypeList<>; };
template <class E>
  requires requires { typename E::OnBeads; }
struct OnBeadsOf<E> {
  using type = TypeList<typename E::OnBeads>;
};
template <class... Es> struct WithBeads<TypeList<Es...>, true> {
  using type = join_t<TypeList<Es...>, typename OnBeadsOf<Es>::type...>;
};

// Stored fields that outlive a substep: all but those of the grid, which is scratch.
template <class F>
struct Outlives : std::bool_constant<F::stored && !std::is_same_v<typename F::Domain, Nodes>> {};
template <class List> struct StateOf : Filter<Fields<>, Outlives, List> {};

template <class List> struct PipelineOf;
template <class... Ss> struct PipelineOf<TypeList<Ss...>> { using type = Pipeline<Ss...>; };

template <class... Es> consteval bool check_effects(TypeList<Es...>) {
  return (check_effect<Es>() && ... && true);
}
}  // namespace detail

// State that every environment has.
using EnvironmentFields =
    Fields<environment::Status, environment::Step, environment::Substeps, environment::Dt,
           environment::DtLimit, environment::Seed, environment::Episode>;

template <class... Parts> struct Scene {
  static_assert(
      detail::count_role<role::Mpm, Parts...> < 2,
      "mpmpbd Scene<...>: more than one Mpm body given; a scene has one body of material points");
  static_assert(
      detail::count_role<role::Material, Parts...> + detail::count_role<role::Transfer, Parts...> +
              detail::count_role<role::Shape, Parts...> +
              detail::count_role<role::Form, Parts...> ==
          0,
      "mpmpbd Scene<...>: a material, shape function, transfer scheme or force form belongs into the body; write Scene<Mpm<NeoHookean, ...>, ...>");

  static_assert(detail::count_role<role::Pbd, Parts...> < 2,
                "mpmpbd Scene<...>: more than one Pbd body given; a scene has one, its threads are "
                "chains of the same beads");

  using Body = pick_t<role::Mpm, detail::Absent, Parts...>;
  using Rods = pick_t<role::Pbd, detail::Absent, Parts...>;
  static constexpr bool has_body = detail::present<Body>;
  static constexpr bool has_rods = detail::present<Rods>;

  using Effects = typename detail::WithBeads<of_role_t<role::Effect, Parts...>, has_rods>::type;
  static_assert(detail::check_effects(Effects{}));

  using Policies = join_t<typename detail::LeavesOf<Parts>::type...>;
  using Mpm = detail::MpmStages<Body, Effects>;
  using Substep = typename detail::PipelineOf<
      join_t<typename Mpm::Before, typename detail::RodStages<Rods, Effects>::type,
             typename Mpm::After>>::type;
  using NodeFields = on_t<stored_t<typename Substep::AllFields>, Nodes>;
  using StateFields = union_t<EnvironmentFields, typename detail::ParameterFields<Policies>::type,
                              typename detail::StateOf<typename Substep::AllFields>::type>;
  static_assert(Substep::template flows<StateFields>);
};

}  // namespace mpmpbd
