// Ink on the tissue: discs and a grid painted by material position, so they are sharp at any mesh size
// and move and stretch with what they are painted on.
#pragma once

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd::render {

struct Marker {
  Vec3<float> centre;  // at rest, on the surface [m]
  float radius;        // at rest [m]
  Vec3<float> colour;  // linear RGB
};

// How much of the ink covers a fragment at the material position `x` [m]; `blur` [m] is the size of
// a pixel there, over which the rim fades.
MPMPBD_HD inline float coverage(Marker const& marker, Vec3<float> const& x, float blur) {
  float const distance = norm(x - marker.centre);
  return clamp(0.5f + (marker.radius - distance) / blur, 0.0f, 1.0f);
}

// How much the lines of a square grid cover a fragment at the material position `x` [m] on a surface
// that faces `n`: lines across the directions in which the surface extends, a 40th of the spacing wide.
MPMPBD_HD inline float grid_coverage(float spacing, Vec3<float> const& x, Vec3<float> const& n,
                                     float blur) {
  float const half_width = 0.0125f * spacing;
  // A line thinner than a pixel keeps its darkness on average.
  float const strength = min(2.0f * half_width / blur, 1.0f);
  float most = 0.0f;
  for (int i = 0; i < 3; ++i) {
    float const lines = x[i] / spacing;
    float const distance = abs(lines - floor(lines + 0.5f)) * spacing;
    float const line = clamp(0.5f + (half_width - distance) / max(blur, half_width), 0.0f, 1.0f);
    most = max(most, abs(n[i]) < 0.7f ? strength * line : 0.0f);
  }
  return most;
}

}  // namespace mpmpbd::render
