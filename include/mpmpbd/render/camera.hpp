// A pinhole camera: where the eye is, which way it looks, and how many pixels it sees.
#pragma once

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd::render {

// View coordinates are (right, up, forward) [m] from the eye. Pixel coordinates are (column, row),
// row 0 at the top; the centre of the first pixel is (0.5, 0.5).
struct Camera {
  Vec3<float> eye;      // [m]
  Vec3<float> right;    // unit
  Vec3<float> up;       // unit
  Vec3<float> forward;  // unit
  float focal;          // distance from the eye to the picture plane [pixel]
  float near;           // what is closer than this is not seen [m]
  int width;            // [pixel]
  int height;           // [pixel]
};

MPMPBD_HD inline Vec3<float> to_view(Camera const& camera, Vec3<float> const& point) {
  Vec3<float> const d = point - camera.eye;
  return vec(dot(camera.right, d), dot(camera.up, d), dot(camera.forward, d));
}

MPMPBD_HD inline Vec3<float> to_world(Camera const& camera, Vec3<float> const& view) {
  return camera.eye + view[0] * camera.right + view[1] * camera.up + view[2] * camera.forward;
}

// The pixel coordinates of a point in front of the eye, given in view coordinates.
MPMPBD_HD inline Vec<float, 2> to_pixel(Camera const& camera, Vec3<float> const& view) {
  float const scale = camera.focal / view[2];
  return {{0.5f * float(camera.width) + scale * view[0],
           0.5f * float(camera.height) - scale * view[1]}};
}

// The view direction through a pixel coordinate, scaled to forward = 1.
MPMPBD_HD inline Vec3<float> pixel_ray(Camera const& camera, float column, float row) {
  float const inverse = 1.0f / camera.focal;
  return vec((column - 0.5f * float(camera.width)) * inverse,
             (0.5f * float(camera.height) - row) * inverse, 1.0f);
}

// A camera at `eye` that looks at `target` [m], with a vertical field of view [rad]. Up in the picture is what is of
// `up` across the line of sight, or an axis where nothing is: y when it looks down z. The near plane is a
// thousandth of the distance.
inline Camera look_at(Vec3<float> const& eye, Vec3<float> const& target, Vec3<float> const& up,
                      float field_of_view, int width, int height) {
  Camera camera{};
  camera.eye = eye;
  camera.forward = direction(target - eye);
  camera.right = direction(cross(camera.forward, up));
  if (!(norm(camera.right) > 0.5f))
    camera.right = cross(camera.forward, any_across(-1.0f * camera.forward));
  camera.up = cross(camera.right, camera.forward);
  float const half = 0.5f * field_of_view;
  camera.focal = 0.5f * float(height) * cos(half) / sin(half);
  camera.near = 1e-3f * norm(target - eye);
  camera.width = width;
  camera.height = height;
  return camera;
}

// The closest camera that sees the whole box [m] from the side `towards` (from the box to the eye)
// and leaves `margin` of the picture free, half of it on either side.
inline Camera frame_box(Vec3<float> const& low, Vec3<float> const& high, Vec3<float> const& towards,
                        Vec3<float> const& up, int width, int height, float field_of_view = 0.5f,
                        float margin = 0.08f) {
  Vec3<float> const centre = 0.5f * (low + high);
  Camera camera = look_at(centre + direction(towards), centre, up, field_of_view, width, height);
  float const tangent_up = (1.0f - margin) * 0.5f * float(height) / camera.focal;
  float const tangent_right = (1.0f - margin) * 0.5f * float(width) / camera.focal;

  // A corner at (x, y, z) from the centre is in the picture of an eye at (cx, cy, -D) when
  // |x - cx| <= tangent (D + z): per axis two lower bounds of D, and cx is where they meet.
  float most[2] = {0.0f, 0.0f};
  float least[2] = {0.0f, 0.0f};
  for (int corner = 0; corner < 8; ++corner) {
    Vec3<float> p = low;
    for (int axis = 0; axis < 3; ++axis)
      if (corner >> axis & 1) p[axis] = high[axis];
    Vec3<float> const d = p - centre;
    float const z = dot(camera.forward, d);
    float const side[2] = {dot(camera.right, d) / tangent_right, dot(camera.up, d) / tangent_up};
    for (int axis = 0; axis < 2; ++axis) {
      most[axis] = corner == 0 ? side[axis] - z : max(most[axis], side[axis] - z);
      least[axis] = corner == 0 ? -side[axis] - z : max(least[axis], -side[axis] - z);
    }
  }
  float const distance = 0.5f * max(most[0] + least[0], most[1] + least[1]);
  camera.eye = centre - distance * camera.forward +
               0.5f * tangent_right * (most[0] - least[0]) * camera.right +
               0.5f * tangent_up * (most[1] - least[1]) * camera.up;
  camera.near = 1e-3f * distance;
  return camera;
}

}  // namespace mpmpbd::render
