// One triangle seen from the eye: which rays hit it, how far away, and where on it.
//
// Homogeneous rasterisation (Olano and Greer, Triangle Scan Conversion using 2D Homogeneous
// Coordinates, 1997): the planes through the eye and the edges are linear in the view direction, so
// nothing is divided before the pixel, perspective is exact, and a triangle may reach behind the eye.
#pragma once

#include <mpmpbd/render/camera.hpp>

namespace mpmpbd::render {

struct Facet {
  Vec3<float> edge[3];   // edge[i] . d >= 0 on the inner side of the edge opposite to corner i
  Vec3<float> nearness;  // 1/forward = nearness . d [1/m], for a direction d with forward = 1
  bool front;            // the eye is on the side from which the triangle turns counter-clockwise
};

// False when the triangle is seen edge on. Neighbours compute their common edge with opposite sign
// and equal bits, so no ray passes between them.
MPMPBD_HD inline bool make_facet(Vec3<float> const& a, Vec3<float> const& b, Vec3<float> const& c,
                                 Facet& facet) {
  Vec3<float> const n = cross(b - a, c - a);
  float const determinant = dot(n, a);
  if (determinant == 0.0f) return false;
  float const side = determinant > 0.0f ? 1.0f : -1.0f;
  facet.edge[0] = side * cross(b, c);
  facet.edge[1] = side * cross(c, a);
  facet.edge[2] = side * cross(a, b);
  facet.nearness = (1.0f / determinant) * n;
  // View coordinates (right, up, forward) are left-handed, which turns the sign around.
  facet.front = determinant > 0.0f;
  return true;
}

// Barycentric weights of the point that the direction d hits, already corrected for perspective.
MPMPBD_HD inline Vec3<float> weights(Facet const& facet, Vec3<float> const& d) {
  Vec3<float> w = vec(dot(facet.edge[0], d), dot(facet.edge[1], d), dot(facet.edge[2], d));
  return (1.0f / (w[0] + w[1] + w[2])) * w;
}

// The pixels that a triangle may touch: columns [left, right), rows [top, bottom).
struct PixelBox {
  int left, right, top, bottom;
};

// Bounds of the part of the triangle (view coordinates) in front of the near plane; false when that
// part is empty or outside of the picture.
MPMPBD_HD inline bool pixel_box(Camera const& camera, Vec3<float> const (&corner)[3],
                                PixelBox& box) {
  float low[2] = {1e30f, 1e30f};
  float high[2] = {-1e30f, -1e30f};
  auto const include = [&](Vec3<float> const& p) {
    Vec<float, 2> const pixel = to_pixel(camera, p);
    for (int i = 0; i < 2; ++i) {
      low[i] = min(low[i], pixel[i]);
      high[i] = max(high[i], pixel[i]);
    }
  };
  for (int i = 0; i < 3; ++i) {
    Vec3<float> const& a = corner[i];
    Vec3<float> const& b = corner[(i + 1) % 3];
    if (a[2] >= camera.near) include(a);
    if ((a[2] >= camera.near) != (b[2] >= camera.near)) {
      float const s = (camera.near - a[2]) / (b[2] - a[2]);
      include(vec(a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), camera.near));
    }
  }
  // Clamped as floats first: a point beside the eye projects further than an int reaches.
  box.left = int(clamp(low[0], 0.0f, float(camera.width)));
  box.top = int(clamp(low[1], 0.0f, float(camera.height)));
  box.right = int(clamp(high[0] + 1.0f, 0.0f, float(camera.width)));
  box.bottom = int(clamp(high[1] + 1.0f, 0.0f, float(camera.height)));
  return box.left < box.right && box.top < box.bottom;
}

}  // namespace mpmpbd::render
