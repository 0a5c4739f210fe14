// Ready-made scenes that need no coupling: tissue alone and thread alone.
#pragma once

#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/effects/damping.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/viscosity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/constraints/bend.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>
#include <mpmpbd/pbd/solvers/direct_banded.hpp>
#include <mpmpbd/scene/simulation.hpp>

namespace mpmpbd::catalog {

// A block of soft tissue on a floor that it sticks to.
struct NeoHookeanBody : Mpm<NeoHookean> {};
using Bottom = Wall<Sticky, 2, Side::low>;
struct Tissue : Scene<NeoHookeanBody, Gravity, Viscosity, Bottom> {};

// Threads that resist stretch and bending, solved directly.
struct ElasticThread : Pbd<Constraints<Distance, Bend>, DirectBanded<>> {};
struct Suture : Scene<ElasticThread, Gravity, Damping> {};

}  // namespace mpmpbd::catalog
