// How a surface answers light: its colour, its gloss, and how far light gets into it.
#pragma once

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd::render {

// Colours are linear RGB, 1 is white.
struct Finish {
  Vec3<float> colour;  // diffuse albedo; of a metal its reflectance seen straight on
  float metal;         // 0: diffuse with a clear coat; 1: a mirror of the studio
  float coat;          // reflectance of the coat seen straight on, 0.04 for anything wet or plastic
  float roughness;     // of the highlight, 0 (mirror) to 1
  Vec3<float> wrap;    // how far diffuse light creeps around an edge, per colour, 0 to 1
  Vec3<float> free_path;  // depth at which 1/e of the light is left, per colour [m]; 0: opaque
  float cloud;            // part of the light that the surface itself keeps from what is under it
  float mottle;           // strength of the natural unevenness of the colour; 0: even
  float bump;             // slope of the fine unevenness of the surface that goes with it
  float grain;            // size of the uneven patches [m]
  float grid = 0.0f;      // spacing of a faint square grid in material positions [m]; 0: none
};

// Living soft tissue of a body of `size` [m] (its smallest edge): red light travels far in it, which
// warms the edge of a shadow and lets an inner object be seen as if through flesh.
inline Finish tissue(float size) {
  return {.colour = vec(0.78f, 0.29f, 0.265f),
          .metal = 0.0f,
          .coat = 0.045f,
          .roughness = 0.3f,
          .wrap = vec(0.28f, 0.10f, 0.08f),
          .free_path = size * vec(0.27f, 0.15f, 0.14f),
          .cloud = 0.3f,
          .mottle = 0.13f,
          .bump = 0.022f,
          .grain = 0.07f * size};
}

inline Finish steel() {
  return {.colour = vec(0.72f, 0.74f, 0.77f),
          .metal = 1.0f,
          .coat = 0.6f,
          .roughness = 0.22f,
          .wrap = {},
          .free_path = {},
          .cloud = 0.0f,
          .mottle = 0.0f,
          .bump = 0.0f,
          .grain = 1.0f};
}

inline Finish suture() {
  return {.colour = vec(0.16f, 0.09f, 0.55f),
          .metal = 0.0f,
          .coat = 0.05f,
          .roughness = 0.38f,
          .wrap = vec(0.2f, 0.2f, 0.2f),
          .free_path = {},
          .cloud = 0.0f,
          .mottle = 0.0f,
          .bump = 0.0f,
          .grain = 1.0f};
}

MPMPBD_HD inline bool translucent(Finish const& finish) { return finish.free_path[0] > 0.0f; }

}  // namespace mpmpbd::render
