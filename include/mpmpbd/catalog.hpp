// The catalogue: ready-made scenes, compiled once in mpmpbd::catalog.
//
// Including this instead of composing a scene saves its compile time: the functions that hold all loops
// are declared extern. Each scene comes for Serial and Threads, float and double.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <mpmpbd/catalog/scenes.hpp>
#include <mpmpbd/catalog/suturing.hpp>

// Applies a macro to every scene of the catalogue. `M(Scene)`.
#define MPMPBD_CATALOG_SCENES(M) \
  M(mpmpbd::catalog::Tissue)     \
  M(mpmpbd::catalog::Suture)     \
  M(mpmpbd::Suturing)

#define MPMPBD_CATALOG_SIMULATIONS(KEYWORD, SCENE)                          \
  KEYWORD template class mpmpbd::Simulation<SCENE, mpmpbd::Serial, float>;  \
  KEYWORD template class mpmpbd::Simulation<SCENE, mpmpbd::Serial, double>; \
  KEYWORD template class mpmpbd::Simulation<SCENE, mpmpbd::Threads, float>; \
  KEYWORD template class mpmpbd::Simulation<SCENE, mpmpbd::Threads, double>;

#define MPMPBD_CATALOG_DECLARE(SCENE) MPMPBD_CATALOG_SIMULATIONS(extern, SCENE)
MPMPBD_CATALOG_SCENES(MPMPBD_CATALOG_DECLARE)
#undef MPMPBD_CATALOG_DECLARE

namespace mpmpbd::catalog {

// A scene as the registry knows it.
struct Entry {
  std::string_view name;
  std::string_view about;
  std::string (*plan)();  // of the serial back end in float
};

// All scenes of the catalogue.
std::span<Entry const> entries();
// One of them. Throws std::out_of_range with the names that there are.
Entry const& entry(std::string_view name);

}  // namespace mpmpbd::catalog
