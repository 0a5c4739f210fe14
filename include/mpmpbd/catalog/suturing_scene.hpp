// The suturing scene as a type: soft tissue, an arc needle and the thread behind it.
#pragma once

#include <mpmpbd/coupling/embedded.hpp>
#include <mpmpbd/effects/air.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/viscosity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/body.hpp>
#include <mpmpbd/scene/scene.hpp>

namespace mpmpbd {

struct SoftTissue : Mpm<NeoHookean> {};
struct Suture : Pbd<Constraints<Distance, Bend, Swage>> {};
using Floor = Wall<Sticky, 2, Side::low>;
struct Suturing : Scene<SoftTissue, Suture, ArcNeedle, Surface, Coupling<Embedded, Friction, Drag>,
                        Gravity, Viscosity, Air, Floor> {};

}  // namespace mpmpbd
