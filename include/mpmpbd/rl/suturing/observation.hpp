// What the agent sees of a stitch, group by group, in SI units; positions from the middle of the
// tissue's top at rest.
#pragma once

#include <mpmpbd/rl/suturing/progress.hpp>

namespace mpmpbd::rl {

namespace detail {
template <class T> MPMPBD_HD float* write(float* out, Vec3<T> const& v) {
  for (int a = 0; a < 3; ++a) *out++ = static_cast<float>(v[a]);
  return out;
}
struct StitchGroup {
  using Role = role::Observation;
  using Reads = union_t<StitchProgress::Reads, stitch::Memory, needle::Report>;
  using Writes = Fields<>;
};
}  // namespace detail

// Arc centre [m] and orientation (unit quaternion, w >= 0).
struct NeedlePose : detail::StitchGroup {
  static constexpr FixedString name = "needle_pose";
  static constexpr int size = 7;
  template <class Env, class Ctx>
  MPMPBD_HD static void observe(Env const& env, Ctx const& context, float* out) {
    auto const pose = stitch::needle_pose(env);
    out = detail::write(out, stitch::from_origin(context, pose.position));
    float const sign = pose.orientation[0] < 0 ? -1.0f : 1.0f;
    for (int a = 0; a < 4; ++a) *out++ = sign * static_cast<float>(pose.orientation[a]);
  }
};

// Velocity of the arc centre [m/s], angular velocity [rad/s].
struct NeedleTwist : detail::StitchGroup {
  static constexpr FixedString name = "needle_twist";
  static constexpr int size = 6;
  template <class Env, class Ctx>
  MPMPBD_HD static void observe(Env const& env, Ctx const&, float* out) {
    auto const& needles = env.template domain<Needles>();
    auto const twist = needle::twist(needles.view, needles.first);
    detail::write(detail::write(out, twist.linear), twist.angular);
  }
};

// Tip and both markers, where they are now [m].
struct TipAndMarkers : detail::StitchGroup {
  static constexpr FixedString name = "tip_and_markers";
  static constexpr int size = 9;
  template <class Env, class Ctx>
  MPMPBD_HD static void observe(Env const& env, Ctx const& context, float* out) {
    auto relative = [&](auto const& x) { return stitch::from_origin(context, x); };
    out = detail::write(out, relative(stitch::tip_position(env, context)));
    out = detail::write(out, relative(stitch::marker_position(env, stitch::entry)));
    detail::write(out, relative(stitch::marker_position(env, stitch::exit)));
  }
};

// Force [N] and moment about the arc centre [N m] of the tissue on the needle, in the last step.
struct NeedleWrench : detail::StitchGroup {
  static constexpr FixedString name = "needle_wrench";
  static constexpr int size = 6;
  template <class Env, class Ctx>
  MPMPBD_HD static void observe(Env const& env, Ctx const&, float* out) {
    out = detail::write(out, env.template get<needle::Force>(0));
    detail::write(out, env.template get<needle::Moment>(0));
  }
};

// Tension of every segment of the thread [N]; the last bead has none after it and shows the pull on
// the needle.
struct ThreadTension : detail::StitchGroup {
  static constexpr FixedString name = "thread_tension";
  using Each = Beads;
  static constexpr int size = 1;
  using Reads = union_t<StitchGroup::Reads, Fields<bead::Tension>>;
  template <class Env, class Ctx>
  MPMPBD_HD static void observe(Env const& env, Ctx const&, float* out) {
    std::int64_t const beads = env.template live<Beads>();
    for (std::int64_t k = 0; k + 1 < beads; ++k)
      out[k] = static_cast<float>(env.template get<bead::Tension>(k));
    if (beads > 0) out[beads - 1] = static_cast<float>(env.template get<needle::ThreadPull>(0));
  }
};

// Phase as three flags, and whether the tip touches or is in tissue.
struct StitchState : detail::StitchGroup {
  static constexpr FixedString name = "stitch_state";
  static constexpr int size = 5;
  template <class Env, class Ctx>
  MPMPBD_HD static void observe(Env const& env, Ctx const&, float* out) {
    auto const phase = stitch::phase(env);
    auto const tip = stitch::tip_state(env);
    out[0] = phase == StitchPhase::insertion ? 1.0f : 0.0f;
    out[1] = phase == StitchPhase::driving ? 1.0f : 0.0f;
    out[2] = phase == StitchPhase::extraction ? 1.0f : 0.0f;
    out[3] = tip == TipState::touch ? 1.0f : 0.0f;
    out[4] = tip == TipState::inside ? 1.0f : 0.0f;
  }
};

// How an episode is judged, besides its reward.
namespace metric {
template <class Field_> struct Remembered {
  using Role = role::Metric;
  using Reads = Fields<Field_>;
  using Writes = Fields<>;
  template <class Env, class Ctx> MPMPBD_HD static auto value(Env const& env, Ctx const&) {
    return env.template get<Field_>(0);
  }
};
struct Phase : Remembered<stitch::Phase> {
  static constexpr FixedString name = "phase";
};
// Distance of the tip to its marker when it went through the surface [m]; -1: it has not.
struct EntryMiss : Remembered<stitch::EntryMiss> {
  static constexpr FixedString name = "entry_miss";
};
struct ExitMiss : Remembered<stitch::ExitMiss> {
  static constexpr FixedString name = "exit_miss";
};
struct Success : Remembered<stitch::Phase> {
  static constexpr FixedString name = "success";
  template <class Env, class Ctx> MPMPBD_HD static float value(Env const& env, Ctx const&) {
    return stitch::phase(env) == StitchPhase::finished ? 1.0f : 0.0f;
  }
};
}  // namespace metric

}  // namespace mpmpbd::rl
