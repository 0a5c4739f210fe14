// A sheet in tables, as a simulation holds it, for the tests of surface, tip and channel.
#pragma once

#include <mpmpbd/surface/queries.hpp>
#include <mpmpbd/surface/sheet_mesh.hpp>

namespace mpmpbd {

using VertexFields = Fields<sheet::Position>;
using TriangleFields = Fields<sheet::Corners>;
using FirstFields = Fields<sheet::First>;
using ItemFields = Fields<sheet::Item>;

// A sheet in tables, as a simulation holds it: environment 1 of 2.
template <class T> struct Held {
  Table<T, SheetVertices, VertexFields> vertices;
  Table<T, SheetTriangles, TriangleFields> triangles;
  Table<T, SheetColumns, FirstFields> firsts;
  Table<T, SheetItems, ItemFields> items;
  Vec<T, 2> origin;
  T width, margin;
  int nx, ny;

  Held(SheetMesh<T> const& mesh, T width_, T margin_, Vec<T, 2> const& origin_, int nx_, int ny_,
       std::int64_t capacity)
      : vertices(2, static_cast<std::int64_t>(mesh.positions.size())),
        triangles(2, static_cast<std::int64_t>(mesh.triangles.size())),
        firsts(2, nx_ * ny_ + 1),
        items(2, capacity),
        origin(origin_),
        width(width_),
        margin(margin_),
        nx(nx_),
        ny(ny_) {
    load_sheet(mesh, vertices, triangles, 1);
    faults = columns().build(sheet());
  }
  auto sheet() {
    auto const v = vertices.view();
    auto const t = triangles.view();
    return make_sheet(Row<decltype(v), sheet::Position>{v, v.capacity}, vertices.live(1),
                      Row<decltype(t), sheet::Corners>{t, t.capacity}, triangles.live(1));
  }
  auto columns() {
    auto const f = firsts.view();
    auto const i = items.view();
    return make_columns(origin, width, nx, ny, margin,
                        Row<decltype(f), sheet::First>{f, f.capacity},
                        Row<decltype(i), sheet::Item>{i, i.capacity}, i.capacity);
  }
  std::uint32_t faults = 0;
};

// A block of 40 x 20 x 20 mm in a domain that starts at the origin, cells of 2 mm.
template <class T> Box<T> block() {
  return {vec<T>(T(0.006), T(0.006), T(0.004)), vec<T>(T(0.046), T(0.026), T(0.024))};
}
template <class T> Held<T> held_block() {
  return {box_sheet(block<T>(), Vec3<int>{{20, 10, 10}}),
          T(0.002),
          T(0.0005),
          Vec<T, 2>{{T(0), T(0)}},
          26,
          16,
          20000};
}

}  // namespace mpmpbd
