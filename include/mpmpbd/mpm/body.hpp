// An MPM body: material, shape function, transfer scheme and force form, by role and in any order.
#pragma once

#include <mpmpbd/mpm/concepts.hpp>
#include <mpmpbd/mpm/force_form.hpp>
#include <mpmpbd/mpm/shape/bspline.hpp>
#include <mpmpbd/mpm/transfer/apic.hpp>

namespace mpmpbd {

namespace detail {
template <class P> struct Spread { using type = TypeList<P>; };
template <class... Ps> struct Spread<Bundle<Ps...>> { using type = TypeList<Ps...>; };
template <class... Ps> using spread_t = join_t<typename Spread<Ps>::type...>;

struct NoMaterial {
  using Role = role::Material;
  using Reads = Fields<>;
  using Writes = Fields<>;
};

template <class List> struct MpmPolicies;
template <class... Ps> struct MpmPolicies<TypeList<Ps...>> {
  template <class Role> static constexpr int count = count_role<Role, Ps...>;
  static_assert(count<role::Material> > 0,
                "mpmpbd Mpm<...>: no material given; add one, for example Mpm<NeoHookean>");
  static_assert(
      count<role::Material> < 2,
      "mpmpbd Mpm<...>: more than one material given; a body has one, write PerParticle<Material> for parameters that vary inside it");
  static_assert(count<role::Transfer> < 2,
                "mpmpbd Mpm<...>: more than one transfer scheme given; keep one of them");
  static_assert(count<role::Shape> < 2,
                "mpmpbd Mpm<...>: more than one shape function given; keep one of them");
  static_assert(count<role::Form> < 2,
                "mpmpbd Mpm<...>: more than one force form given; keep one of them");
  static_assert(
      count<role::Material> + count<role::Transfer> + count<role::Shape> + count<role::Form> ==
          sizeof...(Ps),
      "mpmpbd Mpm<...>: takes a material, a shape function, a transfer scheme and a force form; effects, rods and couplings belong to the Scene");

  using Material = pick_t<role::Material, NoMaterial, Ps...>;
  using Shape = pick_t<role::Shape, QuadraticBSpline, Ps...>;
  using Transfer = pick_t<role::Transfer, Apic, Ps...>;
  using Form =
      pick_t<role::Form, std::conditional_t<(Shape::inverse_inertia > 0.0), Mls, WeightGradient>,
             Ps...>;

  static_assert(std::is_same_v<Material, NoMaterial> || check_material<Material>());
  static_assert(
      ShapeFunction<Shape>,
      "mpmpbd ShapeFunction: give width, offset, inverse_inertia, weight(i, f), slope(i, f) and moment(i, f)");
  static_assert(
      TransferScheme<Transfer>,
      "mpmpbd TransferScheme: give carries_affine, needs_moment, needs_slope, needs_previous_grid and `finish(p, gathered, k)`, using only declared fields");
  static_assert(ForceForm<Form>, "mpmpbd ForceForm: give `static constexpr bool uses_moment`");
  static_assert(
      Shape::inverse_inertia > 0.0 || !Form::uses_moment,
      "mpmpbd Mpm<...>: MLS forces need a shape function with constant inertia; write QuadraticBSpline or CubicBSpline, or take the force form WeightGradient");
  static_assert(
      Shape::inverse_inertia > 0.0 || !Transfer::needs_slope,
      "mpmpbd Mpm<...>: TPIC needs a shape function with continuous slope; write QuadraticBSpline or CubicBSpline, or take PIC, FLIP or APIC");
};
}  // namespace detail

// A deformable body of material points. Defaults: quadratic B-spline, APIC, MLS forces (weight
// gradient for the linear shape).
template <class... Policies> struct Mpm {
  using Role = role::Mpm;
  using Composition = detail::MpmPolicies<detail::spread_t<Policies...>>;
  using Material = typename Composition::Material;
  using Shape = typename Composition::Shape;
  using Transfer = typename Composition::Transfer;
  using Form = typename Composition::Form;
  using Leaves = TypeList<Material, Shape, Transfer, Form>;

  // What a gather computes. Without constant inertia the moment is the slope.
  static constexpr bool needs_moment = Transfer::needs_moment || Form::uses_moment;
  static constexpr bool needs_slope = Transfer::needs_slope || !Form::uses_moment ||
                                      (needs_moment && !(Shape::inverse_inertia > 0.0));
};

}  // namespace mpmpbd
