// The sheet as the rasteriser and the writers of PLY and VTK take it.
#pragma once

#include <mpmpbd/render/mesh.hpp>
#include <mpmpbd/surface/sheet.hpp>

namespace mpmpbd {

// Fills `mesh` (its memory is used again) with positions, vertex normals and triangles. Closed
// sheets share the vertices of a box's edges, so `crease` splits them: triangles whose normals
// differ by more than this cosine from the vertex normal get a vertex of their own there, and edges
// stay sharp.
template <class S> void picture_of(S const& sheet, render::Mesh& mesh, float crease = 0.8f) {
  mesh.positions.clear();
  mesh.colours.clear();
  mesh.material.clear();
  mesh.triangles.clear();
  auto const at = [](std::int64_t i) { return static_cast<std::size_t>(i); };
  for (std::int64_t i = 0; i < sheet.vertices; ++i)
    mesh.positions.push_back(cast<float>(sheet.vertex(i)));
  for (std::int64_t k = 0; k < sheet.triangles; ++k) {
    auto const c = sheet.corners(k);
    mesh.triangles.push_back(
        {{static_cast<int>(c[0]), static_cast<int>(c[1]), static_cast<int>(c[2])}});
  }
  render::compute_normals(mesh);
  for (std::int64_t k = 0; k < sheet.triangles; ++k) {
    auto const n = direction(cast<float>(sheet.triangle(k).area_normal()));
    auto& t = mesh.triangles[at(k)];
    for (int corner = 0; corner < 3; ++corner) {
      auto const v = at(t[corner]);
      if (dot(mesh.normals[v], n) >= crease) continue;
      t[corner] = static_cast<int>(mesh.positions.size());
      mesh.positions.push_back(mesh.positions[v]);
      mesh.normals.push_back(n);
    }
  }
}

}  // namespace mpmpbd
