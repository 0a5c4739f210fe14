// What every closed surface must be: without holes, and turned outwards.
#pragma once

#include <map>
#include <utility>

#include <mpmpbd/render/mesh.hpp>

// Every edge belongs to two triangles that run through it in opposite directions.
inline bool watertight(mpmpbd::render::Mesh const& mesh) {
  std::map<std::pair<int, int>, int> uses;
  for (auto const& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
  for (auto const& [edge, count] : uses)
    if (count != 1 || uses.count({edge.second, edge.first}) == 0) return false;
  return !uses.empty();
}

// Enclosed volume [m^3] by the divergence theorem; positive when triangles turn outwards.
inline double volume(mpmpbd::render::Mesh const& mesh) {
  double sum = 0.0;
  for (auto const& t : mesh.triangles) {
    auto const a = mpmpbd::cast<double>(mesh.positions[t[0]]);
    auto const b = mpmpbd::cast<double>(mesh.positions[t[1]]);
    auto const c = mpmpbd::cast<double>(mesh.positions[t[2]]);
    sum += dot(a, cross(b, c)) / 6.0;
  }
  return sum;
}
