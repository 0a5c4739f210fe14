// Stages: the steps of a substep as types. The list that is checked and printed is the list that runs.
//
// A stage has a kind (what it runs over), Reads, Writes, the policies it is made of (for the plan) and
// one function `run`. The same text runs as loops on the CPU or inlined between two barriers of one
// kernel.
#pragma once

#include <mpmpbd/effects/concepts.hpp>
#include <mpmpbd/mpm/gather.hpp>
#include <mpmpbd/mpm/scatter.hpp>
#include <mpmpbd/scene/context.hpp>

namespace mpmpbd {

// What a stage runs over.
namespace kind {
struct Scatter {
  static constexpr FixedString name = "particles -> grid";
};  // run(p, sums, context)
struct NodeWise {
  static constexpr FixedString name = "grid";
};  // run(node, context)
struct Gather {
  static constexpr FixedString name = "grid -> particles";
};  // run(p, nodes, context)
struct Together {
  static constexpr FixedString name = "environment";
};  // run(team, env, context, grid)
// As many items of `Items` as count(env) says, each by itself, after the nodes have moved: a device spreads them over blocks.
struct ItemWise {
  static constexpr FixedString name = "item by item";
};  // run(env, item, context, grid)
}  // namespace kind

// Whether a stage concerns an environment as a whole: its coupling.
template <class Stage>
inline constexpr bool concerns_environment = std::is_same_v<typename Stage::Kind, kind::Together> ||
                                             std::is_same_v<typename Stage::Kind, kind::ItemWise>;

// Runs such a stage by one team. Returns the faults met.
template <class Stage, class Team_, class Env, class Ctx, class Grid>
MPMPBD_HD std::uint32_t run_by_team(Team_ const& team, Env const& env, Ctx const& context,
                                    Grid const& grid) {
  if constexpr (std::is_same_v<typename Stage::Kind, kind::ItemWise>) {
    team.each(Stage::count(env), [&](int i) { Stage::run(env, i, context, grid); });
    team.sync();
    return 0;
  } else {
    return Stage::run(team, env, context, grid);
  }
}
// Runs such stages one after the other. Returns the faults met.
template <class... Stages, class Team_, class Env, class Ctx, class Grid>
MPMPBD_HD std::uint32_t run_all_by_team(TypeList<Stages...>, Team_ const& team, Env const& env,
                                        Ctx const& context, Grid const& grid) {
  std::uint32_t faults = 0;
  ((faults |= run_by_team<Stages>(team, env, context, grid)), ...);
  return faults;
}

// Momentum of a node before it is divided by the mass: lives between scatter and node stage.
namespace node {
struct Momentum : Transient<"mv", "kg m/s", Vector, Nodes> {};
struct PreviousMomentum : Transient<"mv0", "kg m/s", Vector, Nodes> {};  // without internal forces
}  // namespace node

namespace detail {
template <Slot slot, class List> struct InSlot;
template <Slot slot, class... Es> struct InSlot<slot, TypeList<Es...>> {
  using type = join_t<std::conditional_t<Es::slot == slot, TypeList<Es>, TypeList<>>...>;
};
template <class List> struct ReadsOf;
template <class... Ps> struct ReadsOf<TypeList<Ps...>> {
  using type = union_t<typename Ps::Reads...>;
};
template <class List> struct WritesOf;
template <class... Ps> struct WritesOf<TypeList<Ps...>> {
  using type = union_t<typename Ps::Writes...>;
};

// Whether every policy of a list runs on packs: it says so by `branch_free = true`.
template <class P>
inline constexpr bool is_branch_free = [] {
  if constexpr (requires { P::branch_free; })
    return bool(P::branch_free);
  else
    return false;
}();
template <class List> inline constexpr bool all_branch_free = false;
template <class... Ps>
inline constexpr bool all_branch_free<TypeList<Ps...>> = (is_branch_free<Ps> && ... && true);

// Applies the effects of a list to one item, in the order of the scene.
template <class Item, class Ctx, class... Es>
MPMPBD_HD void apply_effects(TypeList<Es...>, Item& item, Ctx const& context) {
  (Es::apply(item, context.template of<parameter_owner_t<Es>>(), context.tick), ...);
}
}  // namespace detail

// The effects of one slot, in the order in which the scene names them.
template <Slot slot, class Effects> using in_slot_t = typename detail::InSlot<slot, Effects>::type;

template <class Body, class Effects> struct ParticlesToGrid {
  static constexpr FixedString name = "scatter";
  using Kind = kind::Scatter;
  using Material = typename Body::Material;
  using Before = in_slot_t<Slot::before_scatter, Effects>;
  using Parts =
      join_t<TypeList<Material>, Before,
             TypeList<typename Body::Transfer, typename Body::Form, typename Body::Shape>>;
  static constexpr bool branch_free = detail::all_branch_free<Parts>;
  // Whether an effect accelerates particles.
  static constexpr bool driven =
      contains<typename detail::WritesOf<Before>::type, particle::Acceleration>;
  using Reads = union_t<typename Material::Reads, typename detail::ReadsOf<Before>::type,
                        typename Scatter<Body>::Reads,
                        std::conditional_t<driven, Fields<particle::Acceleration>, Fields<>>>;
  using Writes = union_t<Fields<particle::Stress, node::Mass, node::Momentum>,
                         std::conditional_t<Body::Transfer::needs_previous_grid,
                                            Fields<node::PreviousMomentum>, Fields<>>,
                         typename detail::WritesOf<Before>::type>;

  template <class P, class Grid, class Ctx>
  MPMPBD_INLINE static std::uint32_t run(P& p, Grid const& sums, Ctx const& context) {
    std::uint32_t faults = 0;
    if constexpr (needs_positive_volume<Material>)
      if (any(!(determinant(p[particle::Deformation{}]) > typename P::Scalar(0))))
        faults |= static_cast<std::uint32_t>(Fault::inversion);
    p[particle::Stress{}] = Material::kirchhoff(p, context.template of<Material>());
    if constexpr (driven) p[particle::Acceleration{}] = Vec3<typename P::Scalar>{};
    detail::apply_effects(Before{}, p, context);
    return faults | Scatter<Body>::template run<driven>(p, sums, context.lattice, context.tick.dt);
  }
};

// Velocity from momentum, then forces, then boundaries.
template <class Body, class Effects> struct MoveNodes {
  static constexpr FixedString name = "momentum";
  using Kind = kind::NodeWise;
  using Forces = in_slot_t<Slot::on_grid, Effects>;
  using Boundary = in_slot_t<Slot::at_boundary, Effects>;
  using Parts = join_t<Forces, Boundary>;
  using Reads = union_t<Fields<node::Mass, node::Momentum>,
                        std::conditional_t<Body::Transfer::needs_previous_grid,
                                           Fields<node::PreviousMomentum>, Fields<>>,
                        typename detail::ReadsOf<Parts>::type>;
  using Writes = union_t<Fields<node::Velocity, node::Position>,
                         std::conditional_t<Body::Transfer::needs_previous_grid,
                                            Fields<node::PreviousVelocity>, Fields<>>,
                         typename detail::WritesOf<Parts>::type>;

  template <class Node, class Ctx> MPMPBD_INLINE static void run(Node& n, Ctx const& context) {
    using T = typename Node::Scalar;
    // No cut-off of light nodes, so that the result is the same at 1 m and at 1 mm; only where numbers
    // end, a node counts as empty: the weights of such a node are far below rounding.
    bool const empty = !(n[node::Mass{}] >= least_invertible<T>);
    T const inverse_mass = empty ? T(0) : T(1) / n[node::Mass{}];
    n[node::Velocity{}] = inverse_mass * n[node::Momentum{}];
    if constexpr (Body::Transfer::needs_previous_grid)
      n[node::PreviousVelocity{}] = inverse_mass * n[node::PreviousMomentum{}];
    if (empty) return;
    detail::apply_effects(Forces{}, n, context);
    detail::apply_effects(Boundary{}, n, context);
  }

  // Inverse mass [1/kg] of a moved node per axis: 0 where a boundary holds it. Only contact asks, and
  // only for the few nodes it touches, so it is found again there instead of stored for all.
  template <class T, class Ctx>
  MPMPBD_HD static Vec3<T> inverse_mass(Vec3<T> const& velocity, T mass, Vec3<T> const& position,
                                        Ctx const& context) {
    using Probe = union_t<Fields<node::Velocity, node::InverseMass, node::Mass, node::Position>,
                          typename detail::ReadsOf<Boundary>::type,
                          typename detail::WritesOf<Boundary>::type>;
    if (!(mass >= least_invertible<T>)) return Vec3<T>{};
    Local<T, Probe> n{};
    n[node::Velocity{}] = velocity;
    n[node::Mass{}] = mass;
    n[node::Position{}] = position;
    n[node::InverseMass{}] = {{1 / mass, 1 / mass, 1 / mass}};
    detail::apply_effects(Boundary{}, n, context);
    return n[node::InverseMass{}];
  }
};

template <class Body, class Effects> struct GridToParticles {
  static constexpr FixedString name = "gather";
  using Kind = kind::Gather;
  using Material = typename Body::Material;
  using After = in_slot_t<Slot::after_gather, Effects>;
  using Parts =
      join_t<TypeList<typename Body::Transfer, typename Body::Form, typename Body::Shape>, After>;
  static constexpr bool branch_free = detail::all_branch_free<join_t<TypeList<Material>, Parts>>;
  using Reads = union_t<Fields<node::Velocity>,
                        std::conditional_t<Body::Transfer::needs_previous_grid,
                                           Fields<node::PreviousVelocity>, Fields<>>,
                        typename Gather<Body>::Reads, typename Material::Reads,
                        typename detail::ReadsOf<After>::type>;
  using Writes = union_t<typename Gather<Body>::Writes, typename Material::Writes,
                         typename detail::WritesOf<After>::type>;

  template <class P, class Grid, class Ctx>
  MPMPBD_INLINE static std::uint32_t run(P& p, Grid const& nodes, Ctx const& context) {
    auto const faults = Gather<Body>::run(p, nodes, context.template of<typename Body::Transfer>(),
                                          context.lattice, context.tick.dt);
    if constexpr (requires {
                    Material::after_update(p, context.template of<Material>(), context.tick);
                  })
      Material::after_update(p, context.template of<Material>(), context.tick);
    detail::apply_effects(After{}, p, context);
    return faults;
  }
};

}  // namespace mpmpbd
