// The tissue surface as a part of a scene: sheet, markers, channels, events.
#pragma once

#include <mpmpbd/core/role.hpp>
#include <mpmpbd/surface/needle_surface.hpp>
#include <mpmpbd/surface/sheet_mesh.hpp>

namespace mpmpbd {

// A closed sheet of tracers that decides where tissue begins: what a needle has to puncture, which
// parts of a thread are in a channel, and what a picture shows. A scene without it couples every
// point that has tissue around it.
struct Surface {
  using Role = role::Surface;
  static constexpr FixedString name = "surface";
  using Reads = Fields<>;
  using Writes = union_t<Fields<sheet::Position, sheet::Corners>, marker::State, event::State,
                         Fields<event::Count>, channel::State, channel::PointState>;
};

}  // namespace mpmpbd
