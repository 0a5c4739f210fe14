// Plane and uniaxial strain in the library's 3-D grid: a body one cell thick between slip walls, one
// particle across.
//
// The walls stand on the node planes at its two faces, so every node is at or behind one of them and nothing
// moves across. A particle in the middle shares with the planes by weights that do not depend on what it
// carries, so all planes move alike: to rounding this is the scheme of 2-D, with the mass of a cell's depth.
#pragma once

#include <vector>

#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/flip.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include "physics/back_end.hpp"

namespace test {

using namespace mpmpbd;

template <class Body, class... Effects> struct Layer : Scene<Body, Effects..., Walls<Slip>> {};
template <class Body, class... Effects>
using LayerRun = Simulation<Layer<Body, Effects...>, BackEnd, double>;
using SlipWalls = Walls<Slip>::Parameters<double>;

// Along an axis of the layer: its middle [cells] and the nodes of the grid.
inline constexpr double layer_middle = 1.5;
inline constexpr int layer_nodes = 4;

// A layer across all axes but the first `free_axes`: plane strain with two of them, a bar with one.
inline SlipWalls layer_walls(double cell, int free_axes) {
  SlipWalls walls{};
  for (int a = 0; a < 3; ++a) {
    walls.low[a] = a < free_axes ? -cell : cell;  // off the grid, or the faces of the layer
    walls.high[a] = a < free_axes ? 1e6 * cell : 2.0 * cell;
  }
  return walls;
}
inline SimulationOptions layer_options(double cell, int nodes_x, int nodes_y,
                                       std::size_t particles) {
  return {.environments = 1,
          .cell_size = cell,
          .nodes = {nodes_x, nodes_y, layer_nodes},
          .capacity = {{"particle", static_cast<std::int64_t>(particles)}},
          .substeps = 1};
}

// Four particles per cell of a layer, in quarters of the cells [0, cells_x) x [0, cells_y): those that are
// `inside`.
template <class Inside>
std::vector<Vec3<double>> layer_points(double cell, int cells_x, int cells_y,
                                       Inside const& inside) {
  std::vector<Vec3<double>> points;
  for (int j = 0; j < 2 * cells_y; ++j)
    for (int i = 0; i < 2 * cells_x; ++i) {
      auto const x = cell * vec(0.5 * i + 0.25, 0.5 * j + 0.25, layer_middle);
      if (inside(x)) points.push_back(x);
    }
  return points;
}
// Two per cell of a bar, in the cells [first, end).
inline std::vector<Vec3<double>> bar_points(double cell, int first, int end) {
  std::vector<Vec3<double>> points;
  for (int i = 2 * first; i < 2 * end; ++i)
    points.push_back(cell * vec(0.5 * i + 0.25, layer_middle, layer_middle));
  return points;
}

// FLIP without a share of PIC, where a body has FLIP.
template <class Sim> void pure_flip(Sim& run) {
  if constexpr (std::is_same_v<typename Sim::Scene::Body::Transfer, Flip>)
    run.template set<Flip>({1.0});
}

}  // namespace test
