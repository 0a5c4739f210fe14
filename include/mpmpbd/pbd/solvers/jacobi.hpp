// XPBD by Jacobi with mass splitting: all constraints see the same beads and frames.
#pragma once

#include <mpmpbd/pbd/project.hpp>

namespace mpmpbd {

// Scratch of the Jacobi solver.
namespace bead {
struct Correction : Scratch<"dx", "m", Vector, Beads> {};  // sum of what the constraints ask for
struct Share : Scratch<"n", "1", Number, Beads> {};        // constraints that act on the bead
}  // namespace bead
namespace frame {
struct Correction : Scratch<"dq", "rad", Vector, Frames> {};
struct Share : Scratch<"n", "1", Number, Frames> {};
}  // namespace frame

namespace detail {
template <class Unknown> struct Split {
  using Correction = bead::Correction;
  using Share = bead::Share;
};
template <> struct Split<unknown::Orientation> {
  using Correction = frame::Correction;
  using Share = frame::Share;
};
}  // namespace detail

// A bead with n constraints is split into n of mass m/n, one for each, and joined again by averaging
// (Tonge et al. 2012): momentum is kept and no sum of corrections overshoots, whatever n is. Frames alike.
// The sum at a bead is taken in the order of kinds and colours, so the bits do not depend on lanes.
// Limits: converges slower than Gauss-Seidel, about half as fast along a thread.
template <int iterations_> struct Jacobi {
  using Role = role::Solver;
  static constexpr FixedString name = "XPBD, Jacobi with mass splitting";
  static constexpr int iterations = iterations_;
  template <class Set>
  using ScratchFields = union_t<
      Fields<bead::Correction, bead::Share>,
      std::conditional_t<Set::has_frames, Fields<frame::Correction, frame::Share>, Fields<>>>;

  template <class Set, class Team, class Env, class T, class... Cs>
  MPMPBD_HD static std::uint32_t begin(Team const& team, Env const& env, Tick<T> const&,
                                       TypeList<Cs...>) {
    clear<unknown::Point>(team, env);
    if constexpr (Set::has_frames) clear<unknown::Orientation>(team, env);
    team.sync();
    (count<Cs>(team, env), ...);
    return 0;
  }

  template <class Set, class Team, class Env, class T, class... Cs>
  MPMPBD_HD static std::uint32_t iterate(Team const& team, Env const& env, Tick<T> const& tick,
                                         TypeList<Cs...>) {
    (collect<Cs>(team, env, tick.dt * tick.dt), ...);
    join<unknown::Point>(team, env);
    if constexpr (Set::has_frames) join<unknown::Orientation>(team, env);
    team.sync();
    return 0;
  }

 private:
  template <class U> using Correction = typename detail::Split<U>::Correction;
  template <class U> using Share = typename detail::Split<U>::Share;

  template <class U, class Team, class Env>
  MPMPBD_HD static void clear(Team const& team, Env const& env) {
    using T = typename Env::Scalar;
    detail::each(team, env.template live<typename Kept<U>::Domain>(), [&](std::int64_t i) {
      env.template set<Share<U>>(i, T(0));
      env.template set<Correction<U>>(i, Vec3<T>{});
    });
  }
  template <class U, class Team, class Env>
  MPMPBD_HD static void join(Team const& team, Env const& env) {
    using T = typename Env::Scalar;
    detail::each(team, env.template live<typename Kept<U>::Domain>(), [&](std::int64_t i) {
      detail::displace(env, U{}, i, env.template get<Correction<U>>(i));
      env.template set<Correction<U>>(i, Vec3<T>{});
    });
  }
  template <class C, class Team, class Env>
  MPMPBD_HD static void count(Team const& team, Env const& env) {
    using T = typename Env::Scalar;
    detail::for_each_colour<C>(team, env, [&](std::int64_t slot) {
      auto const slots = detail::slots_of<C>(env, slot);
      detail::for_each_kept<C>([&]<class U, class I>(U, I) {
        auto const at = slots[I::value];
        env.template set<Share<U>>(at, env.template get<Share<U>>(at) + T(1));
      });
    });
  }
  template <class C, class Team, class Env, class T>
  MPMPBD_HD static void collect(Team const& team, Env const& env, T dt2) {
    detail::for_each_colour<C>(team, env, [&](std::int64_t slot) {
      auto one = detail::load_instance<C>(env, slot);
      auto split = one;
      detail::for_each_kept<C>([&]<class U, class I>(U, I) {
        split.weights[I::value] *= env.template get<Share<U>>(one.slots[I::value]);
      });
      auto const d = detail::correction<C>(split, dt2);
      // Each part moves n times as far as the whole bead would; their average is the whole bead's share.
      detail::for_each_displacement<C>(
          one, d, dt2, [&]<class U>(U, std::int64_t at, Vec3<T> const& move) {
            env.template set<Correction<U>>(at, env.template get<Correction<U>>(at) + move);
          });
      set_vector<typename instance<C>::Multiplier>(env, slot, one.multiplier + d);
    });
  }
};

}  // namespace mpmpbd
