// How episodes differ: tissue, contact, thread, needle and markers, each within its range. A range
// of no width changes nothing.
#pragma once

#include <mpmpbd/coupling/friction.hpp>
#include <mpmpbd/geometry/polyline.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/rl/parameters.hpp>
#include <mpmpbd/rl/suturing/progress.hpp>

namespace mpmpbd::rl {

namespace detail {
struct StitchChange {
  using Role = role::Randomisation;
  using Reads = StitchProgress::Reads;
  using Writes = Fields<>;
};
// By a factor between two numbers, evenly in the logarithm.
struct StitchFactor : StitchChange {
  template <class T> struct Parameters { T least, most; };
  static constexpr ParameterInfo parameter_info[] = {bound::positive("least", "1"),
                                                     bound::positive("most", "1")};
};
}  // namespace detail

// Both Lame constants, each times a factor of its own.
struct RandomTissue : detail::StitchFactor {
  static constexpr FixedString name = "RandomTissue";
  template <class Env, class Ctx>
  MPMPBD_HD static void apply(Env const& env, Ctx const& context, Random& random) {
    using T = typename Env::Scalar;
    auto const& k = context.template of<RandomTissue>();
    auto material = context.template of<NeoHookean>();
    material.mu *= T(random.factor(k.least, k.most));
    material.lambda *= T(random.factor(k.least, k.most));
    set_parameters<NeoHookean>(env, material);
  }
};

// Friction coefficient of needle and thread, times a factor.
struct RandomFriction : detail::StitchFactor {
  static constexpr FixedString name = "RandomFriction";
  template <class Env, class Ctx>
  MPMPBD_HD static void apply(Env const& env, Ctx const& context, Random& random) {
    using T = typename Env::Scalar;
    auto const& k = context.template of<RandomFriction>();
    auto friction = context.template of<Friction>();
    friction.coefficient *= T(random.factor(k.least, k.most));
    set_parameters<Friction>(env, friction);
  }
};

// Bending stiffness of the thread, times a factor.
struct RandomThread : detail::StitchFactor {
  static constexpr FixedString name = "RandomThread";
  template <class Env, class Ctx>
  MPMPBD_HD static void apply(Env const& env, Ctx const& context, Random& random) {
    using T = typename Env::Scalar;
    auto const& k = context.template of<RandomThread>();
    T const softer = T(1 / random.factor(k.least, k.most));
    for (std::int64_t i = 0; i < env.template live<Instances<Bend>>(); ++i) {
      auto joint = load_parameters<Bend>(env, i);
      joint.compliance *= softer;
      store_parameters<Bend>(env, i, joint);
    }
  }
};

// Radius of the needle, times a factor; the thread's tie moves with its blunt end.
struct RandomNeedle : detail::StitchFactor {
  static constexpr FixedString name = "RandomNeedle";
  template <class Env, class Ctx>
  MPMPBD_HD static void apply(Env const& env, Ctx const& context, Random& random) {
    using T = typename Env::Scalar;
    auto const& k = context.template of<RandomNeedle>();
    auto needle = context.template of<ArcNeedle>();
    needle.radius *= T(random.factor(k.least, k.most));
    set_parameters<ArcNeedle>(env, needle);
  }
};

// Both markers shifted along the tissue, and brought closer together.
struct RandomMarkers : detail::StitchChange {
  static constexpr FixedString name = "RandomMarkers";
  template <class T> struct Parameters {
    T entry_x, exit_x, y, z;  // without randomisation [m]
    T shift;                  // at most, to either side [m]
    T closer;                 // at most, each of them [m]
  };
  static constexpr ParameterInfo parameter_info[] = {bound::any("entry_x", "m"),
                                                     bound::any("exit_x", "m"),
                                                     bound::any("y", "m"),
                                                     bound::any("z", "m"),
                                                     bound::not_negative("shift", "m"),
                                                     bound::not_negative("closer", "m")};
  template <class Env, class Ctx>
  MPMPBD_HD static void apply(Env const& env, Ctx const& context, Random& random) {
    using T = typename Env::Scalar;
    auto const& k = context.template of<RandomMarkers>();
    T const shift = T(random.between(-k.shift, k.shift));
    T const closer = T(random.between(0.0, k.closer));
    auto const& markers = env.template domain<Markers>();
    auto const sheet = mpmpbd::detail::sheet_of_environment(env);
    auto put = [&](stitch::Marker which, T x) {
      marker::store(markers.view, markers.first + which, mark_at(sheet, vec(x, k.y, k.z)));
    };
    put(stitch::entry, k.entry_x + shift + closer);
    put(stitch::exit, k.exit_x + shift - closer);
  }
};

// Puts the needle above the tissue, somewhere, turned somehow, and the thread behind it.
struct RandomStart : detail::StitchChange {
  static constexpr FixedString name = "RandomStart";
  template <class T> struct Parameters {
    T x, y, z;       // of the arc centre, in the middle of its range [m]
    T turn;          // of the needle: from the x axis to its tip, in the middle of its range [rad]
    T shift;         // at most, along x and z, to either side [m]
    T turn_range;    // at most, to either side [rad]
    T thread_top;    // height at which the thread lies [m]
    T thread_aside;  // how far beside the needle's plane [m]
  };
  static constexpr ParameterInfo parameter_info[] = {bound::any("x", "m"),
                                                     bound::any("y", "m"),
                                                     bound::any("z", "m"),
                                                     bound::any("turn", "rad"),
                                                     bound::not_negative("shift", "m"),
                                                     bound::not_negative("turn_range", "rad"),
                                                     bound::any("thread_top", "m"),
                                                     bound::any("thread_aside", "m")};
  template <class Env, class Ctx>
  MPMPBD_HD static void apply(Env const& env, Ctx const& context, Random& random) {
    using T = typename Env::Scalar;
    auto const& k = context.template of<RandomStart>();
    T const along = T(random.between(-k.shift, k.shift));
    T const up = T(random.between(-k.shift, k.shift));
    Vec3<T> const centre = vec(k.x + along, k.y, k.z + up);
    T const turn = k.turn + T(random.between(-k.turn_range, k.turn_range));
    auto const pose = Pose<T>{centre, plane::orientation(turn)};
    auto const& needles = env.template domain<Needles>();
    needle::set_pose(needles.view, needles.first, pose);
    needle::set_twist(needles.view, needles.first, Twist<T>{});
    auto const arc = ArcNeedle::arc(context.template of<ArcNeedle>());
    Tip<T>::at(to_world(pose, arc.point(T(0)))).store(needles.view, needles.first);
    lay_thread(env, to_world(pose, arc.point(arc.length())), arc.radius, k);
  }

 private:
  // From the blunt end down to the tissue, then along it beside the needle's way, back from where
  // the needle goes.
  template <class Env, class T, class K>
  MPMPBD_HD static void lay_thread(Env const& env, Vec3<T> const& end, T radius, K const& k) {
    T const down = k.thread_top - end[2];
    Vec3<T> const way[] = {end, end + vec(T(0), T(0.5) * k.thread_aside, down),
                           end + vec(T(-0.5) * radius, k.thread_aside, down),
                           end + vec(T(-1000) * radius, k.thread_aside, down)};
    std::int64_t const last = env.template live<Beads>() - 1;
    T const segment = load_parameters<Distance>(env, 0).rest_length;
    walk_polyline(way, 4, segment, last + 1, [&](std::int64_t i, Vec3<T> const& x) {
      env.template set<bead::Position>(last - i, x);
    });
  }
};

}  // namespace mpmpbd::rl
