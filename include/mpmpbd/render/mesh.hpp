// Triangle meshes: what the rasteriser draws.
#pragma once

#include <span>
#include <vector>

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd::render {

using Triangle = Vec3<int>;  // three vertex numbers

struct Mesh {
  std::vector<Vec3<float>> positions{};  // [m], (vertex, 3)
  std::vector<Vec3<float>> normals{};    // unit, (vertex, 3)
  std::vector<Vec3<float>>
      colours{};  // factors on the finish's colour, linear RGB, (vertex, 3); or empty
  std::vector<Vec3<float>>
      material{};  // where the vertex was at rest [m], (vertex, 3); empty: as positions
  std::vector<Triangle> triangles{};  // counter-clockwise seen from outside, (triangle, 3)
  bool closed = false;                // encloses a volume: its inner side is never seen
};

// Vertex normals as the mean of the normals of the triangles around, weighted by their areas: the
// cross product of two edges already has the area in its length.
inline void compute_normals(Mesh& mesh) {
  mesh.normals.assign(mesh.positions.size(), Vec3<float>{});
  for (Triangle const& t : mesh.triangles) {
    Vec3<float> const& a = mesh.positions[t[0]];
    Vec3<float> const n = cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
    for (int corner = 0; corner < 3; ++corner) mesh.normals[t[corner]] += n;
  }
  for (Vec3<float>& n : mesh.normals) n = direction(n);
}

// Two triangles per square of a grid of vertices (row, column), turning from columns to rows.
inline void append_grid(Mesh& mesh, std::span<int const> grid, int columns) {
  int const rows = int(grid.size()) / columns;
  for (int r = 0; r + 1 < rows; ++r)
    for (int c = 0; c + 1 < columns; ++c) {
      int const v = r * columns + c;
      mesh.triangles.push_back({{grid[v], grid[v + 1], grid[v + columns + 1]}});
      mesh.triangles.push_back({{grid[v], grid[v + columns + 1], grid[v + columns]}});
    }
}

// The surface of a box [m] of cells[0] x cells[1] x cells[2] squares, its edges rounded off with a
// radius `rounding` [m]. `material` holds the box at rest. With sharp edges the faces share no
// vertices, so that normals do not smooth what is not smooth.
inline Mesh box_surface(Vec3<float> const& low, Vec3<float> const& high, Vec3<int> const& cells,
                        float rounding = 0.0f) {
  Mesh mesh;
  // Vertex at each point of the lattice; points inside the box stay empty.
  std::vector<int> shared((cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1), -1);
  auto const vertex = [&](Vec3<int> const& at) {
    int& known = shared[(at[2] * (cells[1] + 1) + at[1]) * (cells[0] + 1) + at[0]];
    if (known >= 0 && rounding > 0.0f) return known;
    known = int(mesh.positions.size());
    Vec3<float> p, inner;
    for (int i = 0; i < 3; ++i) {
      p[i] = low[i] + (high[i] - low[i]) * float(at[i]) / float(cells[i]);
      inner[i] = clamp(p[i], low[i] + rounding, high[i] - rounding);
    }
    mesh.positions.push_back(rounding > 0.0f ? inner + rounding * direction(p - inner) : p);
    return known;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      // On the low side the two tangents change places, so that triangles turn towards the outside.
      int const u = (axis + (side == 1 ? 1 : 2)) % 3;
      int const v = (axis + (side == 1 ? 2 : 1)) % 3;
      std::vector<int> grid;
      for (int j = 0; j <= cells[v]; ++j)
        for (int i = 0; i <= cells[u]; ++i) {
          Vec3<int> at{};
          at[axis] = side * cells[axis];
          at[u] = i;
          at[v] = j;
          grid.push_back(vertex(at));
        }
      append_grid(mesh, {grid.data(), grid.size()}, cells[u] + 1);
    }
  mesh.material = mesh.positions;
  mesh.closed = true;
  compute_normals(mesh);
  return mesh;
}

}  // namespace mpmpbd::render
