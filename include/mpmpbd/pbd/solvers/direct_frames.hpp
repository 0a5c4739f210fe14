// All constraints of threads with frames at once, by one banded elimination.
#pragma once

#include <mpmpbd/core/status.hpp>
#include <mpmpbd/pbd/project.hpp>
#include <mpmpbd/pbd/solvers/band.hpp>

namespace mpmpbd {

namespace detail {
// A segment and its frame (StretchShear), and the joint between two frames (BendTwist), as DirectFrames takes them.
template <class C>
inline constexpr bool is_framed_segment =
    std::is_same_v<typename C::Unknowns,
                   TypeList<unknown::Point, unknown::Point, unknown::Orientation>>&& C::dimension ==
        3 &&
    C::kind == ConstraintKind::equality;
template <class C>
inline constexpr bool is_framed_joint =
    std::is_same_v<typename C::Unknowns, TypeList<unknown::Orientation, unknown::Orientation>>&&
            C::dimension == 3 &&
    C::kind == ConstraintKind::equality;
}  // namespace detail

// The linear system of threads with frames. Along a thread the nodes are bead, frame, bead, frame, ...: node 2 b is bead
// b, node 2 b + 1 the frame of the segment that starts there. Its rows are segment, joint, segment, joint, ..., of three
// numbers each: row r acts on nodes r, r + 1 and r + 2, so that it shares a node with the two rows before it.
struct FrameChain {
  static constexpr int rows = 6;  // of a bead: the segment that starts there, the joint at its end
  static constexpr int half_band = 8;

