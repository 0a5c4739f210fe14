// The stage of a scene's threads when no coupling moves them: forces, predict, solve, finish.
#pragma once

#include <mpmpbd/needle/fields.hpp>
#include <mpmpbd/pbd/body.hpp>
#include <mpmpbd/scene/stage.hpp>

namespace mpmpbd {

namespace detail {
// Applies one effect to every item of a domain.
template <class Domain, class E, class Team, class Env, class Ctx>
MPMPBD_HD void apply_to_each(Team const& team, Env const& env, Ctx const& context) {
  using T = typename Env::Scalar;
  using Used = union_t<typename E::Reads, typename E::Writes>;
  team.each(static_cast<int>(env.template live<Domain>()), [&](std::int64_t i) {
    Local<T, Used> item;
    item.load(env, i, stored_t<Used>{});
    E::apply(item, context.template of<parameter_owner_t<E>>(), context.tick);
    item.store(env, i, stored_t<typename E::Writes>{});
  });
  team.sync();
}
template <class... Es, class Team, class Env, class Ctx>
MPMPBD_HD void apply_all_to_beads(TypeList<Es...>, Team const& team, Env const& env,
                                  Ctx const& context) {
  (apply_to_each<Beads, Es>(team, env, context), ...);
}
template <class... Es, class Team, class Env, class Ctx>
MPMPBD_HD void apply_all_to_needle(TypeList<Es...>, Team const& team, Env const& env,
                                   Ctx const& context) {
  (apply_to_each<Needles, Es>(team, env, context), ...);
}
}  // namespace detail

// Threads alone: the rod's own solver moves the beads, in as many substeps as it asks for.
template <class Rods, class Effects> struct MoveRods {
  static constexpr FixedString name = "rods";
  using Kind = kind::Together;
  using Forces = in_slot_t<Slot::before_solve, Effects>;
  using After = in_slot_t<Slot::after_solve, Effects>;
  using Parts = join_t<Forces, typename Rods::Leaves, After>;
  using Reads =
      union_t<typename Rods::Reads, typename detail::ReadsOf<join_t<Forces, After>>::type>;
  using Writes =
      union_t<typename Rods::Writes, typename detail::WritesOf<join_t<Forces, After>>::type>;

  template <class Team, class Env, class Ctx, class Grid>
  MPMPBD_HD static std::uint32_t run(Team const& team, Env const& env, Ctx const& context,
                                     Grid const&) {
    auto const forces = [&](Team const& lanes, Env const& rods, auto const& tick) {
      auto part = context;
      part.tick = tick;
      detail::apply_all_to_beads(Forces{}, lanes, rods, part);
    };
    auto const faults = Rods::step(team, env, context.tick, forces);
    detail::apply_all_to_beads(After{}, team, env, context);
    return faults;
  }
};

}  // namespace mpmpbd
