// Making a sheet on the host: the surface of a box, or any closed mesh, checked before it is used.
#pragma once

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include <mpmpbd/geometry/box.hpp>
#include <mpmpbd/surface/sheet.hpp>

namespace mpmpbd {

template <class T> struct SheetMesh {
  std::vector<Vec3<T>> positions{};               // [m], (vertex, 3)
  std::vector<Vec<std::int64_t, 3>> triangles{};  // (triangle, 3)
};

namespace detail {
struct VectorAt {
  template <class V> struct Of {
    std::vector<V> const* values;
    V operator()(std::int64_t i) const { return (*values)[static_cast<std::size_t>(i)]; }
  };
};
}  // namespace detail

// A sheet that looks at a mesh; the mesh must outlive it.
template <class T> auto sheet_of(SheetMesh<T> const& mesh) {
  using Vertices = detail::VectorAt::Of<Vec3<T>>;
  using Corners = detail::VectorAt::Of<Vec<std::int64_t, 3>>;
  return Sheet<Vertices, Corners>{{&mesh.positions},
                                  {&mesh.triangles},
                                  static_cast<std::int64_t>(mesh.positions.size()),
                                  static_cast<std::int64_t>(mesh.triangles.size())};
}

// The surface of a box as one closed sheet; faces share the vertices of their edges. Diagonals
// alternate, so that the sheet has no preferred direction.
template <class T> SheetMesh<T> box_sheet(Box<T> const& box, Vec3<int> const& cells) {
  check_box(box, "box_sheet");
  for (int a = 0; a < 3; ++a)
    if (cells[a] < 1 || cells[a] > 4096)
      throw std::invalid_argument("mpmpbd box_sheet: cells[" + std::to_string(a) + "] = " +
                                  std::to_string(cells[a]) + " is not allowed; give 1 to 4096");
  SheetMesh<T> mesh;
  std::vector<std::int64_t> number(static_cast<std::size_t>(cells[0] + 1) *
                                       static_cast<std::size_t>(cells[1] + 1) *
                                       static_cast<std::size_t>(cells[2] + 1),
                                   -1);
  auto vertex = [&](Vec3<int> const& i) {
    auto const at = (static_cast<std::size_t>(i[2]) * static_cast<std::size_t>(cells[1] + 1) +
                     static_cast<std::size_t>(i[1])) *
                        static_cast<std::size_t>(cells[0] + 1) +
                    static_cast<std::size_t>(i[0]);
    if (number[at] < 0) {
      number[at] = static_cast<std::int64_t>(mesh.positions.size());
      Vec3<T> x{};
      for (int a = 0; a < 3; ++a)
        x[a] = i[a] == cells[a] ? box.high[a]
                                : box.low[a] + (box.high[a] - box.low[a]) * T(i[a]) / T(cells[a]);
      mesh.positions.push_back(x);
    }
    return number[at];
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      // On the low side the two tangents change places, so that triangles turn towards the outside.
      int const u = (axis + (side == 1 ? 1 : 2)) % 3, v = (axis + (side == 1 ? 2 : 1)) % 3;
      for (int j = 0; j < cells[v]; ++j)
        for (int i = 0; i < cells[u]; ++i) {
          auto corner = [&](int di, int dj) {
            Vec3<int> at{};
            at[axis] = side == 1 ? cells[axis] : 0;
            at[u] = i + di;
            at[v] = j + dj;
            return vertex(at);
          };
          std::int64_t const a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if ((i + j) % 2 == 0) {
            mesh.triangles.push_back({{a, b, c}});
            mesh.triangles.push_back({{a, c, d}});
          } else {
            mesh.triangles.push_back({{a, b, d}});
            mesh.triangles.push_back({{b, c, d}});
          }
        }
    }
  return mesh;
}

// Refuses what is not a closed sheet with its outside outwards: every edge must have two triangles
// that run along it in opposite directions, and the enclosed volume must be positive.
template <class T> void check_sheet(SheetMesh<T> const& mesh, std::string const& owner = "sheet") {
  auto refuse = [&owner](std::string const& what) {
    throw std::invalid_argument("mpmpbd " + owner + ": " + what);
  };
  if (mesh.triangles.size() < 4)
    refuse(std::to_string(mesh.triangles.size()) + " triangles; a closed surface has at least 4");
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    if (!is_finite(mesh.positions[i])) refuse("vertex " + std::to_string(i) + " is not finite");
  auto const count = static_cast<std::int64_t>(mesh.positions.size());
  std::vector<std::array<std::int64_t, 3>> edges;  // low vertex, high vertex, direction
  std::vector<char> used(mesh.positions.size(), 0);
  auto const sheet = sheet_of(mesh);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    auto const& t = mesh.triangles[k];
    for (int c = 0; c < 3; ++c) {
      if (t[c] < 0 || t[c] >= count)
        refuse("triangle " + std::to_string(k) + " names vertex " + std::to_string(t[c]) +
               "; there are " + std::to_string(count));
      used[static_cast<std::size_t>(t[c])] = 1;
    }
    if (!(sheet.triangle(static_cast<std::int64_t>(k)).area() > T(0)))
      refuse("triangle " + std::to_string(k) + " has no area");
    for (int c = 0; c < 3; ++c) {
      std::int64_t const a = t[c], b = t[(c + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b ? 0 : 1});
    }
  }
  for (std::size_t i = 0; i < used.size(); ++i)
    if (!used[i]) refuse("vertex " + std::to_string(i) + " belongs to no triangle");
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size(); i += 2) {
    bool const pair = i + 1 < edges.size() && edges[i][0] == edges[i + 1][0] &&
                      edges[i][1] == edges[i + 1][1] && edges[i][2] == 0 && edges[i + 1][2] == 1;
    bool const third =
        i + 2 < edges.size() && edges[i][0] == edges[i + 2][0] && edges[i][1] == edges[i + 2][1];
    if (!pair || third)
      refuse(
          "the edge between vertices " + std::to_string(edges[i][0]) + " and " +
          std::to_string(edges[i][1]) +
          " does not have exactly two triangles that run along it in opposite directions; give a closed surface");
  }
  T const volume = enclosed_volume(sheet);
  if (!is_finite(volume)) refuse("its volume is not a finite number; give lengths in metres");
  if (!(volume > T(0))) refuse("the triangles turn inwards; turn them all round");
}

// Copies a mesh into the tables of one environment.
template <class Vertices, class Triangles, class T>
void load_sheet(SheetMesh<T> const& mesh, Vertices& vertices, Triangles& triangles,
                std::int64_t env) {
  using To = typename decltype(vertices.view())::Scalar;
  vertices.set_live(env, static_cast<std::int64_t>(mesh.positions.size()));
  triangles.set_live(env, static_cast<std::int64_t>(mesh.triangles.size()));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    vertices.template set<sheet::Position>(env, static_cast<std::int64_t>(i),
                                           cast<To>(mesh.positions[i]));
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k)
    triangles.template set<sheet::Corners>(env, static_cast<std::int64_t>(k), mesh.triangles[k]);
}

}  // namespace mpmpbd
