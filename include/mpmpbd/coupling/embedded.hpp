// Embedded: points on needle and thread exchange impulses with the grid through the particles' own weights,
// so nothing leaks between grid offsets, whatever the radius; the thread's stretch and bending and its
// contact are one direct solve, so a taut thread cannot cut through tissue.
//
// Limits: threads are chains of uniform material; one needle per environment; the tissue's own pressure adds
// to the clamp pressure of a channel only where the scene names TissuePressure. Angular momentum is exact
// for a slack thread; stored tension and bending act across the thread implicitly, which costs about 1e-4 of
// it per exchange and less with dt.
#pragma once

#include <mpmpbd/coupling/coupling.hpp>
#include <mpmpbd/coupling/embedded_exchange.hpp>
#include <mpmpbd/coupling/embedded_motion.hpp>

namespace mpmpbd {

struct Embedded {
  static constexpr FixedString name = "Embedded";
  using Takes = TypeList<Distance, Bend, Pin, Attachment, Swage>;
  static constexpr Conserves conserves = Conserves::momentum_and_angular;

  template <class T> struct Parameters {
    T thread_radius;  // [m]
  };
  static constexpr std::array<ParameterInfo, 1> parameter_info{
      {bound::not_negative("thread_radius", "m")}};

  // `In`: the bodies, laws and effects of the scene (SceneParts).
  template <class In> using Stages = join_t<TypeList<ExchangeImpulses<In>>, FollowTissue<In>>;
};

}  // namespace mpmpbd