  struct Band : Scratch<"band", "1", Numbers<rows*(half_band + 1)>, Beads> {};
  template <int row>
  struct Gradient : Scratch<"grad", "1", Numbers<3, 9>, Beads> {};  // by its nodes
  struct Right : Scratch<"r", "1", Numbers<rows>, Beads> {
  };  // -(C + alpha f), then the change of f
  struct Alpha : Scratch<"alpha", "1", Numbers<rows>, Beads> {};  // compliance; -1: no such row
  struct FrameOf : Scratch<"frame", "1", Integer, Beads> {
  };  // of the segment that starts here; -1: none
  struct BeadOf : Scratch<"bead", "1", Integer, Frames> {
  };  // where its segment starts; -1: nowhere
  using ScratchFields = Fields<Band, Gradient<0>, Gradient<1>, Right, Alpha, FrameOf, BeadOf>;
};

// Newton steps on (grad W grad^T + alpha/dt^2) dlambda = -(C + alpha/dt^2 lambda) for all segments and joints of a
// thread together: bending and twist are as stiff as the material, whatever the number of segments. Beads and frames
// follow each other in number along a thread; several threads are several blocks of the same band.
// Limits: StretchShear and BendTwist of open threads only. Forces act along the directions in which they were found,
// without the layout of DirectBanded: keep h^2 T/(m l) below 1/3 (T tension, m bead mass, l segment), above it a taut
// thread gains energy. Frames that turn by more than a radian per substep need more iterations.
// A step is kept to turns of a radian. Fault::solver is set when a row lost its pivot, a joint has no segments that
// follow each other, or a constraint is left with an error that stands for a tenth of a radian.
template <int iterations_ = 2> struct DirectFrames {
  using Role = role::Solver;
  static constexpr FixedString name = "XPBD, direct with frames";
  static constexpr int iterations = iterations_;
  static constexpr bool needs_chain = true;
  template <class C>
  static constexpr bool takes = detail::is_framed_segment<C> || detail::is_framed_joint<C>;
  template <class Set> using ScratchFields = FrameChain::ScratchFields;

  template <class Set, class Team, class Env, class T, class... Cs>
  MPMPBD_HD static std::uint32_t begin(Team const& team, Env const& env, Tick<T> const&,
                                       TypeList<Cs...>) {
    detail::each(team, env.template live<Beads>(),
                 [&](std::int64_t b) { env.template set<FrameChain::FrameOf>(b, -1); });
    detail::each(team, env.template live<Frames>(),
                 [&](std::int64_t f) { env.template set<FrameChain::BeadOf>(f, -1); });
    team.sync();
    (number<Cs>(team, env), ...);
    return 0;
  }

  template <class Set, class Team, class Env, class T, class... Cs>
  MPMPBD_HD static std::uint32_t iterate(Team const& team, Env const& env, Tick<T> const& tick,
                                         TypeList<Cs...>) {
    T const dt2 = tick.dt * tick.dt;
    std::uint32_t faults = 0;
    clear(team, env);
    ((faults |= evaluate<Cs>(team, env)), ...);
    assemble(team, env, dt2);
    team.one([&] {
      bool const whole =
          detail::eliminate_band<FrameChain::Band, FrameChain::rows, FrameChain::half_band>(
              env, [&](std::int64_t b) { return env.template get<FrameChain::Right>(b); },
              [&](std::int64_t b, auto const& r) { env.template set<FrameChain::Right>(b, r); });
      if (!whole || !shorten(env, dt2)) faults |= static_cast<std::uint32_t>(Fault::solver);
    });
    team.sync();
    (add_multipliers<Cs>(team, env), ...);
    displace_all(team, env, dt2);
    return faults;
  }

  // Nothing is lost silently: says so when the iterations did not solve the thread.
  template <class Set, class Team, class Env, class T, class... Cs>
  MPMPBD_HD static std::uint32_t end(Team const& team, Env const& env, Tick<T> const&,
                                     TypeList<Cs...>) {
    return (unsolved<Cs>(team, env) | ... | 0u);
  }

 private:
  // Finds the frame of each segment, and the segment of each frame.
  template <class C, class Team, class Env>
  MPMPBD_HD static void number(Team const& team, Env const& env) {
    if constexpr (detail::is_framed_segment<C>)
      detail::for_each_instance<C>(team, env, [&](std::int64_t slot) {
        auto const at = detail::slots_of<C>(env, slot);
        env.template set<FrameChain::FrameOf>(at[0], at[2]);
        env.template set<FrameChain::BeadOf>(at[2], at[0]);
      });
  }

  template <class Team, class Env> MPMPBD_HD static void clear(Team const& team, Env const& env) {
    using T = typename Env::Scalar;
    detail::each(team, env.template live<Beads>(), [&](std::int64_t b) {
      Vec<T, FrameChain::rows> none{};
      env.template set<FrameChain::Gradient<0>>(b, {});
      env.template set<FrameChain::Gradient<1>>(b, {});
      env.template set<FrameChain::Right>(b, none);
      for (int i = 0; i < FrameChain::rows; ++i) none[i] = T(-1);
      env.template set<FrameChain::Alpha>(b, none);
    });
    team.sync();
  }

  // The bead whose rows an instance has; -1 when its frames do not follow each other along a thread.
  template <class C, class Env, class Slots>
  MPMPBD_HD static std::int64_t bead_of(Env const& env, Slots const& slots) {
    if constexpr (detail::is_framed_segment<C>) {
      return slots[0];
    } else {
      auto const b = env.template get<FrameChain::BeadOf>(slots[0]);
      return b >= 0 && env.template get<FrameChain::FrameOf>(b + 1) == slots[1] ? b : -1;
    }
  }
  // The gradient blocks of an instance side by side, in the order of the nodes.
  template <class C, class T> MPMPBD_HD static Mat<T, 3, 9> by_nodes(Evaluation<C, T> const& e) {
    Mat<T, 3, 9> all{};
    for (int i = 0; i < 9; ++i) {
      all[i] = gradient<0>(e)[i];
      if constexpr (detail::is_framed_segment<C>) {
        all[9 + i] = gradient<2>(e)[i];
        all[18 + i] = gradient<1>(e)[i];
      } else {
        all[18 + i] = gradient<1>(e)[i];
      }
    }
    return all;
  }

  template <class C, class Team, class Env>
  MPMPBD_HD static std::uint32_t evaluate(Team const& team, Env const& env) {
    using T = typename Env::Scalar;
    constexpr int row = detail::is_framed_segment<C> ? 0 : 1;
    std::uint32_t faults = 0;
    detail::for_each_instance<C>(team, env, [&](std::int64_t slot) {
      auto const one = detail::load_instance<C>(env, slot);
      auto const b = bead_of<C>(env, one.slots);
      if (b < 0) {
        faults |= static_cast<std::uint32_t>(Fault::solver);
        return;
      }
      env.template set<FrameChain::Gradient<row>>(b, by_nodes<C, T>(one.at));
      auto right = env.template get<FrameChain::Right>(b);
      auto alpha = env.template get<FrameChain::Alpha>(b);
      auto const stretch = detail::scaled(one.compliance, one.multiplier);
      auto const compliance = detail::scaled(one.compliance, Vec3<T>{{T(1), T(1), T(1)}});
      for (int i = 0; i < 3; ++i) {
        right[3 * row + i] = -(one.at.value[i] + stretch[i]);
        alpha[3 * row + i] = compliance[i];
      }
      env.template set<FrameChain::Right>(b, right);
      env.template set<FrameChain::Alpha>(b, alpha);
    });
    return faults;
  }

  // 1/m of a bead or 1/I of a frame, 0 where there is none.
  template <class Env> MPMPBD_HD static auto mobility(Env const& env, std::int64_t node) {
    using T = typename Env::Scalar;
    if (node >= 2 * env.template live<Beads>()) return T(0);
    if (node % 2 == 0) return env.template get<bead::InverseMass>(node / 2);
    auto const f = env.template get<FrameChain::FrameOf>(node / 2);
    return f >= 0 ? env.template get<frame::InverseInertia>(f) : T(0);
  }
  template <class Env> MPMPBD_HD static auto gradient_of(Env const& env, std::int64_t row) {
    return row % 2 == 0 ? env.template get<FrameChain::Gradient<0>>(row / 2)
                        : env.template get<FrameChain::Gradient<1>>(row / 2);
  }
  template <class T> MPMPBD_HD static Mat3<T> block(Mat<T, 3, 9> const& g, std::int64_t node) {
    Mat3<T> b;
    for (int i = 0; i < 9; ++i) b[i] = g[static_cast<int>(9 * node) + i];
    return b;
  }

  template <class Team, class Env, class T>
  MPMPBD_HD static void assemble(Team const& team, Env const& env, T dt2) {
    detail::each(team, env.template live<Beads>(), [&](std::int64_t b) {
      value_t<FrameChain::Band, T> band{};
      auto const alpha = env.template get<FrameChain::Alpha>(b);
      for (int s = 0; s < 2; ++s)
        for (int back = 0; back < 3 && 2 * b + s >= back; ++back)
          put(band, s, back, dt2 * coupling(env, 2 * b + s, back));
      for (int i = 0; i < FrameChain::rows; ++i) {
        T& diagonal = band[i * (FrameChain::half_band + 1)];
        diagonal = alpha[i] < T(0) ? T(1) : diagonal + alpha[i];
      }
      env.template set<FrameChain::Band>(b, band);
    });
    team.sync();
  }
  // Sum over shared nodes of w grad_r grad_s^T, for rows r and s = r - back.
  template <class Env>
  MPMPBD_HD static auto coupling(Env const& env, std::int64_t r, std::int64_t back) {
    using T = typename Env::Scalar;
    auto const upper = gradient_of(env, r - back), lower = gradient_of(env, r);
    Mat3<T> sum{};
    for (std::int64_t k = 0; k + back < 3; ++k)
      sum += mobility(env, r + k) * (block(lower, k) * transpose(block(upper, k + back)));
    return sum;
  }
  template <class Band, class T>
  MPMPBD_HD static void put(Band& band, int s, int back, Mat3<T> const& a) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        int const before = 3 * back + i - j;
        if (before >= 0) band[(3 * s + i) * (FrameChain::half_band + 1) + before] = a(i, j);
      }
  }

  // How far the changes of the multipliers move a bead [m] or turn a frame [rad].
  template <class Env, class T>
  MPMPBD_HD static Vec3<T> displacement(Env const& env, std::int64_t node, T dt2) {
    Vec3<T> sum{};
    for (std::int64_t k = 0; k < 3 && node >= k; ++k) {
      auto const r = env.template get<FrameChain::Right>((node - k) / 2);
      int const from = (node - k) % 2 == 0 ? 0 : 3;
      sum +=
          transpose(block(gradient_of(env, node - k), k)) * vec(r[from], r[from + 1], r[from + 2]);
    }
    return (dt2 * mobility(env, node)) * sum;
  }
  // Shortens a step in which a frame turns by more than a radian; false when it is not finite, and left out.
  template <class Env, class T> MPMPBD_HD static bool shorten(Env const& env, T dt2) {
    T most = T(1);
    bool finite = true;
    for (std::int64_t node = 0; node < 2 * env.template live<Beads>(); ++node) {
      T const size = norm(displacement(env, node, dt2));
      finite = finite && is_finite(size);
      if (node % 2 == 1) most = max(most, size);
    }
    if (finite && most == T(1)) return true;
    for (std::int64_t b = 0; b < env.template live<Beads>(); ++b) {
      auto r = env.template get<FrameChain::Right>(b);
      env.template set<FrameChain::Right>(b, finite ? T(1) / most * r : decltype(r){});
    }
    return finite;
  }

  template <class C, class Team, class Env>
  MPMPBD_HD static void add_multipliers(Team const& team, Env const& env) {
    constexpr int from = detail::is_framed_segment<C> ? 0 : 3;
    detail::for_each_instance<C>(team, env, [&](std::int64_t slot) {
      auto const b = bead_of<C>(env, detail::slots_of<C>(env, slot));
      if (b < 0) return;
      auto const r = env.template get<FrameChain::Right>(b);
      env.template set<typename instance<C>::Multiplier>(
          slot, env.template get<typename instance<C>::Multiplier>(slot) +
                    vec(r[from], r[from + 1], r[from + 2]));
    });
  }
  template <class Team, class Env, class T>
  MPMPBD_HD static void displace_all(Team const& team, Env const& env, T dt2) {
    detail::each(team, env.template live<Beads>(), [&](std::int64_t b) {
      if (env.template get<bead::InverseMass>(b) > T(0))
        detail::displace(env, unknown::Point{}, b, displacement(env, 2 * b, dt2));
      auto const f = env.template get<FrameChain::FrameOf>(b);
      if (f >= 0 && env.template get<frame::InverseInertia>(f) > T(0))
        detail::displace(env, unknown::Orientation{}, f, displacement(env, 2 * b + 1, dt2));
    });
    team.sync();
  }

  // Whether an instance of C is left with an error that a turn of a tenth of a radian would make.
  template <class C, class Team, class Env>
  MPMPBD_HD static std::uint32_t unsolved(Team const& team, Env const& env) {
    using T = typename Env::Scalar;
    std::uint32_t faults = 0;
    detail::for_each_instance<C>(team, env, [&](std::int64_t slot) {
      auto const one = detail::load_instance<C>(env, slot);
      if (norm(one.weights) == T(0)) return;
      T const error = norm(one.at.value + detail::scaled(one.compliance, one.multiplier));
      T const slope = norm(gradient<C::Unknowns::size - 1>(one.at));
      if (!(T(10) * error <= slope)) faults |= static_cast<std::uint32_t>(Fault::solver);
    });
    return faults;
  }
};

}  // namespace mpmpbd
