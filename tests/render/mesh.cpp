#include <mpmpbd/render/mesh.hpp>

#include "../catch.hpp"
#include "surface_checks.hpp"

using namespace mpmpbd;
using namespace mpmpbd::render;

namespace {
Vec3<float> const low = vec(-0.7f, 0.2f, 3.0f);
Vec3<float> const high = vec(1.3f, 1.2f, 3.6f);
}  // namespace

TEST_CASE("a box surface encloses the volume of the box", "[render][mesh]") {
  Mesh const box = box_surface(low, high, {{7, 4, 3}});
  CHECK_THAT(volume(box), WithinRel(2.0 * 1.0 * 0.6, 1e-5));
}

TEST_CASE("the normals of a sharp box are those of its faces", "[render][mesh]") {
  Mesh const box = box_surface(low, high, {{7, 4, 3}});
  for (std::size_t i = 0; i < box.positions.size(); ++i) {
    Vec3<float> const& n = box.normals[i];
    float largest = 0.0f;
    for (int axis = 0; axis < 3; ++axis) largest = max(largest, abs(n[axis]));
    CHECK_THAT(largest, WithinAbs(1.0, 1e-6));
    // A step along the normal leaves the box.
    Vec3<float> const outside = box.positions[i] + 1e-3f * n;
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis)
      inside = inside && outside[axis] > low[axis] - 1e-4f && outside[axis] < high[axis] + 1e-4f;
    CHECK_FALSE(inside);
  }
}

TEST_CASE("a rounded box is watertight and everywhere its radius away from the inner box",
          "[render][mesh]") {
  float const radius = 0.08f;
  Mesh const box = box_surface(low, high, {{40, 20, 12}}, radius);
  CHECK(watertight(box));
  for (Vec3<float> const& p : box.positions) {
    Vec3<float> inner;
    for (int axis = 0; axis < 3; ++axis)
      inner[axis] = clamp(p[axis], low[axis] + radius, high[axis] - radius);
    CHECK_THAT(norm(p - inner), WithinAbs(double(radius), 1e-6));
  }
}

TEST_CASE("a vertex normal leans to the larger triangle", "[render][mesh]") {
  // Two triangles on a common edge along y: a small one in the plane z = 0, one nine times as large
  // in the plane x = 0.
  Mesh mesh;
  mesh.positions = {vec(0.0f, 0.0f, 0.0f), vec(0.0f, 0.4f, 0.0f), vec(-0.1f, 0.0f, 0.0f),
                    vec(0.0f, 0.0f, -0.9f)};
  mesh.triangles = {{{0, 1, 2}}, {{1, 0, 3}}};
  compute_normals(mesh);
  Vec3<float> const expected = direction(vec(9.0f, 0.0f, 1.0f));
  CHECK(norm(mesh.normals[0] - expected) < 1e-6f);
  CHECK(norm(mesh.normals[2] - vec(0.0f, 0.0f, 1.0f)) < 1e-6f);
}
