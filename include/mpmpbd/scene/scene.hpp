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

// What stands between grid and gather: the coupling's stages, or the rods alone.
template <class In, bool coupled> struct BodyStages { using type = TypeList<>; };
template <class In> struct BodyStages<In, true> {
  using type = typename In::Coupling::Strategy::template Stages<In>;
};
template <class In>
  requires(In::has_rods)
struct BodyStages<In, false> {
  using type = TypeList<MoveRods<typename In::Rods, typename In::Effects>>;
};

// Effects of a scene, and the other parts of those that act on beads and a free needle too, where there are any.
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
template <class Effects, class Needle> struct WithNeedle { using type = Effects; };
template <class E> struct OnNeedleOf { using type = TypeList<>; };
template <class E>
  requires requires { typename E::OnNeedle; }
struct OnNeedleOf<E> {
  using type = TypeList<typename E::OnNeedle>;
};
template <class... Es, class Needle>
  requires(Needle::is_dynamic)
struct WithNeedle<TypeList<Es...>, Needle> {
  using type = join_t<TypeList<Es...>, typename OnNeedleOf<Es>::type...>;
};

// What a coupling asks of the tissue by effects of its own; they act after those of the scene.
template <class C> struct EffectsOf { using type = TypeList<>; };
template <class C>
  requires requires { typename C::Effects; }
struct EffectsOf<C> {
  using type = typename C::Effects;
};

// Stored fields that outlive a substep: all but those of the grid, which is scratch.
template <class F>
struct Outlives : std::bool_constant<F::stored && !std::is_same_v<typename F::Domain, Nodes>> {};
template <class List> struct StateOf : Filter<Fields<>, Outlives, List> {};

// Whether effects that read C find it written.
template <class E>
inline constexpr bool needs_affine = [] {
  if constexpr (requires { E::needs_affine; })
    return bool(E::needs_affine);
  else
    return false;
}();
template <class Body, class Effects> inline constexpr bool affine_where_needed = true;
template <class Body, class... Es>
  requires(present<Body>)
inline constexpr bool affine_where_needed<Body, TypeList<Es...>> =
    Body::Transfer::carries_affine || !(needs_affine<Es> || ...);

template <class List> struct PipelineOf;
template <class... Ss> struct PipelineOf<TypeList<Ss...>> { using type = Pipeline<Ss...>; };

template <class... Es> consteval bool check_effects(TypeList<Es...>) {
  return (check_effect<Es>() && ... && true);
}
}  // namespace detail

// The parts of a scene by role, as stages are told of them.
template <class Body_, class Rods_, class Needle_, class Surface_, class Coupling_, class Effects_>
struct SceneParts {
  using Body = Body_;
  using Rods = Rods_;
  using Needle = Needle_;
  using Surface = Surface_;
  using Coupling = Coupling_;
  using Effects = Effects_;
  static constexpr bool has_body = detail::present<Body>;
  static constexpr bool has_rods = detail::present<Rods>;
  static constexpr bool has_needle = detail::present<Needle>;
  static constexpr bool has_surface = detail::present<Surface>;
  static constexpr bool has_coupling = detail::present<Coupling>;
};

// State that every environment has.
using EnvironmentFields =
    Fields<environment::Status, environment::FaultCount, environment::Step, environment::Time,
           environment::Substeps, environment::Dt, environment::DtLimit, environment::DtBound,
           environment::HeldLimits, environment::CalmSteps, environment::Seed,
           environment::Episode>;

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

  static_assert(detail::count_role<role::Coupling, Parts...> < 2,
                "mpmpbd Scene<...>: more than one Coupling given; keep one strategy");
  static_assert(detail::count_role<role::Needle, Parts...> < 2,
                "mpmpbd Scene<...>: more than one needle given; a scene has one");

  using Body = pick_t<role::Mpm, detail::Absent, Parts...>;
  using Rods = pick_t<role::Pbd, detail::Absent, Parts...>;
  using Needle = pick_t<role::Needle, detail::Absent, Parts...>;
  using Surface = pick_t<role::Surface, detail::Absent, Parts...>;
  using Coupling = pick_t<role::Coupling, detail::Absent, Parts...>;
  static constexpr bool has_body = detail::present<Body>;
  static constexpr bool has_rods = detail::present<Rods>;
  static constexpr bool has_needle = detail::present<Needle>;
  static constexpr bool has_coupling = detail::present<Coupling>;

  static_assert(!has_coupling || has_body,
                "mpmpbd Scene<...>: a coupling given but no tissue; add a body, for example "
                "Mpm<NeoHookean>, or take the coupling out");
  static_assert(!has_coupling || has_rods || has_needle,
                "mpmpbd Scene<...>: a coupling given but neither threads nor needle; add "
                "Pbd<Constraints<Distance>> or ArcNeedle, or take the coupling out");
  static_assert(!(has_needle && !has_coupling),
                "mpmpbd Scene<...>: a needle given but no coupling, so it would touch nothing; add "
                "Coupling<Embedded>");
  static_assert(
      !(has_body && has_rods && !has_coupling),
      "mpmpbd Scene<...>: tissue and threads given but no coupling, so they would pass through "
      "each other; add Coupling<Embedded>");
  static_assert(
      !detail::present<Surface> || has_needle,
      "mpmpbd Scene<...>: a surface given but no needle to puncture it; add ArcNeedle, or take "
      "the surface out");

  using Effects =
      join_t<typename detail::WithNeedle<
                 typename detail::WithBeads<of_role_t<role::Effect, Parts...>, has_rods>::type,
                 Needle>::type,
             typename detail::EffectsOf<Coupling>::type>;
  static_assert(detail::check_effects(Effects{}));
  using In = SceneParts<Body, Rods, Needle, Surface, Coupling, Effects>;
  static_assert(
      detail::affine_where_needed<Body, Effects>,
      "mpmpbd Scene<...>: an effect reads the affine velocity C, which PIC and FLIP do not carry; take "
      "Apic or Tpic, or leave the effect out");

  // The scene as its stages know it: one type for it and for all that derive from it and store more.
  using Stepped = Scene;
  using Policies = join_t<typename detail::LeavesOf<Parts>::type...>;
  using Physics = Policies;  // those whose numbers a step needs, also where a task stores more
  using Mpm = detail::MpmStages<Body, Effects>;
  using Substep = typename detail::PipelineOf<
      join_t<typename Mpm::Before, typename detail::BodyStages<In, has_coupling>::type,
             typename Mpm::After>>::type;
  using NodeFields = on_t<stored_t<typename Substep::AllFields>, Nodes>;
  using StateFields = union_t<EnvironmentFields, typename detail::ParameterFields<Policies>::type,
                              typename detail::StateOf<typename Substep::AllFields>::type>;
  static_assert(Substep::template flows<StateFields>);
};

}  // namespace mpmpbd
