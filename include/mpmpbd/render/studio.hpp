// The studio that everything is pictured in: lights, ground and background.
#pragma once

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd::render {

// Directions point from the object towards the light. Colours are linear RGB, 1 is white.
struct Studio {
  Vec3<float> up;
  Vec3<float> key;   // the sun of the scene, casts shadows
  Vec3<float> fill;  // soft light from the other side
  Vec3<float> key_colour;
  Vec3<float> fill_colour;
  Vec3<float> sky;     // light from above
  Vec3<float> bounce;  // light from the ground
  Vec3<float> ground_colour;
  Vec3<float> horizon;  // background at eye level, into which the ground fades
  Vec3<float> zenith;   // background above
  Vec3<float> centre;   // of what is pictured [m]
  float reach;          // its radius; the ground fades into the horizon beyond it [m]
  float ground_height;  // along up [m]
  bool ground;          // whether there is one
};

// A product photographer's set around the box [m]: key light high on the left of who looks from the
// side `towards` (from the box to the eye), fill on the right, the box standing on a light ground.
inline Studio studio(Vec3<float> const& low, Vec3<float> const& high, Vec3<float> const& towards,
                     Vec3<float> const& up) {
  Vec3<float> front = direction(towards - dot(towards, up) * up);
  if (!(norm(front) > 0.5f)) front = any_across(up);  // seen from above or below
  Vec3<float> const right = cross(up, front);
  return {.up = up,
          .key = direction(0.85f * up + 0.15f * front - 0.95f * right),
          .fill = direction(0.45f * up + 0.75f * front + 0.9f * right),
          .key_colour = vec(0.98f, 0.93f, 0.87f),
          .fill_colour = vec(0.14f, 0.16f, 0.20f),
          .sky = vec(0.20f, 0.215f, 0.24f),
          .bounce = vec(0.22f, 0.19f, 0.18f),
          .ground_colour = vec(0.86f, 0.87f, 0.89f),
          .horizon = vec(0.80f, 0.82f, 0.85f),
          .zenith = vec(0.42f, 0.48f, 0.56f),
          .centre = 0.5f * (low + high),
          .reach = 0.5f * norm(high - low),
          .ground_height = min(dot(low, up), dot(high, up)),
          .ground = true};
}

}  // namespace mpmpbd::render
