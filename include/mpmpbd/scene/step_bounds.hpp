// What bounds the next substep of an environment, and whether it is still whole: the same text for every back end.
#pragma once

#include <mpmpbd/mpm/time_step.hpp>
#include <mpmpbd/needle/fields.hpp>
#include <mpmpbd/pbd/fields.hpp>
#include <mpmpbd/scene/scene.hpp>

namespace mpmpbd {

// Stands for the shares of nodes (mpm/node_shares.hpp) where a particle's limit does not hang on them.
struct SharesDoNotMatter {};

// What a particle adds to the bounds.
template <class Scene> struct ParticleBounds {
  using Body = typename Scene::Body;
  using Material = typename Body::Material;
  using Watching = in_slot_t<Slot::before_scatter, typename Scene::Effects>;
  using Used = union_t<typename Material::Reads, typename Scatter<Body>::Reads,
                       typename detail::ReadsOf<Watching>::type>;
  using Reads = stored_t<on_t<Used, Particles>>;

  // Adds it to `all`; returns the faults of its state: with not_finite it is not added.
  template <class P, class Ctx, class Shares, class T>
  MPMPBD_HD static std::uint32_t include(P const& p, Ctx const& context,
                                         [[maybe_unused]] Shares const& shares,
                                         StepBounds<T>& all) {
    auto one = step_bounds<Body>(p, context.template of<Material>());
    include_damping(one, p, context, Watching{});
    if constexpr (!has_bounded_stiffness<Body>) {
      T const stiffness = shares.stiffness(p);
      one.frequency2 *= stiffness, one.damping *= stiffness;
    }
    T const sum = one.frequency2 + one.damping + one.speed2 + one.rate2 +
                  dot(p[particle::Position{}], p[particle::Position{}]);
    if (!is_finite(sum)) return static_cast<std::uint32_t>(Fault::not_finite);
    all.include(one);
    return seen(p, context, Watching{});
  }

 private:
  // What effects with `damping(p, k)` [Pa s] add to the bounds.
  template <class T, class P, class Ctx, class... Es>
  MPMPBD_HD static void include_damping(StepBounds<T>& b, P const& p, Ctx const& context,
                                        TypeList<Es...>) {
    (include_damping_of<Es>(b, p, context), ...);
  }
  template <class E, class T, class P, class Ctx>
  MPMPBD_HD static void include_damping_of([[maybe_unused]] StepBounds<T>& b,
                                           [[maybe_unused]] P const& p,
                                           [[maybe_unused]] Ctx const& context) {
    if constexpr (requires { E::damping(p, context.template of<parameter_owner_t<E>>()); })
      b.damping = multiply_add(E::damping(p, context.template of<parameter_owner_t<E>>()),
                               p[particle::Volume{}] / p[particle::Mass{}], b.damping);
  }

  // What effects with `faults(p, k)` see.
  template <class P, class Ctx, class... Es>
  MPMPBD_HD static std::uint32_t seen(P const& p, Ctx const& context, TypeList<Es...>) {
    return (seen_by<Es>(p, context) | ... | 0u);
  }
  template <class E, class P, class Ctx>
  MPMPBD_HD static std::uint32_t seen_by([[maybe_unused]] P const& p,
                                         [[maybe_unused]] Ctx const& context) {
    if constexpr (requires { E::faults(p, context.template of<parameter_owner_t<E>>()); })
      return E::faults(p, context.template of<parameter_owner_t<E>>());
    else
      return 0u;
  }
};

// Where particles of a body may be on an axis [m]: a particle beyond it would write beyond the grid. The state
// may have been set from outside, so it is held there as one that moves out is. Infinity and NaN are left to
// the bounds.
template <class T> struct Room {
  T low, high;

  template <class Shape> MPMPBD_HD static Room on_axis(Lattice<T> const& lattice, int a) {
    return {lowest_cell<Shape, T>() * lattice.dx,
            highest_cell<Shape, T>(lattice.nodes[a]) * lattice.dx};
  }
  // Returns whether x was beyond.
  MPMPBD_HD bool hold(T& x) const {
    if (!is_finite(x) || (x >= low && x <= high)) return false;
    x = x > high ? high : low;
    return true;
  }
};

// not_finite where a bead, a frame or a needle has a NaN or an infinity, or a needle is turned nowhere
// (0, 0, 0, 0), as far as a lane of the team sees it; particles are asked by their bounds.
template <class Team_, class Env>
MPMPBD_HD std::uint32_t lost_bodies(Team_ const& team, Env const& env) {
  bool all = true;
  auto const look = [&]<class F>(F) {
    if constexpr (Env::template has<F>) {
      auto const& d = env.template domain<typename F::Domain>();
      team.each(static_cast<int>(d.count), [&](int slot) {
        for (int c = 0; c < F::components; ++c)
          all = is_finite(d.view.template plane<F>(c)[d.first + slot]) && all;
      });
    }
  };
  look(bead::Position{}), look(bead::Velocity{});
  look(frame::Orientation{}), look(frame::AngularVelocity{});
  look(needle::Position{}), look(needle::Orientation{});
  look(needle::LinearVelocity{}), look(needle::AngularVelocity{});
  if constexpr (Env::template has<needle::Orientation>)
    team.each(static_cast<int>(env.template live<Needles>()), [&](int n) {
      all = quaternion::is_valid(env.template get<needle::Orientation>(n)) && all;
    });
  return all ? 0 : static_cast<std::uint32_t>(Fault::not_finite);
}

// A needle may be told to move faster than any particle does, and must not pass through tissue between two
// substeps. An upper bound of the speed of its points [m/s].
template <class Scene, class Env, class Ctx>
MPMPBD_HD typename Env::Scalar needle_speed([[maybe_unused]] Env const& env,
                                            [[maybe_unused]] Ctx const& context) {
  using T = typename Env::Scalar;
  T speed = T(0);
  if constexpr (Scene::has_needle) {
    using Needle = typename Scene::Needle;
    auto const& needles = env.template domain<Needles>();
    auto const radius = Needle::arc(context.template of<Needle>()).radius;
    for (std::int64_t i = 0; i < needles.count; ++i) {
      auto const v = needle::twist(needles.view, needles.first + i);
      speed = max(speed, norm(v.linear) + radius * norm(v.angular));
    }
  }
  return speed;
}

}  // namespace mpmpbd
