// XPBD by Jacobi with mass splitting: all constraints see the same beads.
#pragma once

#include <mpmpbd/pbd/project.hpp>

namespace mpmpbd {

// Scratch of the Jacobi solver.
namespace bead {
struct Correction : Scratch<"dx", "m", Vector, Beads> {};  // sum of what the constraints ask for
struct Share : Scratch<"n", "1", Number, Beads> {};        // constraints that act on the bead
}  // namespace bead

// A bead with n constraints is split into n of mass m/n, one for each, and joined again by averaging
// (Tonge et al. 2012): momentum is kept and no sum of corrections overshoots, whatever n is.
// The sum at a bead is taken in the order of kinds and colours, so the bits do not depend on lanes.
// Limits: converges slower than Gauss-Seidel, about half as fast along a thread.
template <int iterations_> struct Jacobi {
  using Role = role::Solver;
  static constexpr FixedString name = "XPBD, Jacobi with mass splitting";
  static constexpr int iterations = iterations_;
  template <class Set> using ScratchFields = Fields<bead::Correction, bead::Share>;

  template <class Set, class Team, class Env, class T, class... Cs>
  MPMPBD_HD static std::uint32_t begin(Team const& team, Env const& env, Tick<T> const&,
                                       TypeList<Cs...>) {
    detail::each(team, env.template live<Beads>(), [&](std::int64_t b) {
      env.template set<bead::Share>(b, T(0));
      env.template set<bead::Correction>(b, Vec3<T>{});
    });
    team.sync();
    (count<Cs>(team, env), ...);
    return 0;
  }

  template <class Set, class Team, class Env, class T, class... Cs>
  MPMPBD_HD static std::uint32_t iterate(Team const& team, Env const& env, Tick<T> const& tick,
                                         TypeList<Cs...>) {
    (collect<Cs>(team, env, tick.dt * tick.dt), ...);
    detail::each(team, env.template live<Beads>(), [&](std::int64_t b) {
      env.template set<bead::Position>(
          b, env.template get<bead::Position>(b) + env.template get<bead::Correction>(b));
      env.template set<bead::Correction>(b, Vec3<T>{});
    });
    team.sync();
    return 0;
  }

 private:
  template <class C, class Team, class Env>
  MPMPBD_HD static void count(Team const& team, Env const& env) {
    using T = typename Env::Scalar;
    detail::for_each_colour<C>(team, env, [&](std::int64_t slot) {
      auto const beads = get_vector<typename instance<C>::Index>(env, slot);
      for (int i = 0; i < point_count<C>; ++i)
        env.template set<bead::Share>(beads[i], env.template get<bead::Share>(beads[i]) + T(1));
    });
  }
  template <class C, class Team, class Env, class T>
  MPMPBD_HD static void collect(Team const& team, Env const& env, T dt2) {
    detail::for_each_colour<C>(team, env, [&](std::int64_t slot) {
      auto one = detail::load_instance<C>(env, slot);
      auto split = one;
      for (int i = 0; i < point_count<C>; ++i)
        split.weights[i] *= env.template get<bead::Share>(one.beads[i]);
      auto const d = detail::correction<C>(split, dt2);
      // Each part moves n times as far as the whole bead would; their average is the whole bead's share.
      detail::for_each_displacement<C>(one, d, dt2, [&](std::int64_t b, Vec3<T> const& move) {
        env.template set<bead::Correction>(b, env.template get<bead::Correction>(b) + move);
      });
      set_vector<typename instance<C>::Multiplier>(env, slot, one.multiplier + d);
    });
  }
};

}  // namespace mpmpbd
