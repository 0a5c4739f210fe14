// The tissue surface: a closed triangle sheet of tracers that lay on the body's boundary at rest.
//
// It moves with the tissue and defines where the surface is: markers, crossings, depth of puncture
// and the picture. Vertices are state; triangles do not change. Triangles turn counter-clockwise
// seen from outside.
#pragma once

#include <cstdint>

#include <mpmpbd/core/table.hpp>
#include <mpmpbd/geometry/triangle.hpp>

namespace mpmpbd {

struct SheetVertices {
  static constexpr FixedString name = "sheet vertex";
};
struct SheetTriangles {
  static constexpr FixedString name = "sheet triangle";
};

namespace sheet {
struct Position : Field<"x", "m", Vector, SheetVertices> {};
struct Corners : Field<"corners", "1", Integers<3>, SheetTriangles> {};  // vertices of a triangle
}  // namespace sheet

// One environment's sheet, as algorithms see it: `vertex(i)` is a position, `corners(k)` three
// vertices.
template <class Vertices, class Corners> struct Sheet {
  Vertices vertex;
  Corners corners;
  std::int64_t vertices;
  std::int64_t triangles;

  MPMPBD_HD auto triangle(std::int64_t k) const {
    auto const c = corners(k);
    auto const a = vertex(c[0]);
    using T = typename decltype(a)::Scalar;
    return Triangle<T>{a, vertex(c[1]), vertex(c[2])};
  }
};
template <class Vertices, class Corners>
MPMPBD_HD Sheet<Vertices, Corners> make_sheet(Vertices const& vertex, std::int64_t vertices,
                                              Corners const& corners, std::int64_t triangles) {
  return {vertex, corners, vertices, triangles};
}

// A material point of the surface: it stays on its triangle wherever the tissue goes.
template <class T> struct SurfaceMark {
  std::int64_t triangle;  // -1: none
  Vec<T, 2> weights;      // of the second and third corner
};

template <class S, class T> MPMPBD_HD Vec3<T> position(S const& sheet, SurfaceMark<T> const& mark) {
  return sheet.triangle(mark.triangle).at(mark.weights);
}

// Moves one tracer with the tissue. `velocity(x)` interpolates the grid; near the surface it must
// leave out nodes without mass, or the sheet lags behind the tissue.
template <class Row_, class Velocity, class T>
MPMPBD_HD void advect(Row_ const& tracer, std::int64_t slot, Velocity const& velocity, T dt) {
  auto const x = tracer(slot);
  tracer.set(slot, x + dt * velocity(x));
}

// Volume inside the sheet [m^3], by the divergence theorem about its first vertex.
template <class S> MPMPBD_HD auto enclosed_volume(S const& sheet) {
  auto const origin = sheet.vertex(std::int64_t{0});
  using T = typename decltype(origin)::Scalar;
  double sum = 0.0;
  for (std::int64_t k = 0; k < sheet.triangles; ++k) {
    auto const t = sheet.triangle(k);
    sum += double(dot(t.a - origin, cross(t.b - origin, t.c - origin)));
  }
  return T(sum / 6.0);
}

// How good the triangles are; a sheet that folds or collapses shows here first.
template <class T> struct SheetQuality {
  T worst_shape;    // 4 sqrt(3) area / (sum of squared edges): 1 equilateral, 0 flat
  T smallest_area;  // [m^2]
  T longest_edge;   // [m]
};
template <class S> MPMPBD_HD auto sheet_quality(S const& sheet) {
  using T = typename decltype(sheet.vertex(std::int64_t{0}))::Scalar;
  SheetQuality<T> q{T(1), T(0), T(0)};
  for (std::int64_t k = 0; k < sheet.triangles; ++k) {
    auto const t = sheet.triangle(k);
    T const area = t.area(), ab = norm(t.b - t.a), bc = norm(t.c - t.b), ca = norm(t.a - t.c);
    T const squares = ab * ab + bc * bc + ca * ca;
    q.worst_shape =
        min(q.worst_shape, squares > T(0) ? T(6.928203230275509) * area / squares : T(0));
    q.smallest_area = k == 0 ? area : min(q.smallest_area, area);
    q.longest_edge = max(q.longest_edge, max(ab, max(bc, ca)));
  }
  return q;
}

}  // namespace mpmpbd
