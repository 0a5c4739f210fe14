// The parts of the suturing task, without its settings: all that a device compiles.
#pragma once

#include <mpmpbd/catalog/suturing_scene.hpp>
#include <mpmpbd/rl/suturing/observation.hpp>
#include <mpmpbd/rl/suturing/randomisation.hpp>
#include <mpmpbd/rl/suturing/reward.hpp>

namespace mpmpbd::rl {

// Everything but what is seen: `Groups` are the observation groups, and what they need besides.
template <class... Groups>
using SuturingParts =
    Task<Suturing, MoveNeedle, StitchProgress, Groups..., EntryDistance, EntryReached,
         TurnTowardsExit, ExitCloseness, ExitReached, CentreMotion, StitchFinished, StitchOver,
         RandomTissue, RandomFriction, RandomThread, RandomNeedle, RandomMarkers, RandomStart,
         metric::Phase, metric::Success, metric::EntryMiss, metric::ExitMiss>;

// With all that a policy without a camera can know.
template <template <class...> class With>
using SeenByState =
    With<NeedlePose, NeedleTwist, TipAndMarkers, StitchState, NeedleWrench, ThreadTension>;

}  // namespace mpmpbd::rl
