// XPBD by coloured Gauss-Seidel: each constraint sees beads and frames as the one before left them.
#pragma once

#include <mpmpbd/pbd/project.hpp>

namespace mpmpbd {

// Kinds in the order of the set, colours within a kind; the colours make the order, so the bits do not
// depend on how many lanes share a colour. Compliance 0 is PBD (Mueller et al. 2007), otherwise XPBD
// (Macklin et al. 2016) with alpha/dt^2. Multipliers start from 0 in every substep.
// Limits: a change travels one segment per iteration and colour, so a long thread needs many
// iterations (or small steps, or DirectBanded) to be as stiff as its material, most of all in bending.
template <int iterations_> struct Xpbd {
  using Role = role::Solver;
  static constexpr FixedString name = "XPBD, Gauss-Seidel by colours";
  static constexpr int iterations = iterations_;
  template <class Set> using ScratchFields = Fields<>;

  template <class Set, class Team, class Env, class T, class... Cs>
  MPMPBD_HD static std::uint32_t iterate(Team const& team, Env const& env, Tick<T> const& tick,
                                         TypeList<Cs...>) {
    (sweep<Cs>(team, env, tick.dt * tick.dt), ...);
    return 0;
  }

 private:
  template <class C, class Team, class Env, class T>
  MPMPBD_HD static void sweep(Team const& team, Env const& env, T dt2) {
    detail::for_each_colour<C>(team, env, [&](std::int64_t slot) {
      auto const one = detail::load_instance<C>(env, slot);
      auto const d = detail::correction<C>(one, dt2);
      detail::for_each_displacement<C>(one, d, dt2,
                                       [&](auto kind, std::int64_t at, Vec3<T> const& move) {
                                         detail::displace(env, kind, at, move);
                                       });
      set_vector<typename instance<C>::Multiplier>(env, slot, one.multiplier + d);
    });
  }
};

// XPBD as it is usually written: one iteration, many substeps. At equal cost a thread stretches far less
// than with many iterations (Macklin et al. 2019, "Small steps in physics simulation").
template <int substeps_> struct SmallSteps : Xpbd<1> {
  static_assert(substeps_ >= 1,
                "mpmpbd SmallSteps<n>: give at least one substep, for example SmallSteps<20>");
  static constexpr FixedString name = "small steps, one Gauss-Seidel iteration each";
  static constexpr int substeps = substeps_;
};

}  // namespace mpmpbd
